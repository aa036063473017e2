//! The certificate: no inverted element, no crossing, decided by exact predicates.
//!
//! # Theory
//! The complex C is a set of simplices (tetrahedra; in the plane triangles) that fit face to face. A state gives every
//! node a place, and φ is the map of C that is linear in each element. ∂C is the *skin*: the faces with an element on
//! one side only. A *solid* is a set of cells that hang together by faces; parts that hang together by nodes or edges
//! alone are several.
//!
//! **Theorem.** If
//!
//! 1. every element is positively oriented,
//! 2. the skin has no two faces that meet outside what they share,
//! 3. no solid lies inside another one, and
//! 4. of the parts that the skin of each solid has, one alone is turned outward: bounds its solid from outside,
//!
//! then φ is injective on the interior of C and on the skin.
//!
//! *Proof.* Take one solid K. For a point y that is in neither φ(∂K) nor the image of an element's boundary, the degree
//! of φ at y is the number of elements over y with positive orientation less those with negative, by 1 simply the number
//! of elements over y. It is also the number of turns of φ(∂K) around y: the sum over the parts of the skin. By 2 each
//! part is mapped one to one, to a closed surface (in the plane a closed line) that has an inside and an outside
//! (Jordan and Brouwer); it turns around the points inside once, by +1 where it is turned outward and by −1 where it is
//! turned inward, and around those outside not at all. (Parts that touch themselves at a node, where cells hang together
//! by it alone, can be drawn off it by as little as one likes.) By 4 one part alone contributes +1, so that the degree
//! is at most 1 everywhere: at most one element is over any such point. Two
//! inner points of K with one image y would both have small neighbourhoods whose images cover all points near y, since
//! the degree of φ around each is positive; then two elements would be over most of these. There are none. Two solids:
//! their skins have nothing in common but what they share, so that the inside of one either lies in the inside of the
//! other, which 3 excludes, or they are disjoint. ∎
//!
//! That positive elements and a one-to-one boundary are enough is the theorem of global inversion, for maps of this
//! kind in Lipman, *Bijective Mappings of Meshes with Boundary and the Degree in Mesh Processing*, SIAM J. Imaging
//! Sciences 7 (2014), and used for tetrahedra in Aigerman and Lipman, *Injective and Bounded Distortion Mappings in
//! 3D*, ACM Trans. Graph. 32 (2013). For elastic bodies it is due to Ball, *Global invertibility of Sobolev functions
//! and the interpenetration of matter*, Proc. Royal Society of Edinburgh 88A (1981).
//!
//! Condition 4 is needed. A ring can be laid twice over a disc around two points where the angles of its elements sum
//! up to two turns, all elements positive and both its edges without a crossing: the inner one is then turned inside
//! out, and is outward too. Bodies have no cavities, since voxelization fills them, so their solids have one part of
//! skin; pictures have holes, and of these the condition is checked. A *motion* from a state that is injective keeps it
//! so without being asked: while the skin moves without meeting itself, no part of it is turned. [`certify_motion`] proves
//! motions, and the keyframes of a [film](crate::film) hang together by such proofs from the rest state on.
//!
//! The surface that is written, B', is made of flat triangles between vertices that φ moves. It is another map, so it
//! is checked too: it must have no crossing that the input had not. In the plane its triangles must be positively
//! oriented. Triangles without area at rest are left out: they have no sides. Such pairs are looked at at nine instants
//! of a motion, which is no proof.
//!
//! # Motions
//! Between two states all corners move along straight lines, `x(τ) = (1 − τ) x₀ + τ x₁`, `0 ≤ τ ≤ 1`. What is proven
//! holds for these real numbers, at every instant. A blend that is drawn is rounded once more, each coordinate by some
//! units in the last place. How elements are proven stands at the head of `elements.rs`, pairs of triangles of
//! `motion.rs` and `star.rs`, segments of `segments.rs`.
//!
//! This is continuous collision detection with another question. There, the time of the first contact is searched for:
//! as a root of the cubic of four points becoming coplanar (Provot, *Collision and self-collision handling in cloth
//! model dedicated to design garments*, 1997), by conservative advancement, which steps as far as the present distance
//! and a bound on the speed allow (Mirtich, *Impulse-based Dynamic Simulation of Rigid Body Systems*, thesis, Berkeley
//! 1996; Tang, Kim and Manocha, *Continuous Collision Detection for Non-Rigid Contact Computations using Local
//! Advancement*, ICRA 2010), by parity of crossings in exact arithmetic (Brochu, Edwards and Bridson, *Efficient
//! Geometrically Exact Continuous Collision Detection*, ACM Trans. Graph. 31, 2012), or by dividing the box of times
//! and parameters, rounding outward (Wang et al., *A Large-scale Benchmark and an Inclusion-based Algorithm for
//! Continuous Collision Detection*, ACM Trans. Graph. 40, 2021, who found wrong answers in most programs before).
//! Incremental Potential Contact (Li et al., ACM Trans. Graph. 39, 2020) shortens steps by such times and has a barrier
//! keep things apart. Here nothing asks when: a motion is proven to be free of contact, or it is not and is cut or
//! drawn back. So one direction that sets two triangles apart at both ends is a proof for all instants between, at the
//! cost of a few products and with a bound of rounding that is known beforehand; like conservative advancement it needs
//! more pieces the nearer things come, like the method of inclusion it errs to one side only. That volumes stay
//! positive is told by Bernstein coefficients, as Johnen, Remacle and Geuzaine do for the Jacobian of curved elements
//! (*Geometrical validity of curvilinear finite elements*, J. Comput. Phys. 233, 2013); their variable is the place in
//! an element, ours the time.
//!
//! # Rounding
//! Let u be 2⁻²⁴ in single precision, 2⁻⁵³ in double. The standard model (Higham, *Accuracy and Stability of Numerical
//! Algorithms*, 2002, ch. 2 and 3) is `fl(a ∘ b) = (a ∘ b)(1 + δ)`, |δ| ≤ u, for + − × ÷; a product of n such factors
//! is 1 + θ with
//! |θ| ≤ γₙ = n u / (1 − n u). So a sum of products, computed in any order without cancelling a single term beforehand,
//! is off by at most `γₙ Σ |terms|` where n is the largest number of roundings that any term goes through. Halving and
//! changing the sign are exact. Each page counts n and Σ |terms| for its own formulas, and each constant has at least
//! twice the room that it needs (that of midpoints, ten roundings, a fifth more), which pays for the factor
//! 1 / (1 − n u), for bounds that are rounded themselves (some (1 − u)⁵), and for sizes being measured on rounded differences, `M_true ≤ M / (1 − u)`.
//!
//! The model fails below the normal numbers: a product may lose up to half of the smallest number, η = 2⁻¹⁵⁰ in single
//! precision. (Sums and differences lose nothing there.) Bounds in single precision count only above 2⁻¹²⁶, which is
//! 2²⁴ η: what a few products lose is nothing beside that. In double precision it cannot happen here: coordinates are
//! single, hence multiples of 2⁻¹⁴⁹, so that what is a product of three of their differences is either 0 or not far
//! below 2⁻⁴⁴⁷, and with a direction that is such a product itself not far below 2⁻⁶⁰⁰. Above, a product may become
//! infinite. Single precision counts only where the bound is less than 10³⁰ or the result is finite; in double
//! precision 2¹²⁸ to the fourth is still finite. Comparisons are written so that what is no number proves nothing.
//!
//! All of this is attacked by tests, with bounds too small as sabotage (`attacks`).
//!
//! # Practice
//! Exact signs (crate `robust`) behind a filter of rounding bounds; boxes in a tree that is refitted. Touching counts
//! as crossing. Most is proven at once and without exact signs: whole cells by how little they differ from a linear
//! map, the triangles around a vertex by being seen side by side, and both also for all blends of two states. Only a
//! check makes a [`Certificate`]: that of a state by [`certify`] or [`certify_rest`], or together with the motion to it
//! by [`certify_motion`].

