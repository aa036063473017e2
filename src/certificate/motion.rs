//! Motions: pairs of triangles proven apart at every instant while their corners move along straight lines.
//!
//! A direction along which one lies before the other at both ends has it before the other all the way, since the
//! difference of two corners along a fixed direction is linear in time. Where no direction serves for the whole motion,
//! its halves are looked at.

use glam::DVec3;

use super::star::{Normals, ROUNDING};

/// Halvings of a motion.
const DEPTH: u32 = 5;

/// A triangle's corners at both ends of a motion.
pub(super) type Moving = [[DVec3; 3]; 2];

/// Whether two moving triangles are proven to have nothing in common but the corners they share, all the way. Never
/// wrongly true. Ids are equal where corners are the same point.
pub(super) fn stay_apart(s: &Moving, t: &Moving, s_ids: [u32; 3], t_ids: [u32; 3]) -> bool {
    // Shared corners first, in both; a corner that is shared comes in the same place in both.
    let shared: Vec<(usize, usize)> =
        (0..3).filter_map(|i| (0..3).find(|&j| s_ids[i] == t_ids[j]).map(|j| (i, j))).collect();
    match shared[..] {
        [] => halved(s, t, DEPTH, &|s, t| {
            let [m, n] = [middle(s), middle(t)];
            [normal(&m), normal(&n), centre(&n) - centre(&m)].into_iter().any(|d| is_between(s, t, d))
        }),
        [(i, j)] => halved(s, t, DEPTH, &|s, t| {
            let far = |p: &Moving, k: usize| p.map(|p| [p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]]);
            let (far_s, far_t) = (far(s, i), far(t, j));
            let [m, n] = [middle(s), middle(t)];
            let apart = (centre(&n) - n[j]).normalize_or_zero() - (centre(&m) - m[i]).normalize_or_zero();
            [apart, normal(&m), -normal(&m), normal(&n), -normal(&n)]
                .into_iter()
                .any(|d| is_within(&far_s, -d) && is_within(&far_t, d))
        }),
        [(i, j), (k, l)] => {
            // Seen along some direction, both turn the same way around their common edge: they lie on its two sides.
            let opposite = ((k + 3 - i) % 3 == 1) != ((l + 3 - j) % 3 == 1);
            halved(s, t, DEPTH, &|s, t| {
                let flipped = if opposite { *t } else { t.map(|[a, b, c]| [a, c, b]) };
                let (of_s, of_t) = (Normals::of(*s), Normals::of(flipped));
                let [m, n] = [of_s, of_t].map(|n| n.coefficients.iter().sum::<DVec3>().normalize_or_zero());
                of_s.are_along(m + n) && of_t.are_along(m + n)
            })
        }
        _ => false,
    }
}

fn halved(s: &Moving, t: &Moving, depth: u32, proof: &dyn Fn(&Moving, &Moving) -> bool) -> bool {
    if proof(s, t) {
        return true;
    }
    let halves = |p: &Moving| [[p[0], middle(p)], [middle(p), p[1]]];
    depth > 0 && halves(s).iter().zip(&halves(t)).all(|(s, t)| halved(s, t, depth - 1, proof))
}

fn middle(p: &Moving) -> [DVec3; 3] {
    std::array::from_fn(|k| 0.5 * (p[0][k] + p[1][k]))
}

fn centre(p: &[DVec3; 3]) -> DVec3 {
    (p[0] + p[1] + p[2]) / 3.0
}

fn normal(p: &[DVec3; 3]) -> DVec3 {
    (p[1] - p[0]).cross(p[2] - p[0])
}

/// Whether all of one lies strictly before all of the other along a direction, at both ends in the same order.
fn is_between(s: &Moving, t: &Moving, direction: DVec3) -> bool {
    let largest = s.iter().chain(t).flatten().fold(DVec3::ZERO, |m, p| m.max(p.abs())).max_element();
    let bound = ROUNDING * largest * direction.abs().element_sum();
    let range = |p: &[DVec3; 3]| {
        let along = p.map(|p| p.dot(direction));
        (along[0].min(along[1]).min(along[2]), along[0].max(along[1]).max(along[2]))
    };
    let ranges = [0, 1].map(|end| (range(&s[end]), range(&t[end])));
    ranges.iter().all(|((_, high), (low, _))| low - high > bound)
        || ranges.iter().all(|((low, _), (_, high))| low - high > bound)
}

/// Whether offsets from a common corner lie strictly on one side of the plane across a direction, at both ends.
fn is_within(far: &[[DVec3; 2]; 2], direction: DVec3) -> bool {
    let sum = direction.abs().element_sum();
    far.iter().flatten().all(|offset| offset.dot(direction) > ROUNDING * offset.abs().max_element() * sum)
}
