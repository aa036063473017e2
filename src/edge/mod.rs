//! 3.3  Edge optimization (Eq. 1): `minimize over V'  Σ_e ‖Δ'_e − f_e Δ_e‖²`.
//!
//! # Theory
//! The normal equations are `L V' = b` with the graph Laplacian L of C, one unknown vector per node, and
//! `b_i = Σ_{e at i} ± f_e Δ_e`. L depends on the complex alone, so only b changes when importance is painted. It is
//! symmetric positive semidefinite with one constant vector per body as its kernel: each body keeps its centroid.
//! V' is linear in f, so `V + λ (V' − V)` is the solution for the importance `1 + λ (f − 1)`.
//!
//! # Changes from the paper
//! The paper sweeps Jacobi 20 times; that is kept in `reference`. Here: conjugate gradients
//! preconditioned by one multigrid cycle, from the last solution.

mod multigrid;
mod solve;

pub use multigrid::{Multigrid, Weights};
pub use solve::{Solution, conjugate_gradients};

use glam::Vec3A;
use rayon::prelude::*;

use crate::voxel::{Complex, DIRECTIONS, NEIGHBOURS};

/// Nodes per parallel task. Fixed, so that sums are split in the same places for any number of threads.
pub(crate) const CHUNK: usize = 2048;

/// `b` of Eq. 1: `b_i = Σ_{e=(i,j)} f_e (v_i − v_j)`, f_e the mean of its ends; `importance` is `[nodes]`.
pub fn right_hand_side(complex: &Complex, importance: &[f32], b: &mut Vec<Vec3A>) {
    (0..complex.nodes())
        .into_par_iter()
        .with_min_len(CHUNK)
        .map(|i| {
            let mut sum = Vec3A::ZERO;
            for slot in 0..NEIGHBOURS {
                let j = complex.neighbours[i][slot] as usize;
                let f = 0.5 * (importance[i] + importance[j]);
                sum += f * edge_from_neighbour(slot) * f32::from(u8::from(j != i));
            }
            sum
        })
        .collect_into_vec(b);
}

/// `v_i − v_j` at rest for the neighbour j in `slot`.
pub(crate) fn edge_from_neighbour(slot: usize) -> Vec3A {
    let d = DIRECTIONS[slot % 7].as_vec3a();
    if slot < 7 { -d } else { d }
}

/// What Eq. 1 needs that depends on the complex alone, and its last solution V'.
#[derive(Debug, Clone)]
pub struct EdgeSolver {
    multigrid: Multigrid,
    b: Vec<Vec3A>,
}

/// Relative residual at which Eq. 1 counts as solved. V' is then right to about 1e-4 of a cell, far below what is seen;
/// f32 cannot give much less on large domains.
pub const EDGE_TOLERANCE: f64 = 1.0e-5;

impl EdgeSolver {
    /// Builds the multigrid hierarchy of the unit-weight Laplacian.
    pub fn new(complex: &Complex) -> Self {
        Self { multigrid: Multigrid::new(complex, Weights::Unit), b: Vec::new() }
    }

    /// Solves Eq. 1 for the node importance, starting from `linear` (V' of before, or the rest positions).
    pub fn solve(&mut self, complex: &Complex, importance: &[f32], linear: &mut [Vec3A]) -> Solution {
        right_hand_side(complex, importance, &mut self.b);
        let solution = conjugate_gradients(&self.multigrid, &self.b, linear, EDGE_TOLERANCE, 200);
        keep_centroids(complex, linear);
        solution
    }
}

/// Moves each body so that its centroid is that of the rest positions: Eq. 1 does not know where a body is.
pub fn keep_centroids(complex: &Complex, positions: &mut [Vec3A]) {
    let mut drift = vec![(glam::DVec3::ZERO, 0_u32); complex.bodies as usize];
    for (i, &body) in complex.body.iter().enumerate() {
        let sum = &mut drift[body as usize];
        sum.0 += (positions[i] - complex.rest[i]).as_dvec3();
        sum.1 += 1;
    }
    let drift: Vec<Vec3A> = drift.iter().map(|&(sum, n)| (sum / f64::from(n)).as_vec3a()).collect();
    positions.par_iter_mut().zip(&complex.body).with_min_len(CHUNK).for_each(|(p, &body)| *p -= drift[body as usize]);
}
