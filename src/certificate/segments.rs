//! Segments of the plane, proven apart at every instant while their ends move along straight lines.
//!
//! # Theory
//! Two segments are apart if one lies strictly on one side of the other's line. On which side a moving point lies of a
//! moving line is quadratic in time, and has one sign at every instant if its three Bernstein coefficients have. What
//! lies on one line is set apart by a fixed direction. Segments from one common point have only that in common unless
//! they run along each other: their cross product keeps its sign, or their dot product stays negative.
//!
//! Where none of this holds for the whole motion, its halves are looked at. Segments that keep any distance are proven
//! so in the end; what is left comes nearer than a part in 2^[`SUBDIVISION_DEPTH`] of the motion.
//!
//! # Rounding
//! Double precision. A product of two differences u, v of sizes at most L and L': 2 differences, the product, a sum,
//! and the mean of two: n = 5, Σ |terms| ≤ 2 L L': 10 u L L' = 1.1e-15 L L', against 1e-13. Where the motion was cut,
//! differences are off by e = 2 · [`MIDPOINT`](super::star::MIDPOINT) · X (page `motion`), which changes a product by
//! at most L e + L' e + e² in each of two terms: 2 e (L + L' + e) more. Along a direction: n = 3 for a dot product of
//! differences from one point, one for the gap: 8 u L S, and e S for the corners.

use glam::DVec2;

use super::{
    motion::{SUBDIVISION_DEPTH, subdivided},
    star::Rounding,
};

/// A segment's ends at both ends of a motion. A state is a motion whose two ends are the same.
pub(super) type Moving = [[DVec2; 2]; 2];

/// Whether two moving segments are proven to have nothing in common but the end they share, at every instant. Never
/// wrongly true. Ids are equal where ends are the same point.
pub(super) fn stay_apart(s: &Moving, t: &Moving, s_ids: [u32; 2], t_ids: [u32; 2]) -> bool {
    stay_apart_with(Rounding::PROVEN, s, t, s_ids, t_ids)
}

/// As [`stay_apart`], with rounding bounds.
fn stay_apart_with(rounding: Rounding, s: &Moving, t: &Moving, s_ids: [u32; 2], t_ids: [u32; 2]) -> bool {
    let (mut shared, mut count) = ((0, 0), 0);
    for (i, id) in s_ids.iter().enumerate() {
        if let Some(j) = t_ids.iter().position(|other| other == id) {
            shared = (i, j);
            count += 1;
        }
    }
    let (i, j) = shared;
    match count {
        0 => subdivided(s, t, SUBDIVISION_DEPTH, &|s, t| are_apart(rounding, s, t)),
        1 => subdivided(s, t, SUBDIVISION_DEPTH, &|s, t| are_apart_around(rounding, s, t, (i, j))),
        _ => false,
    }
}

/// Whether two segments without a common end are set apart by one of their lines or by a fixed direction.
pub(super) fn are_apart(rounding: Rounding, s: &Moving, t: &Moving) -> bool {
    is_beside(rounding, s, t) || is_beside(rounding, t, s) || is_before(rounding, s, t)
}

/// Whether two segments from a common end, the i-th of one and the j-th of the other, do not come to run along each
/// other.
pub(super) fn are_apart_around(rounding: Rounding, s: &Moving, t: &Moving, (i, j): (usize, usize)) -> bool {
    let (u, v) = (s.map(|p| p[1 - i] - p[i]), t.map(|p| p[1 - j] - p[j]));
    let misplaced = misplaced(rounding, s, t);
    let is_positive = |c: [f64; 3]| is_positive(rounding.product, misplaced, c, u, v);
    let cross = coefficients(u, v, DVec2::perp_dot);
    is_positive(cross) || is_positive(cross.map(|c| -c)) || is_positive(coefficients(u, v, |u, v| -u.dot(v)))
}

/// Bernstein coefficients of a product of two vectors that change from the first to the second.
fn coefficients(u: [DVec2; 2], v: [DVec2; 2], product: impl Fn(DVec2, DVec2) -> f64) -> [f64; 3] {
    [product(u[0], v[0]), 0.5 * (product(u[0], v[1]) + product(u[1], v[0])), product(u[1], v[1])]
}

/// Bounds how far off the difference of two corners is at an instant that a motion was cut at.
fn misplaced(rounding: Rounding, s: &Moving, t: &Moving) -> f64 {
    let furthest = s.iter().chain(t).flatten().fold(DVec2::ZERO, |m, p| m.max(p.abs())).max_element();
    2.0 * rounding.midpoint * furthest
}

/// Whether such coefficients are positive beyond all rounding.
fn is_positive(rounding: f64, misplaced: f64, coefficients: [f64; 3], u: [DVec2; 2], v: [DVec2; 2]) -> bool {
    let largest = |v: [DVec2; 2]| v[0].abs().max(v[1].abs()).max_element();
    let (of_u, of_v) = (largest(u), largest(v));
    let bound = rounding * of_u * of_v + 2.0 * misplaced * (of_u + of_v + misplaced);
    coefficients.iter().all(|&c| c > bound)
}

