//! Motions: pairs of triangles proven apart at every instant while their corners move along straight lines.
//!
//! # Theory
//! A direction along which one lies before the other at both ends has it before the other at every instant, since the
//! difference of two corners along a fixed direction is linear in time. Where no direction serves for the whole motion,
//! its two halves are looked at. At a single instant there always is one for triangles that are apart: from the nearest
//! point of one to the nearest of the other; for triangles with a common corner, whose other corners are looked at as
//! directions from there, the point nearest to the origin of all that lies between these (those of one of them turned
//! around). Triangles with a common edge are seen along one direction, where their normals, quadratic in time, must
//! point to it (page `star`).
//!
//! A direction may be any vector: it is a proof if it serves, wherever it comes from. So what follows counts the
//! roundings of the test alone, not those of finding the direction. S is the sum of its components' sizes.
//!
//! # Cuts
//! A motion is cut at its middle, `m = fl(fl(x₀ + x₁) / 2)`, and its halves in turn, at most [`SUBDIVISION_DEPTH`] = 10
//! times. A middle that is rounded is not on the line; the two halves then are not halves of the motion that is meant.
//! It must be known how far off they are.
//!
//! **Lemma.** Let x₀ and x₁ be numbers of single precision. A coordinate that is computed at `τ = i / 1024` by cutting
//! is `x(τ)(1 + θ)` with |θ| ≤ 10.1 u, u = 2⁻⁵³.
//!
//! *Proof.* If one of the ends is zero, or both are, all is exact but for powers of two: let none be, |x₀| ≥ |x₁|, with
//! exponents e₀ ≥ e₁: 2^e ≤ |x| < 2^(e + 1). (For numbers below the normal ones the units are larger than their
//! exponent says, which only helps.)
//!
//! - *e₀ − e₁ ≤ 19.* All x(τ) at depth k are multiples of 2^(e₁ − 23 − k) and below 2^(e₀ + 1), and the sums that are
//!   halved are multiples of 2^(e₁ − 23 − (k − 1)) and below 2^(e₀ + 2): that takes at most e₀ − e₁ + 24 + k ≤ 53 bits.
//!   Everything is exact.
//! - *e₀ − e₁ ≥ 20.* Then |x₁| < 2⁻¹⁹ X with X = |x₀|. Count τ from the small end: x(τ) differs from ± X τ by less than
//!   2⁻¹⁹ X ≤ 2⁻⁹ X τ, for τ ≥ 2⁻¹⁰. The error ε(τ) at depth k is at most `k (1 + 2⁻⁸) u X τ`: a middle has the mean of
//!   its ends' errors, which is `(k − 1)(1 + 2⁻⁸) u X τ` with τ the middle of theirs, and one rounding of `u |x(τ)|(1 +
//!   10 u)`. For k = 10 this is 10.04 u X τ ≤ 10.1 u |x(τ)|.
//!
//! Halving itself is exact, far above the least numbers of double precision. ∎
//!
//! [`MIDPOINT`](super::star::MIDPOINT) is 12 u. With X now the largest coordinate at hand, every coordinate is off by
//! at most 12 u X and every difference of two corners by `2 · 12 u X` — *however small the difference*: triangles that
//! are small and far away feel it, and a bound relative to their edges alone would not do.
//!
//! # Rounding
//! - *Two triangles along a direction, single precision* ([`lie_apart`]; ends only, nothing is cut): differences from
//!   one corner, of size at most L; n = 1 + 3 for a dot product, one more for the gap between two of them: 2 · 5 u L S
//!   = 6.0e-7 L S, against 6e-6.
//! - *The same in double precision*: coordinates of at most X; n = 3 for a dot product, 10.1 u for the corner itself,
//!   twice, and the gap's own rounding, 2 u X S: 28.2 u X S = 3.1e-15 X S, against 1e-13.
//! - *Around a common corner*: offsets from it of at most L, n = 4: 4 u L S = 4.4e-16 L S, against 1e-13; and 2 · 12 u
//!   X S for the corners.
//! - *Across a common edge*: page `star`.
//!
//! # Practice
//! Directions that are cheap to find come first. Triangles that keep any distance are proven to do so in the end; what
//! is left comes nearer than a part in 2^[`SUBDIVISION_DEPTH`] of the motion.

use std::ops::{Add, Mul};

use glam::{DVec3, Vec3A};

use super::star::{Normals, Rounding, SINGLE_ROUNDING, is_in_range};

