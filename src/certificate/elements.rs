//! Elements: whether all are positively oriented, in a state or at every instant between two.
//!
//! # Theory
//! *A state.* An element is positive if `det[b − a, c − a, d − a] > 0`. In single precision, with M the largest
//! component of the differences: each of the 6 products in the determinant goes through 3 differences, the product and
//! the difference of the cross product, and the product and two sums of the dot product: n = 8, Σ |terms| ≤ 6 M³, error
//! ≤ 48 u M³ = 2.9e-6 M³. [`ROUNDING`] is 1e-5. What is not above it, or beyond the range of single precision, is left
//! to the exact predicate.
//!
//! *A motion, by the volume.* Differences of corners are linear in τ, so the volume is a cubic polynomial. With edges
//! a, b, c at the start and a', b', c' at the end, its Bernstein coefficients are
//!
//! ```text
//! [a b c],  ([a' b c] + [a b' c] + [a b c']) / 3,  ([a' b' c] + [a' b c'] + [a b' c']) / 3,  [a' b' c'].
//! ```
//!
//! A polynomial is nowhere less than the least of
//! its coefficients; where one is not positive, it is cut into halves (de Casteljau), of which each has coefficients of
//! its own, nearer to the values. In double precision: n = 8 for each determinant, 2 more for the sum of three and 1
//! for the division, Σ |terms| ≤ 18 M³ / 3 = 6 M³: error ≤ 66 u M³. Cutting takes means of neighbours. A mean makes no
//! error larger and adds one rounding of at most 6 u M³; a cubic takes three means in a row for a half, and a motion is
//! subdivided ten times: 180 u M³ more. In all 246 u M³ = 2.8e-14 M³, against 1e-13 ([`star::ROUNDING`]). In the plane:
//! n = 5 for the mean of two products of differences, Σ |terms| ≤ 2 M², and 20 means of 2 u M²: 50 u M² = 5.6e-15 M².
//!
//! *A motion, by all of a cell at once.* An element's edges along the axes are the columns of its deformation gradient
//! F. If ‖B F − I‖ < 1 for some matrix B, then B F is not singular, nor are B and F, and none is between it and I: det
//! B and det F have one sign. The set of such F is convex, and F moves along a straight line, so that both ends tell
//! for every instant. If all elements of a cell satisfy it with one B, one of them tells the sign for all. Columns are
//! taken one by one, the worst of four edges of a cell and two ends for each, which covers all elements. Norms are
//! Frobenius norms.
//!
//! Let B be the inverse, as computed, of the mean M of the F, and m its longest column. First,
//!
//! ```text
//! ‖B F − I‖ ≤ ‖B‖ ‖F − M‖ + ‖B M − I‖.
//! ```
//!
//! The second term is rounding, but it may be large: with columns a, b, c
//!
//! - a cross product is off by at most √2 γ₂ |b| |c|, the three of them, times ‖M‖ ≤ √3 m, by √18 · 2 u m³ = 8.5 u m³;
//! - the determinant is off by at most γ₅ times its permanent, ≤ √2 · 5 u m³ = 7.1 u m³;
//! - dividing and multiplying adds 2 u ‖B‖ ‖M‖.
//!
//! So `‖B M − I‖ ≤ 15.6 u m³ / det M`, and the last, which is at most 4e-4 where [`WELL_CONDITIONED`] holds.
//! [`MOST_SKEWED`] bounds m³ / det M as computed by 5e4; then the true determinant is at most 2.2 % less, and the term
//! is below 0.048. The first term is below √0.8 = 0.895 ([`FAR_FROM_SINGULAR`]); the edges F are rounded by u |e| and
//! so is their difference from the mean, which adds ‖B‖ √3 · 2 u |e| ≤ 2.1e-4. In all 0.944 < 1. (For three edges that
//! are nearly one, the determinant is nothing but rounding, and B is no inverse of anything: without the bound on m³ /
//! det M such cells were wrongly proven.)
//!
//! Second, where that fails, B e − I is computed for each edge e itself. Then it does not matter what B is. Each
//! component goes through the edge's own rounding, a product, two sums and the last difference, n = 5: a column is off
//! by at most 5 u ‖B‖ |e| + u ≤ 3.0e-4 under [`WELL_CONDITIONED`], all three by 5.2e-4, and 0.895 + 0.0006 < 1.

use glam::{DVec3, Mat3A, Vec3A};
use rayon::prelude::*;

use super::{
    motion::SUBDIVISION_DEPTH,
    predicates::{self, orientation},
    star,
};
use crate::voxel::{Complex, Dimension, KUHN};

/// Cells per parallel task.
const CELLS_PER_TASK: usize = 512;

