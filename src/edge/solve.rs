//! Conjugate gradients preconditioned by one multigrid cycle.

use glam::Vec3A;
use rayon::prelude::*;

use super::{CHUNK, Multigrid, multigrid::CycleMemory};

/// What a solve did.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solution {
    /// Iterations spent.
    pub iterations: u32,
    /// `‖b − A x‖ / ‖b − A x₀‖` at the end.
    pub residual: f64,
}

/// `A x = b` from the given x until the residual has fallen by `tolerance` relative to b, or `limit` iterations.
///
/// A is semidefinite with constants as its kernel and b sums to zero per body, so the iteration stays in the range.
pub fn conjugate_gradients(a: &Multigrid, b: &[Vec3A], x: &mut [Vec3A], tolerance: f64, limit: u32) -> Solution {
    let mut memory = CycleMemory::default();
    let (mut z, mut q) = (Vec::new(), Vec::new());
    let mut r = Vec::new();
    a.apply(x, &mut q);
    b.par_iter().zip(&q).with_min_len(CHUNK).map(|(b, q)| *b - *q).collect_into_vec(&mut r);
    let scale = dot(b, b).max(f64::MIN_POSITIVE);
    let mut norm = dot(&r, &r);
    let target = tolerance * tolerance * scale;
    let mut iterations = 0;
    let mut p: Vec<Vec3A> = vec![Vec3A::ZERO; x.len()];
    let mut rz_before = 1.0;
    while norm > target && iterations < limit {
        a.cycle(&r, &mut z, &mut memory);
        let rz = dot(&r, &z);
        let beta = if iterations == 0 { 0.0 } else { (rz / rz_before) as f32 };
        p.par_iter_mut().zip(&z).with_min_len(CHUNK).for_each(|(p, z)| *p = *z + beta * *p);
        a.apply(&p, &mut q);
        let curvature = dot(&p, &q);
        if curvature <= 0.0 || !curvature.is_finite() {
            break;
        }
        let alpha = (rz / curvature) as f32;
        x.par_iter_mut().zip(&p).with_min_len(CHUNK).for_each(|(x, p)| *x += alpha * *p);
        r.par_iter_mut().zip(&q).with_min_len(CHUNK).for_each(|(r, q)| *r -= alpha * *q);
        rz_before = rz;
        norm = dot(&r, &r);
        iterations += 1;
    }
    Solution { iterations, residual: (norm / scale).sqrt() }
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
