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

pub mod plugin;

use glam::Vec3A;
use rayon::prelude::*;

use crate::multigrid::{Multigrid, Solution, Weights, conjugate_gradients};
use crate::voxel::{CHUNK, Complex, DIRECTIONS, NEIGHBOURS};

/// What is left of Eq. 1's normal equations: `r_i = Σ_{e=(i,j)} (x_j − x_i) − f_e (v_j − v_i)`, f_e the mean of its ends.
///
/// Written in differences, so that rounding does not grow with the distance from the origin. `importance` is `[nodes]`.
pub fn residual(complex: &Complex, importance: &[f32], x: &[Vec3A], r: &mut Vec<Vec3A>) {
    (0..complex.nodes())
        .into_par_iter()
        .with_min_len(CHUNK)
        .map(|i| {
            let mut sum = Vec3A::ZERO;
            for slot in 0..NEIGHBOURS {
                let j = complex.neighbours[i][slot] as usize;
                if j != i {
                    let f = 0.5 * (importance[i] + importance[j]);
                    sum += x[j] - x[i] + f * edge_from_neighbour(slot);
                }
            }
            sum
        })
        .collect_into_vec(r);
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
    residual: Vec<Vec3A>,
}

/// Eq. 1 counts as solved when the force left on a node is below this (root mean square, in cells; an edge pulls with
/// its length). V' is then right to about a hundredth of a cell even across a long body.
pub const EDGE_TOLERANCE: f64 = 3.0e-5;

impl EdgeSolver {
    /// Builds the multigrid hierarchy of the unit-weight Laplacian.
    pub fn new(complex: &Complex) -> Self {
        Self { multigrid: Multigrid::new(complex, Weights::Unit), residual: Vec::new() }
    }

    /// Solves Eq. 1 for the node importance, starting from `linear` (V' of before, or the rest positions).
    pub fn solve(&mut self, complex: &Complex, importance: &[f32], linear: &mut [Vec3A]) -> Solution {
        residual(complex, importance, linear, &mut self.residual);
        let mut correction = vec![Vec3A::ZERO; complex.nodes()];
        let goal = EDGE_TOLERANCE * (complex.nodes() as f64).sqrt();
        let solution = conjugate_gradients(&self.multigrid, &mut self.residual, &mut correction, goal, 100);
        linear.par_iter_mut().zip(&correction).with_min_len(CHUNK).for_each(|(x, d)| *x += *d);
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
