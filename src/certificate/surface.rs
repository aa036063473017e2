//! Crossings of a triangle surface with itself: boxes first, exact predicates last.

use glam::{DVec3, Vec3A};
use rayon::prelude::*;

use super::{
    predicates::{Triangle, triangles_cross},
    tree::{Bounds, Tree},
};

/// Pairs per parallel task.
const PAIRS_PER_TASK: usize = 1024;

/// A triangle surface to be checked in many states.
#[derive(Debug, Clone)]
pub struct Surface {
    /// `[triangles]` corner indices into the state's positions.
    pub triangles: Vec<[u32; 3]>,
    /// `[triangles]` identities of the corners: equal where corners are the same point (welded).
    pub identities: Vec<[u32; 3]>,
    tree: Tree,
}

impl Surface {
    /// A surface whose corners are what their indices say.
    pub fn new(triangles: Vec<[u32; 3]>, rest: &[Vec3A]) -> Self {
        let identities = triangles.clone();
        Self::welded(triangles, identities, rest)
    }

    /// A surface with corner identities of its own (a soup whose equal points are one).
    pub fn welded(triangles: Vec<[u32; 3]>, identities: Vec<[u32; 3]>, rest: &[Vec3A]) -> Self {
        let centres: Vec<Vec3A> =
            triangles.iter().map(|t| t.map(|v| rest[v as usize]).iter().sum::<Vec3A>() / 3.0).collect();
        Self { tree: Tree::new(&centres), triangles, identities }
    }

    /// Pairs of triangles whose boxes meet in any blend of the states `a` and `b`.
    pub fn near_pairs(&mut self, a: &[Vec3A], b: &[Vec3A], margin: f32) -> Vec<(u32, u32)> {
        let triangles = &self.triangles;
        self.tree.refit(|t| {
            let corners = triangles[t as usize];
            Bounds::of(corners.iter().flat_map(|&v| [a[v as usize], b[v as usize]])).grown(margin)
        });
        self.tree.pairs()
    }

    /// Triangle `t` in a state.
    pub fn triangle(&self, t: u32, positions: &[Vec3A]) -> Triangle {
        let corners = self.triangles[t as usize];
        Triangle { at: corners.map(|v| positions[v as usize].as_dvec3()), id: self.identities[t as usize] }
    }

    /// Of `pairs`, those that cross in a state, in the order given. Exact.
    pub fn crossing_pairs(&self, pairs: &[(u32, u32)], positions: &[Vec3A]) -> Vec<(u32, u32)> {
        pairs
            .par_iter()
            .with_min_len(PAIRS_PER_TASK)
            .filter(|&&(s, t)| self.pair_crosses(s, t, positions))
            .copied()
            .collect()
    }

    fn pair_crosses(&self, s: u32, t: u32, positions: &[Vec3A]) -> bool {
        let box_of = |t: u32| Bounds::of(self.triangles[t as usize].map(|v| positions[v as usize]));
        box_of(s).meets(&box_of(t)) && triangles_cross(&self.triangle(s, positions), &self.triangle(t, positions))
    }

    /// All crossing pairs of a state, sorted, each as (lower, higher). Exact.
    pub fn crossings(&mut self, positions: &[Vec3A]) -> Vec<(u32, u32)> {
        let pairs = self.near_pairs(positions, positions, 0.0);
        let mut crossing: Vec<(u32, u32)> =
            self.crossing_pairs(&pairs, positions).into_iter().map(|(s, t)| (s.min(t), s.max(t))).collect();
        crossing.sort_unstable();
        crossing
    }

    /// The same by comparing every pair, for tests and for whoever does not trust the tree.
    pub fn crossings_by_brute_force(&self, positions: &[DVec3]) -> Vec<(u32, u32)> {
        let triangle = |t: u32| Triangle {
            at: self.triangles[t as usize].map(|v| positions[v as usize]),
            id: self.identities[t as usize],
        };
        let n = self.triangles.len() as u32;
        (0..n)
            .into_par_iter()
            .flat_map_iter(|s| {
                (s + 1..n).filter(move |&t| triangles_cross(&triangle(s), &triangle(t))).map(move |t| (s, t))
            })
            .collect()
    }
}