/// What was found.
#[derive(Debug, Clone, Copy)]
pub(super) struct Check {
    /// Elements that are not positive. Exact.
    pub inverted: usize,
    /// Least ratio of an element's volume to its rest volume.
    pub least: f64,
    /// The cell it is in.
    pub smallest: Option<usize>,
}

impl Check {
    const NOTHING: Self = Self { inverted: 0, least: f64::INFINITY, smallest: None };

    fn and(self, other: Self) -> Self {
        // Ties go to the first cell, so that the answer does not depend on threads.
        let key = |c: &Self| (c.least, c.smallest.unwrap_or(usize::MAX));
        let first = if key(&self) <= key(&other) { self } else { other };
        Self { inverted: self.inverted + other.inverted, ..first }
    }
}

/// Checks all elements of a state.
pub(super) fn check(complex: &Complex, positions: &[Vec3A]) -> Check {
    let check_cell = checker(complex.dimension);
    cells(complex).map(|(cell, corners)| check_cell(cell, corners, positions)).reduce(|| Check::NOTHING, Check::and)
}

/// Cells with an element that is not positive in a state, rising. Exact.
pub(super) fn inverted_cells(complex: &Complex, positions: &[Vec3A]) -> Vec<usize> {
    let check_cell = checker(complex.dimension);
    cells(complex)
        .filter(|&(cell, corners)| check_cell(cell, corners, positions).inverted > 0)
        .map(|(cell, _)| cell)
        .collect()
}

/// Checks all elements of the state `to`, and whether they are proven to be positive at every instant of the motion
/// there.
pub(super) fn check_motion(complex: &Complex, from: &[Vec3A], to: &[Vec3A]) -> (Check, bool) {
    let check_cell = checker(complex.dimension);
    let stays_positive = cell_stays_positive(complex.dimension);
    cells(complex)
        .map(|(cell, corners)| {
            (check_cell(cell, corners, to), stays_positive([from, to].map(|p| corners.map(|c| p[c as usize]))))
        })
        .reduce(|| (Check::NOTHING, true), |(a, clear), (b, also)| (a.and(b), clear && also))
}

fn cells(complex: &Complex) -> impl IndexedParallelIterator<Item = (usize, &[u32; 8])> {
    complex.corners.par_iter().enumerate().with_min_len(CELLS_PER_TASK)
}

/// What proves that all elements of a cell stay positive at every instant of a straight motion.
pub(crate) fn cell_stays_positive(dimension: Dimension) -> fn([[Vec3A; 8]; 2]) -> bool {
    match dimension {
        Dimension::Two => flat_cell_stays_positive,
        Dimension::Three => stays_positive,
    }
}

/// What checks a cell of a state.
fn checker(dimension: Dimension) -> fn(usize, &[u32; 8], &[Vec3A]) -> Check {
    match dimension {
        Dimension::Two => check_flat_cell,
        Dimension::Three => check_cell,
    }
}

/// In the plane the sign of every element is taken from the exact predicate.
fn check_flat_cell(cell: usize, corners: &[u32; 8], positions: &[Vec3A]) -> Check {
    let mut check = Check { smallest: Some(cell), ..Check::NOTHING };
    for element in Dimension::Two.elements() {
        let at = element.map(|k| positions[corners[k] as usize].as_dvec3());
        let area = (at[1] - at[0]).truncate().perp_dot((at[2] - at[0]).truncate());
        check.inverted += usize::from(!area.is_finite() || !predicates::is_positive(Dimension::Two, at));
        check.least = check.least.min(area);
    }
    check
}

/// Whether both elements of a flat cell are proven to be positive at every instant of a straight motion. Never wrongly
/// true.
fn flat_cell_stays_positive(ends: [[Vec3A; 8]; 2]) -> bool {
    Dimension::Two.elements().iter().all(|&[a, b, c, _]| flat_stays_positive(ends.map(|at| [at[a], at[b], at[c]])))
}

/// Whether a triangle of the plane is proven to be positive at every instant of a straight motion. Never wrongly true.
///
/// Its area is quadratic in time, and positive where its Bernstein coefficients are.
pub(crate) fn flat_stays_positive(ends: [[Vec3A; 3]; 2]) -> bool {
    flat_stays_positive_with(star::ROUNDING, ends)
}

