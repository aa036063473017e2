//! What benches and the "classic" view compare against: the paper's own scheme.
//!
//! Nothing here is certified; it is kept to show and to measure the difference.
//!
//! # Changes from the paper
//! Fig. 5 as printed diverges: the target λ l_i starts at length 0, and half-corrections are summed over all edges of a
//! node. [`Reading::Printed`] keeps that. [`Reading::Sensible`] interpolates the target from the rest length to l_i and
//! averages the corrections.

pub mod plugin;

use glam::Vec3A;
use rayon::prelude::*;

use crate::{
    collision::{Asked, Problem, contact_step},
    edge::edge_from_neighbour,
    voxel::{CHUNK, Complex, NEIGHBOURS},
};

/// Iterations of Fig. 5 in the paper.
pub const ITERATIONS: usize = 1000;

/// How Fig. 5 is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reading {
    /// To the letter.
    Printed,
    /// Targets from the rest length on, corrections averaged.
    Sensible,
}

/// Eq. 1 by Jacobi sweeps (Sec. 3.4; the paper uses 20), each step taken to nine tenths so that no mode flips for ever.
pub fn jacobi(complex: &Complex, importance: &[f32], sweeps: usize) -> Vec<Vec3A> {
    let mut x = complex.rest.clone();
    for _ in 0..sweeps {
        x = (0..complex.nodes())
            .into_par_iter()
            .with_min_len(CHUNK)
            .map(|i| {
                let (mut sum, mut count) = (Vec3A::ZERO, 0.0);
                for slot in 0..NEIGHBOURS {
                    let j = complex.neighbours[i][slot] as usize;
                    if j != i {
                        let f = 0.5 * (importance[i] + importance[j]);
                        sum += x[j] + f * edge_from_neighbour(slot);
                        count += 1.0;
                    }
                }
                x[i] + 0.9 * (sum / count - x[i])
            })
            .collect();
    }
    x
}

/// One iteration of Fig. 5 at λ: edge lengths by projection, spheres pushed apart. `linear` is V'.
pub fn fig5(
    complex: &Complex,
    problem: &Problem,
    linear: &[Vec3A],
    reading: Reading,
    lambda: f32,
    x: &[Vec3A],
) -> Vec<Vec3A> {
    let nodes = || (0..complex.nodes()).into_par_iter().with_min_len(CHUNK);
    let neighbours =
        |i: usize| complex.neighbours[i].iter().copied().enumerate().filter(move |&(_, j)| j as usize != i);
    let moved: Vec<Vec3A> = nodes()
        .map(|i| {
            let (mut sum, mut count) = (Vec3A::ZERO, 0.0);
            for (slot, j) in neighbours(i) {
                let optimal = (linear[i] - linear[j as usize]).length();
                let rest = edge_from_neighbour(slot).length();
                let target = match reading {
                    Reading::Printed => lambda * optimal,
                    Reading::Sensible => rest + lambda * (optimal - rest),
                };
                let edge = x[i] - x[j as usize];
                sum += (target / edge.length() - 1.0) * edge * 0.5;
                count += 1.0;
            }
            x[i] + if reading == Reading::Printed { sum } else { sum / count }
        })
        .collect();
    if !moved.iter().all(|p| p.is_finite()) {
        return moved;
    }
    // Radii from the present state, as in Fig. 5.
    let shortest =
        |i: usize| neighbours(i).map(|(_, j)| (moved[i] - moved[j as usize]).length()).fold(f32::INFINITY, f32::min);
    let radius: Vec<f32> = nodes().map(shortest).collect();
    let contacts = contact_step(complex, problem, &Asked { size: Vec::new(), radius }, &moved);
    nodes().map(|i| moved[i] + contacts.of(i).iter().map(|c| 0.5 * c.depth * c.direction).sum::<Vec3A>()).collect()
}
