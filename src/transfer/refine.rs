//! The lattice halved once, smoothly: what the boundary is bound to.
//!
//! # Theory
//! The map of the complex is linear in each element, so a surface finer than the lattice shows the lattice: shading bands
//! where elements meet. The middles of edges are therefore set by the four-point rule of Dyn, Gregory and Levin (1987),
//! `m = (9 (x_i + x_j) − (x_h + x_k)) / 16` for the edge i–j continued by h and k along its line; at the end of a line
//! by the parabola `m = (3 x_i + 6 x_j − x_k) / 8`, and by the mean where nothing continues it. Old nodes stay where
//! they are, so the sizes reached stay what they are; kinks between elements become about half as sharp.
//!
//! # Practice
//! Lines follow the complex's own neighbours, so nothing reaches across a gap. The rule is linear in V'', with fixed
//! weights: blends of states are blends of surfaces. It is not certified through the elements; the written surface is
//! checked for itself.

use glam::Vec3A;
use rayon::prelude::*;

use crate::voxel::{Complex, Dimension, opposite};

/// Nodes per parallel task.
const NODES_PER_TASK: usize = 4096;

/// A node of the halved lattice: the complex's nodes that carry it, of a middle first the two ends of its edge, and their
/// weights; unused ones repeat the first with weight 0.
type Carried = ([u32; 4], [f32; 4]);

/// The halved lattice: the complex's nodes first, then the middle of each edge.
#[derive(Debug, Clone)]
pub struct Refinement {
    /// `[edges]`
    middles: Vec<Carried>,
    /// `[nodes]` index of the edge in each forward slot, `u32::MAX` where there is none.
    edge_of: Vec<[u32; 7]>,
    coarse: usize,
    /// 2 or 3.
    axes: usize,
}

impl Refinement {
    /// Prepares the weights of a complex.
    pub fn new(complex: &Complex) -> Self {
        let mut middles = Vec::new();
        let mut edge_of = vec![[u32::MAX; 7]; complex.nodes()];
        for (i, edges) in edge_of.iter_mut().enumerate() {
            for (slot, edge) in edges.iter_mut().enumerate() {
                let j = complex.neighbours[i][slot];
                if j as usize == i {
                    continue;
                }
                let before = complex.neighbours[i][opposite(slot)];
                let after = complex.neighbours[j as usize][slot];
                let (has_before, has_after) = (before as usize != i, after != j);
                let i = i as u32;
                *edge = middles.len() as u32;
                middles.push(match (has_before, has_after) {
                    (true, true) => ([i, j, before, after], [9.0 / 16.0, 9.0 / 16.0, -1.0 / 16.0, -1.0 / 16.0]),
                    (true, false) => ([i, j, before, i], [6.0 / 8.0, 3.0 / 8.0, -1.0 / 8.0, 0.0]),
                    (false, true) => ([i, j, after, i], [3.0 / 8.0, 6.0 / 8.0, -1.0 / 8.0, 0.0]),
                    (false, false) => ([i, j, i, i], [0.5, 0.5, 0.0, 0.0]),
                });
            }
        }
        let axes = match complex.dimension {
            Dimension::Two => 2,
            Dimension::Three => 3,
        };
        Self { middles, edge_of, coarse: complex.nodes(), axes }
    }

    /// All of its nodes.
    pub fn all(&self) -> Refined {
        Refined((0..self.coarse + self.middles.len()).map(|node| self.carried(node)).collect())
    }

    fn carried(&self, node: usize) -> Carried {
        match node.checked_sub(self.coarse) {
            None => ([node as u32; 4], [1.0, 0.0, 0.0, 0.0]),
            Some(edge) => self.middles[edge],
        }
    }

    /// Those of its nodes that are named, which are named by their places among them from now on.
    pub(super) fn reduced(&self, names: &mut [[u32; 4]]) -> Refined {
        let mut place = vec![u32::MAX; self.coarse + self.middles.len()];
        for &node in names.iter().flatten() {
            place[node as usize] = 0;
        }
        let mut refined = Vec::new();
        for (node, place) in place.iter_mut().enumerate().filter(|(_, place)| **place == 0) {
            *place = refined.len() as u32;
            refined.push(self.carried(node));
        }
        for node in names.iter_mut().flatten() {
            *node = place[*node as usize];
        }
        Refined(refined)
    }

