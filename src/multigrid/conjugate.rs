//! Conjugate gradients preconditioned by one multigrid cycle.

use glam::Vec3A;
use rayon::prelude::*;

use super::{CycleMemory, Multigrid};
use crate::voxel::CHUNK;

/// What a solve did.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solution {
    /// Iterations spent.
    pub iterations: u32,
    /// ‖residual‖ before.
    pub before: f64,
    /// ‖residual‖ at the end.
    pub after: f64,
}

/// Adds to x the solution of `A d = r`, until ‖r‖ ≤ `goal` or `limit` iterations; r is left at what remains.
///
/// A is semidefinite with constants as its kernel; r must sum to zero (over each body), as forces in pairs do.
pub fn conjugate_gradients(a: &Multigrid, r: &mut [Vec3A], x: &mut [Vec3A], goal: f64, limit: u32) -> Solution {
    preconditioned(a, |p, q| a.apply(p, q), r, x, goal, limit)
}

/// The same for an operator that `a` is only near to (contacts added).
pub(crate) fn preconditioned(
    a: &Multigrid,
    apply: impl Fn(&[Vec3A], &mut Vec<Vec3A>),
    r: &mut [Vec3A],
    x: &mut [Vec3A],
    goal: f64,
    limit: u32,
) -> Solution {
    let mut memory = CycleMemory::default();
    let (mut z, mut q) = (Vec::new(), Vec::new());
    let mut p: Vec<Vec3A> = vec![Vec3A::ZERO; x.len()];
    let before = dot(r, r).sqrt();
    let mut solution = Solution { iterations: 0, before, after: before };
    let mut rz_before = 1.0;
    while solution.after > goal && solution.iterations < limit {
        a.cycle(r, &mut z, &mut memory);
        let rz = dot(r, &z);
        let beta = if solution.iterations == 0 { 0.0 } else { (rz / rz_before) as f32 };
        p.par_iter_mut().zip(&z).with_min_len(CHUNK).for_each(|(p, z)| *p = *z + beta * *p);
        apply(&p, &mut q);
        let alpha = rz / dot(&p, &q);
        // Rounding has taken over: what is left is not the operator's any more.
        if !(alpha > 0.0 && alpha.is_finite()) {
            break;
        }
        let alpha = alpha as f32;
        x.par_iter_mut().zip(&p).with_min_len(CHUNK).for_each(|(x, p)| *x += alpha * *p);
        r.par_iter_mut().zip(&q).with_min_len(CHUNK).for_each(|(r, q)| *r -= alpha * *q);
        rz_before = rz;
        solution.after = dot(r, r).sqrt();
        solution.iterations += 1;
    }
    solution
}

/// Dot product, summed in f64 over fixed chunks in order: the same bits for any number of threads.
pub fn dot(a: &[Vec3A], b: &[Vec3A]) -> f64 {
    let parts: Vec<f64> = a
        .par_chunks(CHUNK)
        .zip(b.par_chunks(CHUNK))
        .map(|(a, b)| a.iter().zip(b).map(|(a, b)| f64::from(a.dot(*b))).sum())
        .collect();
    parts.iter().sum()
}
