//! The certificate: no inverted element, no crossing, decided by exact predicates.
//!
//! # Theory
//! A piecewise linear map of the complex is injective if every element is positively oriented and the mapped boundary
//! does not cross itself. The surface that is written, B', is made of flat triangles between moved vertices, so it is
//! checked too: it must have no crossing that the input had not.
//!
//! # Practice
//! Exact signs (crate `robust`) behind an interval filter; boxes in a tree that is refitted. Touching counts as crossing.
//! The one way to make a [`Certificate`] is [`certify`].

mod fidelity;
mod predicates;
mod surface;
mod tree;

pub use fidelity::{Distortion, Fidelity, RegionFidelity, distortion, fidelity, volume_ratios};
pub use predicates::{Triangle, collinear, orientation, triangles_cross};
pub use surface::Surface;
pub use tree::{Bounds, Tree};

use glam::{DVec3, Vec3A};
use rayon::prelude::*;

use crate::{
    collision::Shell,
    voxel::{Complex, KUHN},
};

/// What the check of one state found. Only [`certify`] makes one.
#[derive(Debug, Clone, PartialEq)]
pub struct Certificate {
    inverted: usize,
    crossings: usize,
    surface_crossings: usize,
    min_volume_ratio: f64,
    worst: Option<DVec3>,
}

impl Certificate {
    /// Whether the state is proven free of fold-overs and self-intersections (beyond those the input brought).
    pub fn certified(&self) -> bool {
        self.inverted == 0 && self.crossings == 0 && self.surface_crossings == 0
    }

    /// Elements that are not positively oriented.
    pub fn inverted(&self) -> usize {
        self.inverted
    }

    /// Pairs of the complex's boundary faces that cross.
    pub fn crossings(&self) -> usize {
        self.crossings
    }

    /// Pairs of the written surface's triangles that cross and did not at rest.
    pub fn surface_crossings(&self) -> usize {
        self.surface_crossings
    }

    /// Least ratio of an element's volume to its rest volume; ≤ 0 where one is inverted.
    pub fn min_volume_ratio(&self) -> f64 {
        self.min_volume_ratio
    }

    /// Where the worst is, in source units: a crossing, else an inverted element, else the smallest element.
    pub fn worst(&self) -> Option<DVec3> {
        self.worst
    }
}

/// Cells per parallel task.
const CELLS_PER_TASK: usize = 512;

/// Checks a state: all elements, and all pairs of faces of the given shells (the first is the complex's skin).
pub fn certify(complex: &Complex, shells: &mut [Shell], positions: &[Vec3A]) -> Certificate {
    let (inverted, least, worst_cell) = elements(complex, positions);
    let counts: Vec<Vec<(u32, u32)>> = shells.iter_mut().map(|s| s.crossings(positions)).collect();
    let crossing_at = shells.iter().zip(&counts).find_map(|(shell, pairs)| {
        let &(triangle, _) = pairs.first()?;
        Some(shell.nodes_of_triangle(triangle))
    });
    let at_nodes = |nodes: &[u32]| {
        let sum: DVec3 = nodes.iter().map(|&i| positions[i as usize].as_dvec3()).sum();
        complex.grid.source_from_lattice(sum / nodes.len().max(1) as f64)
    };
    let worst = match (crossing_at, worst_cell) {
        (Some(nodes), _) => Some(at_nodes(&nodes)),
        (None, Some(cell)) => Some(at_nodes(&complex.corners[cell])),
        (None, None) => None,
    };
    Certificate {
        inverted,
        crossings: counts.first().map_or(0, Vec::len),
        surface_crossings: counts.iter().skip(1).map(Vec::len).sum(),
        min_volume_ratio: least,
        worst,
    }
}

/// Number of elements that are not positive, the least volume ratio, and its cell. Exact in the number.
fn elements(complex: &Complex, positions: &[Vec3A]) -> (usize, f64, Option<usize>) {
    complex
        .corners
        .par_chunks(CELLS_PER_TASK)
        .enumerate()
        .map(|(chunk, cells)| {
            let mut inverted = 0;
            let mut least = (f64::INFINITY, None);
            for (k, corners) in cells.iter().enumerate() {
                let at = corners.map(|c| positions[c as usize].as_dvec3());
                for [a, b, c, d] in KUHN {
                    let volume = (at[b] - at[a]).dot((at[c] - at[a]).cross(at[d] - at[a]));
                    if orientation(at[a], at[b], at[c], at[d]) <= 0 || !volume.is_finite() {
                        inverted += 1;
                    }
                    if volume < least.0 {
                        least = (volume, Some(chunk * CELLS_PER_TASK + k));
                    }
                }
            }
            (inverted, least.0, least.1)
        })
        .reduce(
            || (0, f64::INFINITY, None),
            |a, b| {
                // Ties go to the first cell, so that the answer does not depend on threads.
                let first = (a.1, a.2.unwrap_or(usize::MAX)) <= (b.1, b.2.unwrap_or(usize::MAX));
                let (least, cell) = if first { (a.1, a.2) } else { (b.1, b.2) };
                (a.0 + b.0, least, cell)
            },
        )
}
