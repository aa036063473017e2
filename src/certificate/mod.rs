//! The certificate: no inverted element, no crossing, decided by exact predicates.
//!
//! # Theory
//! A piecewise linear map of the complex is injective if every element is positively oriented and the mapped boundary
//! does not cross itself; with several bodies also none may lie inside another. The surface that is written, B', is made of flat triangles between moved vertices, so it is
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
    enclosed: usize,
    min_volume_ratio: f64,
    worst: Option<DVec3>,
}

impl Certificate {
    /// Whether the state is proven free of fold-overs and self-intersections (beyond those the input brought).
    pub fn certified(&self) -> bool {
        self.inverted == 0 && self.crossings == 0 && self.surface_crossings == 0 && self.enclosed == 0
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

    /// Bodies that lie inside another body without touching its skin.
    pub fn enclosed(&self) -> usize {
        self.enclosed
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
    let ((inverted, least, worst_cell), counts): (_, Vec<Vec<(u32, u32)>>) = rayon::join(
        || elements(complex, positions),
        || shells.par_iter_mut().map(|s| s.crossings(positions)).collect(),
    );
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
        enclosed: enclosed_bodies(complex, positions).len(),
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
                // Every element starts at corner 0. The permanent of an element is at most six cubes of the largest
                // coordinate, so this is the filter of `orientation` once for the whole cell, wider.
                let from_first = at.map(|p| p - at[0]);
                let largest = from_first.iter().fold(DVec3::ZERO, |m, e| m.max(e.abs())).max_element();
                let bound = 1.0e-13 * (largest * largest * largest);
                for [a, b, c, d] in KUHN {
                    let volume = from_first[b].dot(from_first[c].cross(from_first[d]));
                    let is_clear = volume > bound;
                    if !volume.is_finite() || (!is_clear && orientation(at[a], at[b], at[c], at[d]) <= 0) {
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

/// Bodies that lie inside another one: one node of each is looked at, which tells for all of it as long as no
/// skins cross.
///
/// The winding number of a closed skin around a point off it is a whole number; summed as solid angles (van Oosterom and
/// Strackee 1983) it comes out within far less than the half that would be needed to mistake it.
pub(crate) fn enclosed_bodies(complex: &Complex, positions: &[Vec3A]) -> Vec<u32> {
    if complex.bodies < 2 {
        return Vec::new();
    }
    let bodies = complex.bodies as usize;
    let mut bounds = vec![Bounds::EMPTY; bodies];
    let mut witness = vec![u32::MAX; bodies];
    for (i, &body) in complex.body.iter().enumerate() {
        let b = &mut bounds[body as usize];
        *b = Bounds { low: b.low.min(positions[i]), high: b.high.max(positions[i]) };
        witness[body as usize] = witness[body as usize].min(i as u32);
    }
    let mut faces: Vec<Vec<[u32; 3]>> = vec![Vec::new(); bodies];
    for &face in &complex.faces {
        faces[complex.body[face[0] as usize] as usize].push(face);
    }
    (0..bodies)
        .into_par_iter()
        .filter(|&a| {
            let p = positions[witness[a] as usize];
            (0..bodies).any(|b| {
                a != b && bounds[b].meets(&Bounds { low: p, high: p }) && winding(&faces[b], positions, p).abs() > 0.5
            })
        })
        .map(|a| a as u32)
        .collect()
}

/// Winding number of a closed surface around a point.
fn winding(faces: &[[u32; 3]], positions: &[Vec3A], p: Vec3A) -> f64 {
    let angle: f64 = faces
        .iter()
        .map(|face| {
            let [a, b, c] = face.map(|v| (positions[v as usize] - p).as_dvec3());
            let (la, lb, lc) = (a.length(), b.length(), c.length());
            let volume = a.dot(b.cross(c));
            2.0 * volume.atan2(la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb)
        })
        .sum();
    angle / (4.0 * std::f64::consts::PI)
}
