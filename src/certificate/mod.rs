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
pub use predicates::{Triangle, collinear, is_positive, orientation, segments_cross, triangles_cross};
pub use surface::Surface;
pub use tree::{Bounds, Tree};

use glam::{DVec3, Vec3A};
use rayon::prelude::*;

use crate::{
    collision::Shell,
    voxel::{Complex, Dimension, KUHN},
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

    /// Elements that are not positively oriented, those of a flat written surface included.
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

    /// Solids that lie inside another one without crossing its skin.
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
        || match complex.dimension {
            Dimension::Two => flat_elements(complex, positions),
            Dimension::Three => elements(complex, positions),
        },
        || shells.par_iter_mut().map(|s| s.crossings(positions)).collect(),
    );
    let inverted = inverted + shells.iter().map(|s| s.inverted(positions).len()).sum::<usize>();
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
        enclosed: enclosed_solids(complex, positions).len(),
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

/// The same in the plane, where the sign of every element is taken from the exact predicate.
fn flat_elements(complex: &Complex, positions: &[Vec3A]) -> (usize, f64, Option<usize>) {
    let dimension = complex.dimension;
    let mut inverted = 0;
    let mut least = (f64::INFINITY, None);
    for (cell, corners) in complex.corners.iter().enumerate() {
        for element in dimension.elements() {
            let at = element.map(|c| positions[corners[c] as usize].as_dvec3());
            let area = (at[1] - at[0]).truncate().perp_dot((at[2] - at[0]).truncate());
            inverted += usize::from(!area.is_finite() || !is_positive(dimension, at));
            if area < least.0 {
                least = (area, Some(cell));
            }
        }
    }
    (inverted, least.0, least.1)
}

/// Solids that lie inside another one: one point of each is looked at, which tells for all of it as long as no skins
/// cross. Parts that hang together by nodes or edges alone are solids of their own.
///
/// The winding number of a closed skin around a point off it is a whole number; summed as (solid) angles (van Oosterom and
/// Strackee 1983) it comes out within far less than the half that would be needed to mistake it.
pub(crate) fn enclosed_solids(complex: &Complex, positions: &[Vec3A]) -> Vec<u32> {
    if complex.solids < 2 {
        return Vec::new();
    }
    let solids = complex.solids as usize;
    let mut bounds = vec![Bounds::EMPTY; solids];
    let mut witness = vec![None; solids];
    for (corners, &solid) in complex.corners.iter().zip(&complex.solid) {
        let at = corners.map(|c| positions[c as usize]);
        let b = &mut bounds[solid as usize];
        *b = at.iter().fold(*b, |b, &p| Bounds { low: b.low.min(p), high: b.high.max(p) });
        // The middle of an element: inside, and on no skin.
        let element = complex.dimension.elements()[0].map(|c| at[c].as_dvec3());
        let middle = match complex.dimension {
            Dimension::Two => (element[0] + element[1] + element[2]) / 3.0,
            Dimension::Three => element.iter().sum::<DVec3>() / 4.0,
        };
        witness[solid as usize].get_or_insert(middle);
    }
    let mut faces: Vec<Vec<[u32; 3]>> = vec![Vec::new(); solids];
    for (&face, &cell) in complex.faces.iter().zip(&complex.cell_of_face) {
        faces[complex.solid[cell as usize] as usize].push(face);
    }
    (0..solids)
        .into_par_iter()
        .filter(|&a| {
            let Some(p) = witness[a] else { return false };
            let at = Bounds { low: p.as_vec3a(), high: p.as_vec3a() };
            (0..solids).any(|b| {
                a != b && bounds[b].meets(&at) && winding(complex.dimension, &faces[b], positions, p).abs() > 0.5
            })
        })
        .map(|a| a as u32)
        .collect()
}

/// Winding number of a closed surface, in the plane of closed lines, around a point.
fn winding(dimension: Dimension, faces: &[[u32; 3]], positions: &[Vec3A], p: DVec3) -> f64 {
    let corners = |face: &[u32; 3]| face.map(|v| positions[v as usize].as_dvec3() - p);
    match dimension {
        Dimension::Two => {
            let angle: f64 = faces
                .iter()
                .map(|face| {
                    let [a, b, _] = corners(face).map(DVec3::truncate);
                    a.perp_dot(b).atan2(a.dot(b))
                })
                .sum();
            angle / std::f64::consts::TAU
        }
        Dimension::Three => {
            let angle: f64 = faces
                .iter()
                .map(|face| {
                    let [a, b, c] = corners(face);
                    let (la, lb, lc) = (a.length(), b.length(), c.length());
                    let volume = a.dot(b.cross(c));
                    2.0 * volume.atan2(la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb)
                })
                .sum();
            angle / (4.0 * std::f64::consts::PI)
        }
    }
}