/// Halvings of a motion at most.
pub(super) const SUBDIVISION_DEPTH: u32 = 10;

/// A triangle's corners at both ends of a motion.
pub(super) type Moving = [[DVec3; 3]; 2];

/// Whether two moving triangles without a common corner are proven apart at every instant along the line between their
/// middles, in f32: serves for most. Never wrongly true.
#[inline]
pub(super) fn lie_apart(s: [[Vec3A; 3]; 2], t: [[Vec3A; 3]; 2]) -> bool {
    lie_apart_with(SINGLE_ROUNDING, s, t)
}

/// As [`lie_apart`], with a rounding bound.
#[inline(always)]
pub(super) fn lie_apart_with(rounding: f32, s: [[Vec3A; 3]; 2], t: [[Vec3A; 3]; 2]) -> bool {
    let origin = s[0][0];
    let [s, t] = [s, t].map(|p| p.map(|p| p.map(|p| p - origin)));
    let sum = |p: &[[Vec3A; 3]; 2]| p.iter().flatten().sum::<Vec3A>();
    let direction = sum(&t) - sum(&s);
    let largest = s.iter().chain(&t).flatten().fold(Vec3A::ZERO, |m, p| m.max(p.abs())).max_element();
    let bound = rounding * largest * direction.abs().element_sum();
    let gap = |end: usize| {
        let [s, t] = [s[end], t[end]].map(|p| p.map(|p| p.dot(direction)));
        t[0].min(t[1]).min(t[2]) - s[0].max(s[1]).max(s[2])
    };
    is_in_range(bound) && gap(0) > bound && gap(1) > bound
}

/// Whether two moving triangles are proven to have nothing in common but the corners they share, at every instant.
/// Never wrongly true. Ids are equal where corners are the same point. A state is a motion whose two ends are the same,
/// and needs no subdivision.
pub(super) fn stay_apart(s: &Moving, t: &Moving, s_ids: [u32; 3], t_ids: [u32; 3], depth: u32) -> bool {
    stay_apart_with(Rounding::PROVEN, s, t, s_ids, t_ids, depth)
}

/// As [`stay_apart`], with rounding bounds.
fn stay_apart_with(rounding: Rounding, s: &Moving, t: &Moving, s_ids: [u32; 3], t_ids: [u32; 3], depth: u32) -> bool {
    let (mut shared, mut count) = ([(0, 0); 3], 0);
    for (i, id) in s_ids.iter().enumerate() {
        if let Some(j) = t_ids.iter().position(|other| other == id) {
            shared[count] = (i, j);
            count += 1;
        }
    }
    match shared[..count] {
        [] => subdivided(s, t, depth, &|s, t| are_apart(rounding, s, t)),
        [at] => subdivided(s, t, depth, &|s, t| are_apart_around(rounding, s, t, at)),
        [(i, j), (k, l)] => {
            // Seen along some direction, both turn the same way around their common edge: they lie on its two sides.
            let opposite = ((k + 3 - i) % 3 == 1) != ((l + 3 - j) % 3 == 1);
            subdivided(s, t, depth, &|s, t| are_apart_across(rounding, s, t, opposite))
        }
        _ => false,
    }
}

/// Whether a fixed direction sets two triangles without a common corner apart at both ends, in the same order.
pub(super) fn are_apart(rounding: Rounding, s: &Moving, t: &Moving) -> bool {
    let [m, n] = [middle(s), middle(t)];
    let of_m = normal(&m);
    let is_between = |d: DVec3| is_between(rounding, s, t, d);
    if [centre(&n) - centre(&m), of_m, normal(&n)].into_iter().any(is_between) {
        return true;
    }
    // Side by side in one plane.
    [m, n].iter().any(|p| (0..3).any(|k| is_between(of_m.cross(p[(k + 1) % 3] - p[k]))))
        || is_between(offset_between(&m, &n))
}

/// Whether a fixed plane through a common corner, the i-th of one and the j-th of the other, has the rest of two
/// triangles on its two sides at both ends.
pub(super) fn are_apart_around(rounding: Rounding, s: &Moving, t: &Moving, (i, j): (usize, usize)) -> bool {
    let far = |p: &Moving, k: usize| p.map(|p| [p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]]);
    let (far_s, far_t) = (far(s, i), far(t, j));
    let [m, n] = [middle(s), middle(t)];
    let apart = (centre(&n) - n[j]).normalize_or_zero() - (centre(&m) - m[i]).normalize_or_zero();
    let misplaced = 2.0 * rounding.midpoint * furthest(s).max(furthest(t));
    let is_within = |far: &[[DVec3; 2]; 2], d: DVec3| is_within(rounding.product, misplaced, far, d);
    let serves = |d: DVec3| is_within(&far_s, -d) && is_within(&far_t, d);
    [apart, normal(&m), -normal(&m), normal(&n), -normal(&n)].into_iter().any(serves) || {
        let ([a, b], [c, d]) = (ahead(&m, i), ahead(&n, j));
        serves(nearest_to_origin([-a, -b, c, d]))
    }
}