/// As [`flat_stays_positive`], with a rounding bound.
#[inline(always)]
pub(super) fn flat_stays_positive_with(rounding: f64, ends: [[Vec3A; 3]; 2]) -> bool {
    let [[u, v], [p, q]] = ends.map(|at| {
        let [a, b, c] = at.map(|p| p.as_dvec3().truncate());
        [b - a, c - a]
    });
    let largest = [u, v, p, q].iter().fold(glam::DVec2::ZERO, |m, e| m.max(e.abs())).max_element();
    let coefficients = [u.perp_dot(v), 0.5 * (u.perp_dot(q) + p.perp_dot(v)), p.perp_dot(q)];
    stays_above(rounding * largest * largest, coefficients, SUBDIVISION_DEPTH)
}

/// Bounds the rounding of an element's volume in f32, relative to the cube of its cell's largest component: 48
/// roundings of 2⁻²⁴, 2.9e-6, and room. Also of an area, relative to the square: 8 roundings.
pub(crate) const ROUNDING: f32 = 1.0e-5;

#[inline]
fn check_cell(cell: usize, corners: &[u32; 8], positions: &[Vec3A]) -> Check {
    check_cell_with(ROUNDING, f32::MIN_POSITIVE, cell, corners, positions)
}

/// As [`check_cell`], with a rounding bound and the least one that is trusted.
#[inline(always)]
pub(super) fn check_cell_with(
    rounding: f32,
    least: f32,
    cell: usize,
    corners: &[u32; 8],
    positions: &[Vec3A],
) -> Check {
    let at = corners.map(|c| positions[c as usize]);
    // Every element starts at corner 0.
    let from_first = at.map(|p| p - at[0]);
    let largest = from_first.iter().fold(Vec3A::ZERO, |m, e| m.max(e.abs())).max_element();
    let bound = rounding * largest * largest * largest;
    let in_range = bound > least;
    let mut check = Check { smallest: Some(cell), ..Check::NOTHING };
    // All elements have the diagonal from corner 0 to 7, and each one edge of the three from corner 0 along an axis: three
    // cross products serve all six.
    let [_, x, y, xy, z, xz, yz, diagonal] = from_first;
    let [of_x, of_y, of_z] = [x, y, z].map(|edge| edge.cross(diagonal));
    let volumes = [-xy.dot(of_x), xz.dot(of_x), xy.dot(of_y), -yz.dot(of_y), -xz.dot(of_z), yz.dot(of_z)];
    for (element, volume) in KUHN.into_iter().zip(volumes) {
        let is_clear = in_range && volume > bound && volume.is_finite();
        let mut exact = f64::from(volume);
        if !is_clear {
            let [a, b, c, d] = element.map(|k| at[k].as_dvec3());
            exact = (b - a).dot((c - a).cross(d - a));
            check.inverted += usize::from(!exact.is_finite() || orientation(a, b, c, d) <= 0);
        }
        check.least = check.least.min(exact);
    }
    check
}

/// The twelve edges of a cell along the axes, each as corners.
const EDGES: [[[usize; 2]; 4]; 3] =
    [[[0, 1], [2, 3], [4, 5], [6, 7]], [[0, 2], [1, 3], [4, 6], [5, 7]], [[0, 4], [1, 5], [2, 6], [3, 7]]];

/// ‖B F − I‖² below which an element cannot turn over, and ‖B‖² times the square of the longest edge below which what
/// rounding adds to the norm is far less than the tenth that is left to it.
const FAR_FROM_SINGULAR: f32 = 0.8;
const WELL_CONDITIONED: f32 = 1.0e6;

/// Below this the determinant of a cell's mean edges, in cells, says nothing in single precision.
const LEAST_DETERMINANT: f32 = 1.0e-6;

/// m³ / det M up to which the inverse of a cell's mean edges M, none longer than m, is trusted to be one: it is off by
/// 0.048 then. Twice as much would leave nothing of the tenth.
pub(super) const MOST_SKEWED: f32 = 5.0e4;

/// Whether all elements of a cell are proven to be positive at every instant: see the page. Never wrongly true.
#[inline]
fn stays_positive(ends: [[Vec3A; 8]; 2]) -> bool {
    stays_positive_with(MOST_SKEWED, star::ROUNDING, ends)
}

