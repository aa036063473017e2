//! Polygons into triangles: quads by the diagonal that folds least, larger ones by ear clipping.

use glam::{DVec2, DVec3};

/// Polygons with more corners are fanned: ear clipping takes at least quadratic time, and no modeller makes a concave face this
/// large. A tenth would fan real caps of lathed parts; ten times would let one malicious face take minutes.
const MAX_EARS: usize = 1024;

/// Triangles of one polygon, as indices into `corners` (`0..corners.len()`), in the polygon's orientation.
///
/// The polygon need not be planar or convex; each triangulation has `corners.len() - 2` triangles, degenerate ones included,
/// so that every corner stays in use.
pub(crate) fn triangulate(corners: &[DVec3], triangles: &mut Vec<[u32; 3]>) {
    match corners.len() {
        0..=2 => {}
        3 => triangles.push([0, 1, 2]),
        4 => triangles.extend(quad(corners)),
        count if count > MAX_EARS => triangles.extend((1..count as u32 - 1).map(|i| [0, i, i + 1])),
        _ => clip_ears(corners, triangles),
    }
}

/// Of the two diagonals, the one whose triangles agree most in orientation; the first where both do as well.
fn quad(p: &[DVec3]) -> [[u32; 3]; 2] {
    let normal = newell(p);
    let fold = |[a, b, c]: [usize; 3]| (p[b] - p[a]).cross(p[c] - p[a]).dot(normal);
    let by_first = fold([0, 1, 2]).min(fold([0, 2, 3]));
    let by_second = fold([1, 2, 3]).min(fold([1, 3, 0]));
    if by_first > 0.0 || by_first >= by_second { [[0, 1, 2], [0, 2, 3]] } else { [[1, 2, 3], [1, 3, 0]] }
}

/// Newell's normal, twice the polygon's area vector.
fn newell(p: &[DVec3]) -> DVec3 {
    let centre = p[0];
    (0..p.len()).map(|i| (p[i] - centre).cross(p[(i + 1) % p.len()] - centre)).sum()
}

/// Ear clipping (Meisters 1975) in the plane of Newell's normal.
fn clip_ears(corners: &[DVec3], triangles: &mut Vec<[u32; 3]>) {
    let normal = newell(corners).normalize_or_zero();
    if normal == DVec3::ZERO {
        triangles.extend((1..corners.len() as u32 - 1).map(|i| [0, i, i + 1]));
        return;
    }
    let (u, v) = normal.any_orthonormal_pair();
    let flat: Vec<DVec2> =
        corners.iter().map(|&p| DVec2::new((p - corners[0]).dot(u), (p - corners[0]).dot(v))).collect();
    // (u, v, normal) may be left-handed; the sign of the plane's area says so.
    let area: f64 = (0..flat.len()).map(|i| flat[i].perp_dot(flat[(i + 1) % flat.len()])).sum();
    let sign = if area < 0.0 { -1.0 } else { 1.0 };
    let turn = |a: u32, b: u32, c: u32| {
        let [a, b, c] = [a, b, c].map(|i| flat[i as usize]);
        sign * (b - a).perp_dot(c - a)
    };

    let mut ring: Vec<u32> = (0..corners.len() as u32).collect();
    let mut at = 0;
    let mut misses = 0;
    while ring.len() > 3 {
        let count = ring.len();
        let [a, b, c] = [at % count, (at + 1) % count, (at + 2) % count].map(|i| ring[i]);
        let is_ear = turn(a, b, c) > 0.0
            && ring.iter().all(|&p| {
                p == a
                    || p == b
                    || p == c
                    || [a, b, c].iter().any(|&q| flat[q as usize] == flat[p as usize])
                    || turn(a, b, p) < 0.0
                    || turn(b, c, p) < 0.0
                    || turn(c, a, p) < 0.0
            });
        if is_ear {
            triangles.push([a, b, c]);
            ring.remove((at + 1) % count);
            at = if at >= ring.len() { 0 } else { at };
            misses = 0;
        } else if misses > count {
            // A ring without ear is folded or crosses itself: no triangulation is right, so any will do.
            triangles.extend((1..count - 1).map(|i| [ring[0], ring[i], ring[i + 1]]));
            return;
        } else {
            at = (at + 1) % count;
            misses += 1;
        }
    }
    triangles.push([ring[0], ring[1], ring[2]]);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(corners: &[DVec3]) -> (f64, f64) {
        let mut triangles = Vec::new();
        triangulate(corners, &mut triangles);
        assert_eq!(triangles.len(), corners.len() - 2);
        let twice = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| corners[i as usize]);
            (b - a).cross(c - a).z
        };
        let areas: Vec<f64> = triangles.iter().map(twice).collect();
        (areas.iter().sum(), areas.iter().copied().fold(f64::INFINITY, f64::min))
    }

    fn flat(points: &[[f64; 2]]) -> Vec<DVec3> {
        points.iter().map(|p| DVec3::new(p[0], p[1], 0.0)).collect()
    }

    #[test]
    fn concave_polygons_have_no_folded_triangle() {
        let arrow = flat(&[[0.0, 0.0], [4.0, -3.0], [1.0, 0.0], [4.0, 3.0]]);
        let star: Vec<DVec3> = (0..10)
            .map(|i| {
                let (angle, radius) = (f64::from(i) * std::f64::consts::PI / 5.0, if i % 2 == 0 { 3.0 } else { 1.0 });
                DVec3::new(angle.cos() * radius, angle.sin() * radius, 0.0)
            })
            .collect();
        let comb = flat(&[
            [0.0, 0.0],
            [5.0, 0.0],
            [5.0, 3.0],
            [4.0, 1.0],
            [3.0, 3.0],
            [2.0, 1.0],
            [1.0, 3.0],
            [0.5, 1.0],
            [0.0, 3.0],
        ]);
        for polygon in [arrow, star, comb] {
            let (sum, least) = area(&polygon);
            assert!((sum - newell(&polygon).z).abs() < 1e-12 && least > 0.0, "{sum} {least}");
        }
    }

    #[test]
    fn a_fan_would_fold_the_arrow() {
        let arrow = flat(&[[4.0, -3.0], [1.0, 0.0], [4.0, 3.0], [0.0, 0.0]]);
        let fan = |[a, b, c]: [usize; 3]| (arrow[b] - arrow[a]).cross(arrow[c] - arrow[a]).z;
        assert!(fan([0, 1, 2]).min(fan([0, 2, 3])) < 0.0);
        assert!(area(&arrow).1 > 0.0);
    }
}