/// Whether two triangles with a common edge, which they have in opposite order or not, are seen side by side along a
/// fixed direction at every instant between two ends.
pub(super) fn are_apart_across(rounding: Rounding, s: &Moving, t: &Moving, opposite: bool) -> bool {
    let flipped = if opposite { *t } else { t.map(|[a, b, c]| [a, c, b]) };
    let (of_s, of_t) = (Normals::of(*s, rounding), Normals::of(flipped, rounding));
    let [m, n] = [of_s, of_t].map(|n| n.coefficients.iter().sum::<DVec3>().normalize_or_zero());
    of_s.are_along(m + n) && of_t.are_along(m + n)
}

/// Corners at both ends of a motion.
pub(super) type Corners<V, const N: usize> = [[V; N]; 2];

/// Whether a proof comes out for a motion of two, or for its halves, theirs and so on.
pub(super) fn subdivided<V, const N: usize>(
    s: &Corners<V, N>,
    t: &Corners<V, N>,
    depth: u32,
    proof: &impl Fn(&Corners<V, N>, &Corners<V, N>) -> bool,
) -> bool
where
    V: Copy + Add<Output = V> + Mul<f64, Output = V>,
{
    if proof(s, t) {
        return true;
    }
    if depth == 0 {
        return false;
    }
    let (m, n) = (middle(s), middle(t));
    subdivided(&[s[0], m], &[t[0], n], depth - 1, proof) && subdivided(&[m, s[1]], &[n, t[1]], depth - 1, proof)
}

pub(super) fn middle<V, const N: usize>(p: &Corners<V, N>) -> [V; N]
where
    V: Copy + Add<Output = V> + Mul<f64, Output = V>,
{
    std::array::from_fn(|k| (p[0][k] + p[1][k]) * 0.5)
}

fn centre(p: &[DVec3; 3]) -> DVec3 {
    (p[0] + p[1] + p[2]) / 3.0
}

/// Directions from a corner to the two others.
fn ahead(p: &[DVec3; 3], k: usize) -> [DVec3; 2] {
    [1, 2].map(|step| (p[(k + step) % 3] - p[k]).normalize_or_zero())
}

fn normal(p: &[DVec3; 3]) -> DVec3 {
    (p[1] - p[0]).cross(p[2] - p[0])
}

/// From the nearest point of one triangle to the nearest of another, where they are apart.
fn offset_between(s: &[DVec3; 3], t: &[DVec3; 3]) -> DVec3 {
    let edges = |p: &[DVec3; 3]| [0, 1, 2].map(|k| [p[k], p[(k + 1) % 3]]);
    let between_edges = edges(s).into_iter().flat_map(|e| edges(t).map(|f| offset_between_segments(e, f)));
    let from_s = t.iter().filter_map(|&p| foot(p, s).map(|foot| p - foot));
    let to_t = s.iter().filter_map(|&p| foot(p, t).map(|foot| foot - p));
    shortest(between_edges.chain(from_s).chain(to_t))
}

/// The point nearest to the origin of all that lies between four.
fn nearest_to_origin(p: [DVec3; 4]) -> DVec3 {
    let edges = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];
    let faces = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]];
    let on_edges = edges.map(|[a, b]| offset_between_segments([DVec3::ZERO; 2], [p[a], p[b]]));
    shortest(on_edges.into_iter().chain(faces.into_iter().filter_map(|face| foot(DVec3::ZERO, &face.map(|k| p[k])))))
}

fn shortest(offsets: impl IntoIterator<Item = DVec3>) -> DVec3 {
    offsets.into_iter().min_by(|a, b| a.length_squared().total_cmp(&b.length_squared())).unwrap_or_default()
}