#[cfg(test)]
mod attacks;
mod elements;
#[cfg(test)]
pub(crate) mod exact;
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
pub use shell::{CarriedState, Shell};
pub use surface::Surface;
pub(crate) use surfaces::BySurface;
pub use surfaces::{Checked, Surfaces};
pub use tree::{Bounds, Posed, Tree};

use glam::{DVec3, Vec3A};
use rayon::prelude::*;

use crate::voxel::{Complex, Dimension};

/// What the check of one state found. Only [`certify`], [`certify_rest`] and [`certify_motion`] make one.
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

    /// Solids that lie inside another one, or may lie over themselves, without a skin that crosses.
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

/// Checks the rest state like [`certify`]. What of a surface in space crosses at rest was found when the shell was
/// made, and is inherited.
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

/// Checks a state like [`certify`], and the straight motion to it from a valid one: whether every blend of the two is
/// proven to be valid, at every instant. What keeps apart during the motion does not come to lie within another either.
pub fn certify_motion<'a>(
    complex: &Complex,
    surfaces: impl Into<Checked<'a>>,
    from: &CarriedState,
    to: &CarriedState,
) -> (Certificate, bool) {
    let surfaces = surfaces.into();
    let ((elements, unfolded), found) =
        rayon::join(|| elements::check_motion(complex, from.nodes(), to.nodes()), || to.crossings_from(from, surfaces));
    let proven = unfolded && found.iter().all(|(_, proven)| *proven) && to.stays_unfolded_from(from, surfaces);
    let crossings = BySurface { skin: found.skin.0, written: found.written.map(|(crossings, _)| crossings) };
    let certificate = conclude(complex, surfaces, to.nodes(), elements, &crossings);
    let proven = proven && certificate.certified();
    (certificate, proven)
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
        enclosed: enclosed_solids(complex, positions).len() + overlaid_solids(complex, positions).len(),
        surface_crossings: crossings.written.as_ref().map_or(0, Vec::len),
        min_volume_ratio: elements.least,
        worst,
    }
}

