//! Long triangles in pieces, so that a surface bends as its neighbourhood does.
//!
//! # Theory
//! The written surface draws a triangle straight between its three moved corners, while the lattice bends between them. Halving
//! long edges, again and again, takes that difference away: each halving quarters it.
//!
//! A triangle is replaced by 2, 3 or 4 by which of its edges are halved (Bank, Sherman and Weiser 1983 call the last one
//! *regular*). An edge is halved once for all triangles that have it, and edges at the same place are one edge: seams with
//! vertices of their own on either side, bodies that touch. So no crack opens and no vertex comes to lie within a side of a
//! neighbour. What has two triangles at each edge has so afterwards.
//!
//! # What is promised
//! - Vertices of the input keep their numbers and their places to the bit; new ones come after them. Triangles lie where the one
//!   stood they are parts of, so their order is that of the input too.
//! - The middle of an edge whose ends are both numbers of single precision is one as well: what a file with such numbers says.
//! - All data follow. Values of vertices, texture coordinates and normals of corners are means; materials, objects and whatever
//!   else a file says of a face go to all of its parts. What is a name and not a quantity goes over from one end: regions, and
//!   whole numbers of a PLY which are no colours. The mean of label 3 and label 7 would be a third label. That end is the one
//!   whose place has the vertex of smaller index, so that both sides of a seam choose alike.
//! - Polygons stay what they are where no edge of them, and no diagonal they are drawn by, is halved; else their triangles take
//!   their place.
//!
//! # Practice
//! Time and memory are in proportion to the result. It ends: an edge is half as long in the next round, a median at most as long
//! as the mean of two sides; and an edge between neighbouring numbers has no middle and stays.

mod carry;
mod rounds;

use std::collections::HashSet;

use super::Boundary;
use rounds::{Round, Work};

/// A boundary with long triangles in pieces, and how its pieces come from the input.
#[derive(Debug, Clone)]
pub struct Split {
    /// The pieces, with all that the input's file says.
    pub boundary: Boundary,
    /// `[triangles]` the triangle of the input that each is, or is a part of; never falls.
    pub parents: Vec<u32>,
    /// `[triangles]` where the corners of each lie in its parent: weights of the parent's corners, which sum to 1 and are exact.
    pub corners: Vec<[[f32; 3]; 3]>,
    /// `[added vertices]` the two vertices each lies in the middle of: of the input, or added before it. Names go over from the
    /// first.
    pub ends: Vec<[u32; 2]>,
    /// The longest edge there is now, source units. More than was asked for where `most` was reached, or the numbers cannot say
    /// where a middle is.
    pub longest: f64,
}

/// Halves every edge longer than `longest`, in source units and above 0, until none is.
///
/// `most`: how many triangles there may be. Where that does not suffice the longest edges are halved first, those of one length
/// all or none, and the rest stays: [`Split::longest`] tells. An input that has more already comes back as it is.
pub fn split_long(boundary: &Boundary, longest: f64, most: usize) -> Split {
    let mut work = Work::new(boundary);
    // Corners are counted in 32 bits.
    let most = most.min(u32::MAX as usize / 3);
    if longest > 0.0 {
        loop {
            let (edges, is_last) = work.longer_than(longest, most);
            if edges.is_empty() {
                break;
            }
            work.halve(&edges);
            if is_last {
                break;
            }
        }
    }
    work.finish(boundary)
}

/// Halves the given edges, pairs of vertices in any order, and all that lie at the same place; once.
///
/// Pairs that are no edge of a triangle change nothing. A triangle becomes four at most.
pub fn split_edges(boundary: &Boundary, edges: &[[u32; 2]]) -> Split {
    let mut work = Work::new(boundary);
    let count = boundary.positions.len();
    let is_known = |edge: &&[u32; 2]| edge.iter().all(|&v| (v as usize) < count);
    let edges: HashSet<_> = edges.iter().filter(is_known).filter_map(|&[a, b]| work.edge_at(a, b)).collect();
    work.halve(&Round(edges));
    work.finish(boundary)
}

impl Split {
    /// How many vertices came after those of the input.
    pub fn added_vertices(&self) -> usize {
        self.ends.len()
    }

    /// How many triangles there are more than in the input.
    pub fn added_triangles(&self) -> usize {
        let before = self.parents.last().map_or(0, |&last| last as usize + 1);
        self.parents.len() - before
    }

    /// Values of the input's vertices with those of the added ones after them: `middle` of the two ends of each.
    ///
    /// `values` may be shorter or longer than the input has vertices only by a fault of the caller; missing ones are not made up:
    /// the result ends there.
    pub fn carry<T: Clone>(&self, values: &[T], middle: impl Fn(&T, &T) -> T) -> Vec<T> {
        let mut carried = values.to_vec();
        for ends in &self.ends {
            let [Some(a), Some(b)] = ends.map(|end| carried.get(end as usize)) else { break };
            let value = middle(a, b);
            carried.push(value);
        }
        carried
    }

    /// `[added vertices]` where each lies on the input: a triangle of it, and the weights of its corners.
    pub fn places(&self) -> Vec<(u32, [f32; 3])> {
        let before = self.boundary.positions.len() - self.ends.len();
        let mut places = vec![None; self.ends.len()];
        for (index, triangle) in self.boundary.triangles.iter().enumerate() {
            for (corner, &vertex) in triangle.iter().enumerate() {
                let Some(place) = (vertex as usize).checked_sub(before).and_then(|v| places.get_mut(v)) else {
                    continue;
                };
                *place = place.or(Some((self.parents[index], self.corners[index][corner])));
            }
        }
        // Each was made for a triangle whose parts have it.
        places.into_iter().map(Option::unwrap_or_default).collect()
    }

    /// This, and after it what became of its result: from the input of the first to the result of the second.
    ///
    /// # Panics
    /// Where `next` comes from another boundary than this one's result.
    #[must_use]
    pub fn then(mut self, next: Self) -> Self {
        let middle = |weights: [f32; 3], of: &[[f32; 3]; 3]| -> [f32; 3] {
            std::array::from_fn(|i| (0..3).map(|corner| weights[corner] * of[corner][i]).sum())
        };
        let through = |(&parent, corners): (&u32, &[[f32; 3]; 3])| {
            let of = &self.corners[parent as usize];
            corners.map(|weights| middle(weights, of))
        };
        let corners = next.parents.iter().zip(&next.corners).map(through).collect();
        self.parents = next.parents.iter().map(|&parent| self.parents[parent as usize]).collect();
        self.corners = corners;
        self.ends.extend(next.ends);
        Self { boundary: next.boundary, longest: next.longest, ..self }
    }
}
