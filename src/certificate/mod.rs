//! The certificate: no inverted element, no crossing, decided by exact predicates.
//!
//! # Theory
//! A piecewise linear map of the complex is injective if every element is positively oriented and the mapped boundary
//! does not cross itself; with several bodies also none may lie inside another. The surface that is written, B', is made of
//! flat triangles between moved vertices, so it is checked too: it must have no crossing that the input had not.
//!
//! # Practice
//! Exact signs (crate `robust`) behind an interval filter; boxes in a tree that is refitted. Touching counts as crossing.
//! Most is proven at once and without exact signs: whole cells by how little they differ from a linear map, the
//! triangles around a vertex by being seen side by side, and both also for all blends of two states. The one way to make
//! a [`Certificate`] is to check the state, by [`certify`], [`certify_rest`] or together with the way to it by
//! [`certify_way`].

#[cfg(test)]
mod attacks;
mod elements;
#[cfg(test)]
mod exact;
mod fidelity;
mod motion;
mod place;
pub mod plugin;
mod predicates;
mod segments;
mod shell;
mod star;
mod surface;
mod surfaces;
mod tree;

pub(crate) use elements::{ROUNDING as VOLUME_ROUNDING, cell_stays_positive, flat_stays_positive};
pub use fidelity::{Distortion, Fidelity, RegionFidelity, distortion, fidelity, volume_ratios};
pub use place::Places;
pub use predicates::{Triangle, collinear, is_positive, orientation, segments_cross, triangles_cross};
pub use shell::{Placed, Shell};
pub use surface::Surface;
pub(crate) use surfaces::BySurface;
pub use surfaces::{Checked, Surfaces};
pub use tree::{Bounds, Posed, Tree};

use glam::{DVec3, Vec3A};
use rayon::prelude::*;

use crate::voxel::{Complex, Dimension};

/// What the check of one state found. Only [`certify`], [`certify_rest`] and [`certify_way`] make one.
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

/// Checks a state: all elements, and all pairs of faces of the surfaces.
pub fn certify<'a>(complex: &Complex, surfaces: impl Into<Checked<'a>>, positions: &[Vec3A]) -> Certificate {
    check(complex, surfaces.into(), positions, |shell| shell.crossings(positions))
}

/// Checks the rest state like [`certify`]. What of a surface in space crosses at rest was found when the shell was made,
/// and is inherited.
pub fn certify_rest<'a>(complex: &Complex, surfaces: impl Into<Checked<'a>>) -> Certificate {
    check(complex, surfaces.into(), &complex.rest, |shell| shell.crossings_at_rest(&complex.rest))
}

fn check(
    complex: &Complex,
    surfaces: Checked,
    positions: &[Vec3A],
    crossings: impl Fn(&Shell) -> Vec<(u32, u32)> + Sync + Send,
) -> Certificate {
    let (elements, (skin, written)) = rayon::join(
        || elements::check(complex, positions),
        || rayon::join(|| crossings(surfaces.skin), || surfaces.written.map(&crossings)),
    );
    conclude(complex, surfaces, positions, elements, &BySurface { skin, written })
}

/// Checks a state like [`certify`], and the straight way to it from a valid one: whether every blend of the two is proven
/// to be valid, at every instant. What keeps apart on the way does not come to lie within another either.
pub fn certify_way<'a>(
    complex: &Complex,
    surfaces: impl Into<Checked<'a>>,
    from: &Placed,
    to: &Placed,
) -> (Certificate, bool) {
    let surfaces = surfaces.into();
    let ((elements, unfolded), found) =
        rayon::join(|| elements::check_way(complex, from.nodes(), to.nodes()), || to.crossings_from(from, surfaces));
    let clear = unfolded && found.iter().all(|(_, clear)| *clear) && to.stays_unfolded_from(from, surfaces);
    let crossings = BySurface { skin: found.skin.0, written: found.written.map(|(crossings, _)| crossings) };
    let certificate = conclude(complex, surfaces, to.nodes(), elements, &crossings);
    let clear = clear && certificate.certified();
    (certificate, clear)
}