/// As [`stays_positive`], with the skewness up to which a mean is trusted and the rounding bound of what is left.
#[inline(always)]
pub(super) fn stays_positive_with(most_skewed: f32, rounding: f64, [from, to]: [[Vec3A; 8]; 2]) -> bool {
    let mut edges = [[Vec3A::ZERO; 8]; 3];
    for (edges, along) in edges.iter_mut().zip(EDGES) {
        for (k, [a, b]) in along.into_iter().enumerate() {
            edges[k] = from[b] - from[a];
            edges[k + 4] = to[b] - to[a];
        }
    }
    let mean = edges.map(|e| 0.125 * (((e[0] + e[1]) + (e[2] + e[3])) + ((e[4] + e[5]) + (e[6] + e[7]))));
    let middle = Mat3A::from_cols(mean[0], mean[1], mean[2]);
    let determinant = middle.determinant();
    if determinant < LEAST_DETERMINANT {
        return bernstein(rounding, [from, to]);
    }
    let widest = mean.iter().fold(0.0_f32, |m, e| m.max(e.length_squared()));
    let is_inverse = widest * widest.sqrt() < most_skewed * determinant && determinant.is_finite();
    let inverse = middle.inverse();
    let norm = [inverse.x_axis, inverse.y_axis, inverse.z_axis].map(|c| c.length_squared()).iter().sum::<f32>();
    // ‖B e − B m‖ ≤ ‖B‖ ‖e − m‖ for the mean m of edges e, which is enough for most.
    let (mut far, mut longest) = (0.0_f32, 0.0_f32);
    for (along, mean) in edges.iter().zip(mean) {
        let most = along.iter().fold(0.0_f32, |most, e| most.max((*e - mean).length_squared()));
        far += most;
        longest = longest.max(2.0 * (mean.length_squared() + most));
    }
    if is_inverse && norm * far < FAR_FROM_SINGULAR && norm * longest < WELL_CONDITIONED {
        return is_positive(KUHN[0], &to) || bernstein(rounding, [from, to]);
    }
    let (mut deviation, mut longest) = (0.0_f32, 0.0_f32);
    for (along, axis) in edges.into_iter().zip([Vec3A::X, Vec3A::Y, Vec3A::Z]) {
        let mut most = 0.0_f32;
        for e in along {
            most = most.max((inverse * e - axis).length_squared());
            longest = longest.max(e.length_squared());
        }
        deviation += most;
    }
    let is_linear = deviation < FAR_FROM_SINGULAR && norm * longest < WELL_CONDITIONED;
    (is_linear && is_positive(KUHN[0], &to)) || bernstein(rounding, [from, to])
}

fn is_positive(element: [usize; 4], at: &[Vec3A; 8]) -> bool {
    let [a, b, c, d] = element.map(|k| at[k].as_dvec3());
    orientation(a, b, c, d) > 0
}

/// The same, element by element.
#[cold]
fn bernstein(rounding: f64, [from, to]: [[Vec3A; 8]; 2]) -> bool {
    KUHN.into_iter().all(|element| element_stays_positive(rounding, element, [&from, &to]))
}

/// Whether one element of a cell is proven to be positive at every instant: its volume is cubic in time, and positive
/// where its Bernstein coefficients are.
pub(super) fn element_stays_positive(rounding: f64, element: [usize; 4], [from, to]: [&[Vec3A; 8]; 2]) -> bool {
    let edges = |at: &[Vec3A; 8]| {
        let [a, b, c, d] = element.map(|k| at[k].as_dvec3());
        [b - a, c - a, d - a]
    };
    let (start, end) = (edges(from), edges(to));
    let volume = |pick: [usize; 3]| {
        let [a, b, c]: [DVec3; 3] = std::array::from_fn(|k| [start, end][pick[k]][k]);
        a.dot(b.cross(c))
    };
    let largest = start.iter().chain(&end).fold(DVec3::ZERO, |m, e| m.max(e.abs())).max_element();
    let third = |picks: [[usize; 3]; 3]| picks.map(volume).iter().sum::<f64>() / 3.0;
    let coefficients = [
        volume([0, 0, 0]),
        third([[1, 0, 0], [0, 1, 0], [0, 0, 1]]),
        third([[1, 1, 0], [1, 0, 1], [0, 1, 1]]),
        volume([1, 1, 1]),
    ];
    stays_above(rounding * largest.powi(3), coefficients, SUBDIVISION_DEPTH)
}

/// Whether a polynomial with these Bernstein coefficients is proven to stay above a bound, in halves where it has to be
/// (de Casteljau).
fn stays_above<const N: usize>(bound: f64, mut coefficients: [f64; N], depth: u32) -> bool {
    // Both ends are values.
    if !(coefficients[0] > bound && coefficients[N - 1] > bound) {
        return false;
    }
    if coefficients.iter().all(|&c| c > bound) {
        return true;
    }
    if depth == 0 {
        return false;
    }
    let mut first = coefficients;
    for (k, of_first) in first.iter_mut().enumerate().skip(1) {
        for j in 0..N - k {
            coefficients[j] = 0.5 * (coefficients[j] + coefficients[j + 1]);
        }
        *of_first = coefficients[0];
    }
    stays_above(bound, first, depth - 1) && stays_above(bound, coefficients, depth - 1)
}