/// The foot of the perpendicular from a point onto a triangle, if it lies in it.
fn foot(p: DVec3, &[a, b, c]: &[DVec3; 3]) -> Option<DVec3> {
    let (u, v, w) = (b - a, c - a, p - a);
    let (uu, uv, vv) = (u.dot(u), u.dot(v), v.dot(v));
    let (wu, wv) = (w.dot(u), w.dot(v));
    let determinant = uu * vv - uv * uv;
    let (x, y) = ((vv * wu - uv * wv) / determinant, (uu * wv - uv * wu) / determinant);
    (x >= 0.0 && y >= 0.0 && x + y <= 1.0).then(|| a + x * u + y * v)
}

/// From the nearest point of one segment to the nearest of another (Ericson 2005, *Real-Time Collision Detection*,
/// 5.1.9).
fn offset_between_segments([a, b]: [DVec3; 2], [c, d]: [DVec3; 2]) -> DVec3 {
    let (u, v, w) = (b - a, d - c, a - c);
    let part = |x: f64, of: f64| if of > 0.0 { (x / of).clamp(0.0, 1.0) } else { 0.0 };
    let (uu, uv, vv) = (u.dot(u), u.dot(v), v.dot(v));
    let (uw, vw) = (u.dot(w), v.dot(w));
    let on_first = part(uv * vw - uw * vv, uu * vv - uv * uv);
    let on_second = part(uv * on_first + vw, vv);
    let on_first = part(uv * on_second - uw, uu);
    on_second * v - on_first * u - w
}

/// Whether all of one lies strictly before all of the other along a direction, at both ends in the same order.
fn is_between(rounding: Rounding, s: &Moving, t: &Moving, direction: DVec3) -> bool {
    let largest = furthest(s).max(furthest(t));
    let bound = rounding.product * largest * direction.abs().element_sum();
    let range = |p: &[DVec3; 3]| {
        let along = p.map(|p| p.dot(direction));
        (along[0].min(along[1]).min(along[2]), along[0].max(along[1]).max(along[2]))
    };
    let ranges = [0, 1].map(|end| (range(&s[end]), range(&t[end])));
    ranges.iter().all(|((_, high), (low, _))| low - high > bound)
        || ranges.iter().all(|((low, _), (_, high))| low - high > bound)
}

/// Largest coordinate of a moving triangle.
fn furthest(p: &Moving) -> f64 {
    p.iter().flatten().fold(DVec3::ZERO, |m, p| m.max(p.abs())).max_element()
}