/// Whether all of t lies strictly on one side of the line of s.
fn is_beside(rounding: Rounding, s: &Moving, t: &Moving) -> bool {
    let misplaced = misplaced(rounding, s, t);
    let along = s.map(|[a, b]| b - a);
    let to = |k: usize| [t[0][k] - s[0][0], t[1][k] - s[1][0]];
    let sides = [0, 1].map(|k| coefficients(along, to(k), DVec2::perp_dot));
    let is_on =
        |sign: f64| (0..2).all(|k| is_positive(rounding.product, misplaced, sides[k].map(|c| sign * c), along, to(k)));
    is_on(1.0) || is_on(-1.0)
}

/// Whether all of s lies strictly before all of t along the line between their middles.
fn is_before(rounding: Rounding, s: &Moving, t: &Moving) -> bool {
    let misplaced = misplaced(rounding, s, t);
    let origin = s[0][0];
    let [s, t] = [s, t].map(|p| p.map(|p| p.map(|p| p - origin)));
    let sum = |p: &Moving| p[0][0] + p[0][1] + p[1][0] + p[1][1];
    let direction = sum(&t) - sum(&s);
    let largest = s.iter().chain(&t).flatten().fold(DVec2::ZERO, |m, p| m.max(p.abs())).max_element();
    let bound = (rounding.product * largest + misplaced) * direction.abs().element_sum();
    let along = |p: DVec2| p.dot(direction);
    let gap = |end: usize| along(t[end][0]).min(along(t[end][1])) - along(s[end][0]).max(along(s[end][1]));
    gap(0) > bound && gap(1) > bound
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certificate::{Triangle, segments_cross};
    use proptest::prelude::*;

    /// Whether they cross at one of many instants. Exact where positions are: ends are multiples of 64.
    fn cross_at_times(s: &Moving, t: &Moving, ids: [[u32; 2]; 2]) -> bool {
        (0..=64).any(|k| {
            let part = f64::from(k) / 64.0;
            let at = |p: &Moving, id: [u32; 2]| {
                let [a, b] = [0, 1].map(|c| p[0][c].lerp(p[1][c], part).extend(0.0));
                Triangle { at: [a, b, b], id: [id[0], id[1], id[1]] }
            };
            segments_cross(&at(s, ids[0]), &at(t, ids[1]))
        })
    }

    fn points() -> impl Strategy<Value = Vec<DVec2>> {
        let coordinate = || (-4..5_i8).prop_map(|x| 64.0 * f64::from(x));
        prop::collection::vec((coordinate(), coordinate()).prop_map(DVec2::from), 8)
    }

    proptest! {
        #[test]
        fn what_is_proven_apart_never_crosses_and_the_rest_comes_near(points in points(), shared in 0..2_usize) {
            let s: Moving = [[points[0], points[1]], [points[2], points[3]]];
            let first = |end: usize| if shared == 1 { s[end][1] } else { points[4 + 2 * end] };
            let t: Moving = [[first(0), points[5]], [first(1), points[7]]];
            let ids = [[0, 1], [2 - shared as u32, 3]];
            if stay_apart(&s, &t, ids[0], ids[1]) {
                prop_assert!(!cross_at_times(&s, &t, ids), "{s:?} {t:?}");
            } else if shared == 0 {
                let distance = (0..=4096).map(|k| {
                    let at = |p: &Moving| [0, 1].map(|c| p[0][c].lerp(p[1][c], f64::from(k) / 4096.0));
                    let (s, t) = (at(&s), at(&t));
                    let to_segment = |p: DVec2, [a, b]: [DVec2; 2]| {
                        let along = (b - a).length_squared().max(f64::MIN_POSITIVE);
                        p.distance(a + (b - a) * ((p - a).dot(b - a) / along).clamp(0.0, 1.0))
                    };
                    let ends = [to_segment(s[0], t), to_segment(s[1], t), to_segment(t[0], s), to_segment(t[1], s)];
                    let crosses = (s[1] - s[0]).perp_dot(t[0] - s[0]) * (s[1] - s[0]).perp_dot(t[1] - s[0]) < 0.0
                        && (t[1] - t[0]).perp_dot(s[0] - t[0]) * (t[1] - t[0]).perp_dot(s[1] - t[0]) < 0.0;
                    if crosses { 0.0 } else { ends.into_iter().fold(f64::INFINITY, f64::min) }
                });
                prop_assert!(distance.fold(f64::INFINITY, f64::min) < 2.0, "{s:?} {t:?}");
            }
        }
    }

    #[test]
    fn a_tip_that_passes_another_near_the_end_is_seen() {
        let still: Moving = [[DVec2::new(0.0, 0.0), DVec2::new(0.0, 8.0)]; 2];
        let tip = |x: f64, y: f64| [DVec2::new(x, y), DVec2::new(x + 4.0, y)];
        // Through the line and out above its upper end, between two of the eighths that could be looked at.
        let through: Moving = [tip(0.5, 7.0), tip(-0.1, 8.1)];
        assert!(!stay_apart(&still, &through, [0, 1], [2, 3]));
        let beside: Moving = [tip(0.5, 7.0), tip(0.1, 8.1)];
        assert!(stay_apart(&still, &beside, [0, 1], [2, 3]));
        let closing: Moving = [[DVec2::ZERO, DVec2::new(4.0, 1.0)], [DVec2::ZERO, DVec2::new(-1.0, 4.0)]];
        assert!(!stay_apart(&still, &closing, [0, 1], [0, 3]));
        let swinging: Moving = [closing[0], [DVec2::ZERO, DVec2::new(1.0, -4.0)]];
        assert!(stay_apart(&still, &swinging, [0, 1], [0, 3]));
    }
}