    /// The node at lattice offset `at` (each coordinate 0, 1 or 2 halves) of a cell with these corners; in the plane the
    /// third coordinate says nothing.
    pub(super) fn node_in_cell(&self, corners: &[u32; 8], at: [usize; 3]) -> u32 {
        let bits = |least: usize| (0..self.axes).filter(|&a| at[a] >= least).map(|a| 1 << a).sum::<usize>();
        let (low, high) = (bits(2), bits(1));
        if low == high {
            return corners[low];
        }
        self.coarse as u32 + self.edge_of[corners[low] as usize][(low ^ high) - 1]
    }
}

/// Nodes of the halved lattice: few of them carry a surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Refined(Vec<Carried>);

impl Refined {
    /// `[these nodes]` positions in a state of the complex.
    pub fn apply(&self, nodes: &[Vec3A]) -> Vec<Vec3A> {
        let at = |(at, weights): &Carried| at.iter().zip(weights).map(|(&i, &w)| w * nodes[i as usize]).sum();
        self.0.par_iter().with_min_len(NODES_PER_TASK).map(at).collect()
    }

    /// The least (or greatest, if `low` and `high` come the other way round) of each node for nodes anywhere between.
    pub(super) fn extreme(&self, low: &[Vec3A], high: &[Vec3A]) -> Vec<Vec3A> {
        let extreme = |(at, weights): &Carried| -> Vec3A {
            let least = |i: u32, w: f32| w * if w < 0.0 { high[i as usize] } else { low[i as usize] };
            at.iter().zip(weights).map(|(&i, &w)| least(i, w)).sum()
        };
        self.0.par_iter().with_min_len(NODES_PER_TASK).map(extreme).collect()
    }

    /// Sets nodes of the halved lattice onto the straight middle of their edge, in every state. Returns those that were not
    /// there.
    ///
    /// Where all are straight, the halved lattice is carried by the complex's own elements and is as valid as they are.
    pub(super) fn straighten(&mut self, nodes: impl Iterator<Item = u32>) -> Vec<u32> {
        let mut changed = Vec::new();
        for node in nodes {
            let (at, weights) = &mut self.0[node as usize];
            if at[0] != at[1] && weights[0] != 0.5 {
                (*at, *weights) = ([at[0], at[1], at[0], at[0]], [0.5, 0.5, 0.0, 0.0]);
                changed.push(node);
            }
        }
        changed
    }

    /// A quantity of the complex's nodes at a node of the halved lattice, linear along the edge.
    pub(super) fn mean(&self, node: u32, values: &[f32]) -> f32 {
        let [i, j, ..] = self.carriers(node);
        0.5 * (values[i as usize] + values[j as usize])
    }

    /// The nodes of the complex that carry a node of the halved lattice, of a middle first the two ends of its edge.
    pub fn carriers(&self, node: u32) -> [u32; 4] {
        self.0[node as usize].0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::voxel::Grid;
    use glam::{DVec3, UVec3};

    /// A map that bends: quadratic in the position.
    fn bent(p: Vec3A) -> Vec3A {
        p + 0.05 * Vec3A::new(p.y * p.y, p.x * p.z, p.z * p.z - p.x)
    }

    #[test]
    fn middles_of_a_quadratic_map_are_its_own() {
        let grid = Grid { origin: DVec3::ZERO, cell_size: 1.0, cells: UVec3::splat(4) };
        let complex = Complex::from_cells(grid, &[true; 64]);
        let refinement = Refinement::new(&complex).all();
        let nodes: Vec<Vec3A> = complex.rest.iter().map(|&p| bent(p)).collect();
        let (refined, rest) = (refinement.apply(&nodes), refinement.apply(&complex.rest));
        let mut exact = 0;
        for (k, (&at, &p)) in refined.iter().zip(&rest).enumerate() {
            // A lone edge at a corner of the block has nothing to continue it and is halved straight.
            let [i, j, before, _] = refinement.carriers(k as u32);
            let straight = k >= complex.nodes() && before == i && i != j;
            assert!(straight || (at - bent(p)).length() < 1e-4, "{p} {at}");
            exact += usize::from(!straight);
        }
        assert!(exact > complex.nodes() + complex.edges() / 2);
    }
}