/// Solids of a flat complex that may lie over themselves although no skin crosses: more than one of the closed lines around
/// them is turned outward, with the inside on its left and inside of it. A line counts as such unless its area is proven to
/// be negative.
///
/// Twice the area is a sum of n products of differences, taken from one of its points: in double precision it is off by at
/// most (n + 3) u Σ |terms|, and the differences of single numbers by u each.
fn overlaid_solids(complex: &Complex, positions: &[Vec3A]) -> Vec<u32> {
    let lines = complex.outline_of_face.iter().max().map_or(0, |most| *most as usize + 1);
    if lines < 2 {
        return Vec::new();
    }
    #[derive(Clone, Copy)]
    struct Line {
        origin: DVec3,
        solid: u32,
        area: f64,
        size: f64,
        count: f64,
    }
    let mut found: Vec<Option<Line>> = vec![None; lines];
    for ((face, &line), &cell) in complex.faces.iter().zip(&complex.outline_of_face).zip(&complex.cell_of_face) {
        let [a, b] = [face[0], face[1]].map(|v| positions[v as usize].as_dvec3());
        let solid = complex.solid[cell as usize];
        let line = found[line as usize].get_or_insert(Line { origin: a, solid, area: 0.0, size: 0.0, count: 0.0 });
        let (a, b) = (a - line.origin, b - line.origin);
        line.area += a.x * b.y - a.y * b.x;
        line.size += (a.x * b.y).abs() + (a.y * b.x).abs();
        line.count += 1.0;
    }
    let is_outward = |line: &Line| line.area >= -(line.count + 8.0) * f64::EPSILON * line.size;
    let mut outward: Vec<u32> = found.iter().flatten().filter(|line| is_outward(line)).map(|line| line.solid).collect();
    outward.sort_unstable();
    let mut overlaid: Vec<u32> = outward.windows(2).filter(|pair| pair[0] == pair[1]).map(|pair| pair[0]).collect();
    overlaid.dedup();
    overlaid
}

/// Solids that lie inside another one: one point of each is looked at, which tells for all of it as long as no skins
/// cross. Parts that hang together by nodes or edges alone are solids of their own.
///
/// The winding number of a closed skin around a point off it is a whole number; summed as solid angles (van Oosterom
/// and Strackee 1983) it comes out within far less than the half that would be needed to mistake it. In space this is
/// the one answer that is not exact: the point is rounded, and so is the side of a face that it is on. It would take an
/// element, or a gap between two skins, that is thinner than some 2⁻⁵⁰ of its coordinates. A motion that is proven does
/// not need it.
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
        // Lines that cross the ray to the right, by the direction they go in; exact.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::voxel::Grid;
    use glam::UVec3;

    #[test]
    fn a_hole_that_is_turned_outward_is_seen() {
        let grid = Grid { origin: DVec3::ZERO, cell_size: 1.0, cells: UVec3::new(5, 5, 1) };
        let inside: Vec<bool> = (0..25).map(|k| !((1..4).contains(&(k % 5)) && (1..4).contains(&(k / 5)))).collect();
        let complex = Complex::from_flat_cells(grid, &inside);
        assert!(overlaid_solids(&complex, &complex.rest).is_empty());
        assert!(certify(&complex, &Surfaces::skin_of(&complex), &complex.rest).certified());
        // As it lies where a ring is laid twice over a disc: the line around the hole the other way about.
        let is_at_hole = |p: &Vec3A| (1.0..=4.0).contains(&p.x) && (1.0..=4.0).contains(&p.y);
        let turned = complex.rest.iter().map(|p| if is_at_hole(p) { Vec3A::new(5.0 - p.x, p.y, 0.0) } else { *p });
        let turned: Vec<Vec3A> = turned.collect();
        assert_eq!(overlaid_solids(&complex, &turned), [0]);
        // Sabotage: inside out as a whole it is one line again that is outward, and its elements are what is wrong.
        let mirrored: Vec<Vec3A> = complex.rest.iter().map(|p| Vec3A::new(-p.x, p.y, 0.0)).collect();
        assert!(overlaid_solids(&complex, &mirrored).is_empty());
        assert!(certify(&complex, &Surfaces::skin_of(&complex), &mirrored).inverted() > 0);
        // A hole that has shrunk to nothing is not proven to lie as it did.
        let shrunk: Vec<Vec3A> =
            complex.rest.iter().map(|p| if is_at_hole(p) { Vec3A::new(2.5, 2.5, 0.0) } else { *p }).collect();
        assert_eq!(overlaid_solids(&complex, &shrunk), [0]);
    }
}