/// What the findings on a state come to.
fn conclude(
    complex: &Complex,
    surfaces: Checked,
    positions: &[Vec3A],
    elements: elements::Check,
    crossings: &BySurface<Vec<(u32, u32)>>,
) -> Certificate {
    let inverted = surfaces.iter().map(|s| s.inverted(positions).len()).sum::<usize>();
    let crossing_at = surfaces.iter().zip(crossings.iter()).find_map(|(shell, pairs)| {
        let &(triangle, _) = pairs.first()?;
        Some(shell.nodes_of_triangle(triangle))
    });
    let at_nodes = |nodes: &[u32]| {
        let sum: DVec3 = nodes.iter().map(|&i| positions[i as usize].as_dvec3()).sum();
        complex.grid.source_from_lattice(sum / nodes.len().max(1) as f64)
    };
    let worst = match (crossing_at, elements.smallest) {
        (Some(nodes), _) => Some(at_nodes(&nodes)),
        (None, Some(cell)) => Some(at_nodes(&complex.corners[cell])),
        (None, None) => None,
    };
    Certificate {
        inverted: elements.inverted + inverted,
        crossings: crossings.skin.len(),
        enclosed: enclosed_solids(complex, positions).len(),
        surface_crossings: crossings.written.as_ref().map_or(0, Vec::len),
        min_volume_ratio: elements.least,
        worst,
    }
}

/// Solids that lie inside another one: one point of each is looked at, which tells for all of it as long as no skins
/// cross. Parts that hang together by nodes or edges alone are solids of their own.
///
/// The winding number of a closed skin around a point off it is a whole number; summed as solid angles (van Oosterom and
/// Strackee 1983) it comes out within far less than the half that would be needed to mistake it.
pub(crate) fn enclosed_solids(complex: &Complex, positions: &[Vec3A]) -> Vec<u32> {
    if complex.solids < 2 {
        return Vec::new();
    }
    let solids = complex.solids as usize;
    let solid_of_face = |face: usize| complex.solid[complex.cell_of_face[face] as usize];
    let mut bounds = vec![Bounds::EMPTY; solids];
    let mut witness = vec![None; solids];
    for (k, face) in complex.faces.iter().enumerate() {
        let solid = solid_of_face(k) as usize;
        let at = face.map(|v| positions[v as usize]);
        bounds[solid] = at.iter().fold(bounds[solid], |b, &p| Bounds { low: b.low.min(p), high: b.high.max(p) });
        // The middle of an element: inside, and on no skin.
        witness[solid].get_or_insert_with(|| {
            let corners = complex.corners[complex.cell_of_face[k] as usize];
            let at = complex.dimension.elements()[0].map(|c| positions[corners[c] as usize].as_dvec3());
            match complex.dimension {
                Dimension::Two => (at[0] + at[1] + at[2]) / 3.0,
                Dimension::Three => at.iter().sum::<DVec3>() / 4.0,
            }
        });
    }
    let is_inside = |p: DVec3, solid: usize| {
        let faces = complex.faces.iter().enumerate().filter(|&(k, _)| solid_of_face(k) as usize == solid);
        winding(complex.dimension, faces.map(|(_, face)| face), positions, p).abs() > 0.5
    };
    (0..solids)
        .into_par_iter()
        .filter(|&a| {
            let Some(p) = witness[a] else { return false };
            let at = Bounds { low: p.as_vec3a(), high: p.as_vec3a() };
            (0..solids).any(|b| a != b && bounds[b].meets(&at) && is_inside(p, b))
        })
        .map(|a| a as u32)
        .collect()
}

/// Winding number of a closed surface, in the plane of closed lines, around a point off it.
fn winding<'a>(dimension: Dimension, faces: impl Iterator<Item = &'a [u32; 3]>, positions: &[Vec3A], p: DVec3) -> f64 {
    let corners = |face: &[u32; 3]| face.map(|v| positions[v as usize].as_dvec3());
    match dimension {
        // Lines that cross the ray to the right, by the way they go; exact.
        Dimension::Two => {
            let crossing = |face: &[u32; 3]| {
                let [a, b, _] = corners(face);
                let upward = b.y > p.y;
                if (a.y > p.y) == upward {
                    return 0.0;
                }
                let (low, high, sign) = if upward { (a, b, 1.0) } else { (b, a, -1.0) };
                if is_positive(Dimension::Two, [low, high, p, p]) { sign } else { 0.0 }
            };
            faces.map(crossing).sum()
        }
        Dimension::Three => {
            let angle: f64 = faces
                .map(|face| {
                    let [a, b, c] = corners(face).map(|corner| corner - p);
                    let (la, lb, lc) = (a.length(), b.length(), c.length());
                    let volume = a.dot(b.cross(c));
                    2.0 * volume.atan2(la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb)
                })
                .sum();
            angle / (4.0 * std::f64::consts::PI)
        }
    }
}