/// Whether offsets from a common corner lie strictly on one side of the plane across a direction, at both ends.
fn is_within(rounding: f64, misplaced: f64, far: &[[DVec3; 2]; 2], direction: DVec3) -> bool {
    let sum = direction.abs().element_sum();
    far.iter().flatten().all(|offset| offset.dot(direction) > (rounding * offset.abs().max_element() + misplaced) * sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certificate::{Triangle, triangles_cross};
    use proptest::prelude::*;

    fn single(p: &Moving) -> [[Vec3A; 3]; 2] {
        p.map(|p| p.map(|p| p.as_vec3a()))
    }

    /// Whether they cross at one of many instants.
    fn cross_at_times(s: &Moving, t: &Moving, ids: [[u32; 3]; 2]) -> bool {
        (0..=64).any(|k| {
            let part = f64::from(k) / 64.0;
            let at = |p: &Moving| std::array::from_fn(|c| p[0][c].lerp(p[1][c], part));
            triangles_cross(&Triangle { at: at(s), id: ids[0] }, &Triangle { at: at(t), id: ids[1] })
        })
    }

    fn points() -> impl Strategy<Value = Vec<DVec3>> {
        let coordinate = || (-4..5_i8).prop_map(f64::from);
        prop::collection::vec((coordinate(), coordinate(), coordinate()).prop_map(DVec3::from), 12)
    }

    proptest! {
        #[test]
        fn what_is_proven_apart_never_crosses(points in points(), shared in 0..3_usize, near in 0.0..1.0_f64) {
            // Both ends are whole numbers, nearer to each other or further apart.
            let end = |from: DVec3, k: usize| (near * points[k] + (1.0 - near) * from).round();
            let s: Moving = [0, 1].map(|e| std::array::from_fn(|k| if e == 0 { points[k] } else { end(points[k], 6 + k) }));
            let t: Moving = [0, 1].map(|e: usize| std::array::from_fn(|k| match (k < shared, e) {
                (true, _) => s[e][2 - k],
                (false, 0) => points[3 + k],
                (false, _) => end(points[3 + k], 9 + k),
            }));
            let ids = [[0, 1, 2], std::array::from_fn(|k| if k < shared { 2 - k as u32 } else { 3 + k as u32 })];
            if stay_apart(&s, &t, ids[0], ids[1], SUBDIVISION_DEPTH) {
                prop_assert!(!cross_at_times(&s, &t, ids), "{s:?} {t:?} {ids:?}");
            }
            if shared == 0 && lie_apart(single(&s), single(&t)) {
                prop_assert!(!cross_at_times(&s, &t, ids), "{s:?} {t:?}");
            }
        }
    }

    proptest! {
        /// Positions are multiples of a sixteenth, and nothing moves by more than four in all.
        #[test]
        fn what_is_not_proven_apart_comes_near(points in points(), drift in points(), shared in 0..2_usize) {
            let end = |from: DVec3, k: usize| from + drift[k] / 4.0;
            let s: Moving = [0, 1].map(|e| std::array::from_fn(|k| if e == 0 { points[k] } else { end(points[k], k) }));
            let t: Moving = [0, 1].map(|e: usize| std::array::from_fn(|k| match (k < shared, e) {
                (true, _) => s[e][2 - k],
                (false, 0) => points[3 + k],
                (false, _) => end(points[3 + k], 3 + k),
            }));
            let ids = [[0, 1, 2], std::array::from_fn(|k| if k < shared { 2 - k as u32 } else { 3 + k as u32 })];
            if !stay_apart(&s, &t, ids[0], ids[1], SUBDIVISION_DEPTH) {
                // Of triangles with a common corner it is the angle between them that vanishes.
                let nearest = (0..=1024).map(|k| {
                    let part = f64::from(k) / 1024.0;
                    let [m, n] = [&s, &t].map(|p| -> [DVec3; 3] { std::array::from_fn(|c| p[0][c].lerp(p[1][c], part)) });
                    if triangles_cross(&Triangle { at: m, id: ids[0] }, &Triangle { at: n, id: ids[1] }) {
                        return 0.0;
                    }
                    if shared == 0 {
                        return offset_between(&m, &n).length();
                    }
                    let ([a, b], [c, d]) = (ahead(&m, 2), ahead(&n, 0));
                    nearest_to_origin([-a, -b, c, d]).length()
                });
                let nearest = nearest.fold(f64::INFINITY, f64::min);
                prop_assert!(nearest < 0.02, "{nearest} {s:?} {t:?} {ids:?}");
            }
        }
    }

    const FLOOR: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];

    fn moved(by: DVec3) -> [DVec3; 3] {
        FLOOR.map(|p| DVec3::from(p) + by)
    }

    #[test]
    fn triangles_that_pass_by_are_proven_apart() {
        // One slides below the other and up beside it, while both drift far.
        let drift = DVec3::new(30.0, 20.0, 10.0);
        let s = [moved(DVec3::ZERO), moved(drift)];
        let t = [moved(-DVec3::Z), moved(drift + DVec3::new(9.0, 0.0, -0.5))];
        assert!(stay_apart(&s, &t, [0, 1, 2], [3, 4, 5], SUBDIVISION_DEPTH));
        let above = [moved(DVec3::Z), moved(drift + DVec3::Z)];
        assert!(lie_apart(single(&s), single(&above)) && lie_apart(single(&above), single(&s)));
        let hinge = |tip: [f64; 3]| [DVec3::from(FLOOR[1]), DVec3::from(FLOOR[0]), DVec3::from(tip)];
        let opening = [hinge([1.0, 0.1, 1.0]), hinge([1.0, -2.0, -1.0])];
        assert!(stay_apart(&[s[0]; 2], &opening, [0, 1, 2], [1, 0, 3], SUBDIVISION_DEPTH));
    }

    #[test]
    fn sabotage_triangles_that_pass_through_each_other_are_not() {
        let s = [moved(DVec3::ZERO); 2];
        let t = [moved(DVec3::Z), moved(-DVec3::Z)];
        assert!(!stay_apart(&s, &t, [0, 1, 2], [3, 4, 5], SUBDIVISION_DEPTH));
        assert!(!lie_apart(single(&s), single(&t)));
        let hinge = |tip: [f64; 3]| [DVec3::from(FLOOR[1]), DVec3::from(FLOOR[0]), DVec3::from(tip)];
        let through = [hinge([1.0, 2.0, 1.0]), hinge([1.0, 2.0, -1.0])];
        assert!(!stay_apart(&s, &through, [0, 1, 2], [1, 0, 3], SUBDIVISION_DEPTH));
    }
}
