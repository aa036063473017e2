//! What painting needs to know of a surface: where its vertices are, which are neighbours, which hang together.

use glam::DVec3;
use rayon::prelude::*;

use crate::boundary::{Boundary, Regions, Sets};

/// A surface to paint on. Vertices at the same place count as one: a seam does not show.
#[derive(Debug, Clone)]
pub struct Canvas {
    /// `[vertices]` source units.
    positions: Vec<DVec3>,
    /// `[vertices]` the first vertex at the same place.
    welded: Vec<u32>,
    /// `[vertices]` the first vertex of the same piece of surface.
    piece: Vec<u32>,
    /// Neighbours of each first vertex, in compressed rows of first vertices.
    starts: Vec<u32>,
    neighbours: Vec<u32>,
    regions: Regions,
    low: DVec3,
    high: DVec3,
}

impl Canvas {
    /// Looks at a surface once.
    pub fn new(boundary: &Boundary) -> Self {
        let welded = boundary.welded();
        let mut sets = Sets::new(boundary.positions.len());
        let mut edges = Vec::with_capacity(boundary.triangles.len() * 6);
        for triangle in &boundary.triangles {
            let [a, b, c] = triangle.map(|v| welded[v as usize]);
            sets.join(a, b);
            sets.join(a, c);
            edges.extend([(a, b), (b, a), (b, c), (c, b), (c, a), (a, c)].into_iter().filter(|(i, j)| i != j));
        }
        edges.par_sort_unstable();
        edges.dedup();
        let mut starts = vec![0_u32; boundary.positions.len() + 1];
        for &(i, _) in &edges {
            starts[i as usize + 1] += 1;
        }
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let (low, high) = boundary.bounds().unwrap_or_default();
        Self {
            positions: boundary.positions.clone(),
            piece: welded.iter().map(|&v| sets.find(v)).collect(),
            welded,
            starts,
            neighbours: edges.into_iter().map(|(_, j)| j).collect(),
            regions: boundary.regions.clone().unwrap_or_default(),
            low,
            high,
        }
    }

    /// The same surface with other regions.
    #[must_use]
    pub fn with_regions(&self, regions: Option<&Regions>) -> Self {
        Self { regions: regions.cloned().unwrap_or_default(), ..self.clone() }
    }

    /// Whether its regions are these.
    pub fn has_regions(&self, regions: Option<&Regions>) -> bool {
        match regions {
            Some(other) => self.regions.names == other.names && self.regions.of_vertex == other.of_vertex,
            None => self.regions.names.is_empty(),
        }
    }

    /// Number of vertices.
    pub fn vertices(&self) -> usize {
        self.positions.len()
    }

    /// Names of the regions that can be filled.
    pub fn region_names(&self) -> &[String] {
        &self.regions.names
    }

    /// `[vertices]` positions, source units.
    pub(super) fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// Lowest and highest corner of the box around the surface, source units.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        (self.low, self.high)
    }

    /// The first vertex at the place of one.
    pub(super) fn first(&self, vertex: usize) -> usize {
        self.welded[vertex] as usize
    }

    /// First vertices next to a first vertex.
    pub(super) fn around(&self, first: usize) -> &[u32] {
        &self.neighbours[self.starts[first] as usize..self.starts[first + 1] as usize]
    }

    /// Whether two vertices hang together.
    pub(super) fn connected(&self, a: usize, b: usize) -> bool {
        self.piece[a] == self.piece[b]
    }

    /// Whether a vertex belongs to the region of this name.
    pub(super) fn is_in(&self, vertex: usize, region: &str) -> bool {
        let name = |index: u32| self.regions.names.get(index as usize);
        self.regions.of_vertex.get(vertex).is_some_and(|&r| name(r).is_some_and(|n| n == region))
    }

    /// A point and its mirror images about the middle of the surface, without repetition.
    pub fn images(&self, point: DVec3, mirror: [bool; 3]) -> Vec<DVec3> {
        let middle = (self.low + self.high) * 0.5;
        let mut images = vec![point];
        for axis in (0..3).filter(|&axis| mirror[axis]) {
            for k in 0..images.len() {
                let mut image = images[k];
                image[axis] = 2.0 * middle[axis] - image[axis];
                if !images.contains(&image) {
                    images.push(image);
                }
            }
        }
        images
    }
}
