//! Exact answers about points, segments and triangles: no epsilon anywhere.
//!
//! Signs come from Shewchuk's adaptive predicates (*Adaptive Precision Floating-Point Arithmetic and Fast Robust
//! Geometric Predicates*, Discrete & Computational Geometry 18, 1997; crate `robust`); coordinates are f64, so f32
//! states are taken without rounding. The predicates are exact as long as no product leaves the range of f64, which
//! coordinates of f32 cannot: the least unit in a determinant of three is 2⁻⁴⁴⁷, the largest value about 2³⁹⁰.
//! *Touching counts as crossing*: only what two triangles share by topology may coincide.
//!
//! # Rounding
//! Before that, the sign of a determinant in plain double precision is taken where it is beyond doubt: 3 differences,
//! product and difference of the cross product, product and two sums of the dot product are n = 8 roundings of each of
//! its 6 terms, the sum of whose sizes is the permanent P. P is computed with as many roundings, none of which cancels:
//! error ≤ γ₈ P, 8.9e-16 of it, against 1e-14.

use glam::DVec3;
use robust::{Coord, Coord3D, orient2d, orient3d};

use crate::voxel::Dimension;

/// A triangle as positions and as the identities of its corners; equal identities mean the same point.
#[derive(Debug, Clone, Copy)]
pub struct Triangle {
    /// Corner positions.
    pub at: [DVec3; 3],
    /// Corner identities.
    pub id: [u32; 3],
}

fn coord(p: DVec3) -> Coord3D<f64> {
    Coord3D { x: p.x, y: p.y, z: p.z }
}

/// Sign of `det[b − a, c − a, d − a]`: +1 for a positively oriented tetrahedron. Exact.
pub fn orientation(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> i8 {
    orientation_with(ROUNDING, a, b, c, d)
}

/// Bounds the rounding of a determinant of three differences, relative to its permanent.
pub(super) const ROUNDING: f64 = 1.0e-14;

/// As [`orientation`], with a rounding bound for the first look.
#[inline(always)]
pub(super) fn orientation_with(rounding: f64, a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> i8 {
    let (u, v, w) = (b - a, c - a, d - a);
    let det = u.dot(v.cross(w));
    let permanent = u.abs().dot(DVec3::new(
        v.y.abs() * w.z.abs() + v.z.abs() * w.y.abs(),
        v.z.abs() * w.x.abs() + v.x.abs() * w.z.abs(),
        v.x.abs() * w.y.abs() + v.y.abs() * w.x.abs(),
    ));
    let bound = rounding * permanent;
    if det > bound {
        return 1;
    }
    if det < -bound {
        return -1;
    }
    // `robust` looks from the other side.
    sign(-orient3d(coord(a), coord(b), coord(c), coord(d)))
}

/// Whether an element is positively oriented; in the plane its first three corners are meant. Exact.
pub fn is_positive(dimension: Dimension, [a, b, c, d]: [DVec3; 4]) -> bool {
    match dimension {
        Dimension::Two => turn(flat(a, 2), flat(b, 2), flat(c, 2)) > 0,
        Dimension::Three => orientation(a, b, c, d) > 0,
    }
}

/// Whether two segments of the plane z = 0 have a common point outside what they share by identity. Exact.
///
/// A segment is written as a triangle whose third corner is the second once more. Segments that share both ends are the
/// same one twice: they cross. One without length crosses nothing.
pub fn segments_cross(s: &Triangle, t: &Triangle) -> bool {
    let ([a, b], [c, d]) = ([s.at[0], s.at[1]].map(|p| flat(p, 2)), [t.at[0], t.at[1]].map(|p| flat(p, 2)));
    let point = |p: Coord<f64>, q: Coord<f64>| p.x == q.x && p.y == q.y;
    if point(a, b) || point(c, d) {
        return false;
    }
    let (of_s, of_t) = ([s.id[0], s.id[1]], [t.id[0], t.id[1]]);
    match (of_s.iter().position(|id| of_t.contains(id)), of_s.iter().filter(|id| of_t.contains(id)).count()) {
        (None, _) => segments_meet(a, b, c, d),
        (Some(_), 2) => true,
        (Some(i), _) => {
            // From the common point v they meet again only where they run along each other.
            let j = usize::from(of_t[1] == of_s[i]);
            let (v, p, q) = ([a, b][i], [a, b][1 - i], [c, d][1 - j]);
            let ahead = if p.x == v.x { (p.y > v.y) == (q.y > v.y) } else { (p.x > v.x) == (q.x > v.x) };
            turn(v, p, q) == 0 && ahead
        }
    }
}

fn sign(x: f64) -> i8 {
    i8::from(x > 0.0) - i8::from(x < 0.0)
}

/// Whether three points lie on one line. Exact.
pub fn collinear(a: DVec3, b: DVec3, c: DVec3) -> bool {
    (0..3).all(|axis| turn(flat(a, axis), flat(b, axis), flat(c, axis)) == 0)
}

fn flat(p: DVec3, axis: usize) -> Coord<f64> {
    match axis {
        0 => Coord { x: p.y, y: p.z },
        1 => Coord { x: p.z, y: p.x },
        _ => Coord { x: p.x, y: p.y },
    }
}

fn turn(a: Coord<f64>, b: Coord<f64>, c: Coord<f64>) -> i8 {
    sign(orient2d(a, b, c))
}

/// Whether two triangles have a common point outside what they share by identity.
///
/// Triangles that share all three corners are the same face twice: they cross. A triangle without area (three corners
/// on one line) has no inside and crosses nothing.
pub fn triangles_cross(s: &Triangle, t: &Triangle) -> bool {
    let shared = s.id.iter().filter(|i| t.id.contains(i)).count();
    match shared {
        0 => disjoint_cross(s, t),
        1 => vertex_sharing_cross(s, t),
        2 => edge_sharing_cross(s, t),
        _ => !degenerate(s) && !degenerate(t),
    }
}

/// Signs of t's corners seen from the plane of s.
fn sides(s: &[DVec3; 3], t: &[DVec3; 3]) -> [i8; 3] {
    t.map(|p| orientation(s[0], s[1], s[2], p))
}

fn disjoint_cross(s: &Triangle, t: &Triangle) -> bool {
    let of_t = sides(&s.at, &t.at);
    if of_t == [1; 3] || of_t == [-1; 3] {
        return false;
    }
    let of_s = sides(&t.at, &s.at);
    if of_s == [1; 3] || of_s == [-1; 3] {
        return false;
    }
    if degenerate(s) || degenerate(t) {
        return false;
    }
    (0..3).any(|k| {
        segment_meets_triangle(s.at[k], s.at[(k + 1) % 3], &t.at)
            || segment_meets_triangle(t.at[k], t.at[(k + 1) % 3], &s.at)
    })
}

/// One common corner v: beyond it they meet only if one's far edge meets the other.
fn vertex_sharing_cross(s: &Triangle, t: &Triangle) -> bool {
    let Some(i) = (0..3).find(|&i| t.id.contains(&s.id[i])) else { return false };
    let Some(j) = (0..3).find(|&j| t.id[j] == s.id[i]) else { return false };
    let (v, a, b) = (s.at[i], s.at[(i + 1) % 3], s.at[(i + 2) % 3]);
    let (c, d) = (t.at[(j + 1) % 3], t.at[(j + 2) % 3]);
    let (of_c, of_d) = (orientation(v, a, b, c), orientation(v, a, b, d));
    if of_c * of_d > 0 {
        return false;
    }
    let (of_a, of_b) = (orientation(v, c, d, a), orientation(v, c, d, b));
    if of_a * of_b > 0 {
        return false;
    }
    if degenerate(s) || degenerate(t) {
        return false;
    }
    segment_meets_triangle(a, b, &t.at) || segment_meets_triangle(c, d, &s.at)
}

/// One common edge: beyond it they meet only if one is folded flat onto the other.
fn edge_sharing_cross(s: &Triangle, t: &Triangle) -> bool {
    let Some(i) = (0..3).find(|&i| !t.id.contains(&s.id[i])) else { return false };
    let Some(j) = (0..3).find(|&j| !s.id.contains(&t.id[j])) else { return false };
    let (v, w, a, b) = (s.at[(i + 1) % 3], s.at[(i + 2) % 3], s.at[i], t.at[j]);
    if orientation(v, w, a, b) != 0 || degenerate(s) || degenerate(t) {
        return false;
    }
    let axis = widest_projection(&s.at);
    let side = |p| turn(flat(v, axis), flat(w, axis), flat(p, axis));
    side(a) == side(b)
}

fn degenerate(t: &Triangle) -> bool {
    collinear(t.at[0], t.at[1], t.at[2])
}

/// The axis along which a triangle that has area also has area in projection.
fn widest_projection(t: &[DVec3; 3]) -> usize {
    let n = (t[1] - t[0]).cross(t[2] - t[0]).abs();
    let guess = if n.x >= n.y && n.x >= n.z {
        0
    } else if n.y >= n.z {
        1
    } else {
        2
    };
    let has_area = |axis: usize| turn(flat(t[0], axis), flat(t[1], axis), flat(t[2], axis)) != 0;
    [guess, (guess + 1) % 3, (guess + 2) % 3].into_iter().find(|&axis| has_area(axis)).unwrap_or(guess)
}

/// Whether the closed segment pq meets the closed triangle, which has area.
fn segment_meets_triangle(p: DVec3, q: DVec3, t: &[DVec3; 3]) -> bool {
    let (of_p, of_q) = (orientation(t[0], t[1], t[2], p), orientation(t[0], t[1], t[2], q));
    if of_p * of_q > 0 {
        return false;
    }
    if of_p == 0 && of_q == 0 {
        return flat_segment_meets_triangle(p, q, t);
    }
    let around = [orientation(p, q, t[0], t[1]), orientation(p, q, t[1], t[2]), orientation(p, q, t[2], t[0])];
    around.iter().all(|&s| s >= 0) || around.iter().all(|&s| s <= 0)
}

fn flat_segment_meets_triangle(p: DVec3, q: DVec3, t: &[DVec3; 3]) -> bool {
    let axis = widest_projection(t);
    let (p, q, t) = (flat(p, axis), flat(q, axis), t.map(|c| flat(c, axis)));
    (0..3).any(|k| segments_meet(p, q, t[k], t[(k + 1) % 3])) || inside(p, &t)
}

fn inside(p: Coord<f64>, t: &[Coord<f64>; 3]) -> bool {
    let s = [turn(t[0], t[1], p), turn(t[1], t[2], p), turn(t[2], t[0], p)];
    s.iter().all(|&x| x >= 0) || s.iter().all(|&x| x <= 0)
}

/// Whether two closed segments of the plane meet. Exact.
pub(crate) fn segments_meet(a: Coord<f64>, b: Coord<f64>, c: Coord<f64>, d: Coord<f64>) -> bool {
    let (abc, abd, cda, cdb) = (turn(a, b, c), turn(a, b, d), turn(c, d, a), turn(c, d, b));
    if abc * abd < 0 && cda * cdb < 0 {
        return true;
    }
    let between = |a: Coord<f64>, b: Coord<f64>, p: Coord<f64>| {
        p.x >= a.x.min(b.x) && p.x <= a.x.max(b.x) && p.y >= a.y.min(b.y) && p.y <= a.y.max(b.y)
    };
    (abc == 0 && between(a, b, c))
        || (abd == 0 && between(a, b, d))
        || (cda == 0 && between(c, d, a))
        || (cdb == 0 && between(c, d, b))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle(at: [[f64; 3]; 3], id: [u32; 3]) -> Triangle {
        Triangle { at: at.map(DVec3::from), id }
    }

    const FLOOR: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];

    #[test]
    fn orientation_is_positive_for_the_unit_corner() {
        let e = |x, y, z| DVec3::new(x, y, z);
        assert_eq!(orientation(e(0., 0., 0.), e(1., 0., 0.), e(0., 1., 0.), e(0., 0., 1.)), 1);
        assert_eq!(orientation(e(0., 0., 0.), e(0., 1., 0.), e(1., 0., 0.), e(0., 0., 1.)), -1);
        // The slow path agrees with the fast one: nearly flat, one unit in the last place off.
        let up = f64::from_bits(1.0_f64.to_bits() + 1);
        assert_eq!(orientation(e(1., 1., 1.), e(2., 1., 1.), e(1., 2., 1.), e(1.3, 1.3, up)), 1);
        assert_eq!(orientation(e(1., 1., 1.), e(2., 1., 1.), e(1., 2., 1.), e(1.3, 1.3, 1.)), 0);
    }

    #[test]
    fn segments_of_the_plane() {
        let segment = |a: [f64; 2], b: [f64; 2], id: [u32; 2]| {
            triangle([[a[0], a[1], 0.0], [b[0], b[1], 0.0], [b[0], b[1], 0.0]], [id[0], id[1], id[1]])
        };
        let base = segment([0., 0.], [4., 0.], [0, 1]);
        for (other, expected) in [
            (segment([1., -1.], [1., 1.], [2, 3]), true),
            (segment([1., 0.], [1., 1.], [2, 3]), true),
            (segment([1., 1.], [3., 1.], [2, 3]), false),
            (segment([3., 0.], [6., 0.], [2, 3]), true),
            (segment([5., 0.], [6., 0.], [2, 3]), false),
            (segment([0., 0.], [0., 1.], [0, 3]), false),
            (segment([0., 0.], [-1., 0.], [0, 3]), false),
            (segment([0., 0.], [1., 0.], [0, 3]), true),
            (segment([9., 0.], [4., 0.], [3, 1]), false),
            (segment([1., 0.], [4., 0.], [3, 1]), true),
            (segment([4., 0.], [0., 0.], [1, 0]), true),
        ] {
            assert_eq!(segments_cross(&base, &other), expected, "{other:?}");
            assert_eq!(segments_cross(&other, &base), expected, "{other:?}");
        }
    }

    #[test]
    fn disjoint_triangles() {
        let floor = triangle(FLOOR, [0, 1, 2]);
        let piercing = triangle([[1., 1., -1.], [1., 1., 1.], [9., 9., 1.]], [3, 4, 5]);
        let above = triangle([[1., 1., 1.], [1., 2., 1.], [2., 1., 1.5]], [3, 4, 5]);
        let touching = triangle([[1., 1., 0.], [1., 2., 1.], [2., 1., 1.5]], [3, 4, 5]);
        let flat_inside = triangle([[0.5, 0.5, 0.], [1., 0.5, 0.], [0.5, 1., 0.]], [3, 4, 5]);
        let flat_beside = triangle([[5., 5., 0.], [6., 5., 0.], [5., 6., 0.]], [3, 4, 5]);
        for (t, expected) in
            [(piercing, true), (above, false), (touching, true), (flat_inside, true), (flat_beside, false)]
        {
            assert_eq!(triangles_cross(&floor, &t), expected, "{t:?}");
            assert_eq!(triangles_cross(&t, &floor), expected, "{t:?}");
        }
    }

    #[test]
    fn sharing_triangles() {
        let floor = triangle(FLOOR, [0, 1, 2]);
        let hinge_open = triangle([[0., 0., 0.], [4., 0., 0.], [1., -2., 0.]], [0, 1, 3]);
        let hinge_shut = triangle([[0., 0., 0.], [4., 0., 0.], [1., 2., 0.]], [0, 1, 3]);
        let corner_free = triangle([[0., 0., 0.], [-1., 0., 0.], [0., -1., 0.]], [0, 3, 4]);
        let corner_through = triangle([[0., 0., 0.], [1., 1., 1.], [1., 1., -1.]], [0, 3, 4]);
        let corner_flat_over = triangle([[0., 0., 0.], [9., 1., 0.], [1., 1., 0.]], [0, 3, 4]);
        let twin = triangle(FLOOR, [2, 1, 0]);
        for (t, expected) in [
            (hinge_open, false),
            (hinge_shut, true),
            (corner_free, false),
            (corner_through, true),
            (corner_flat_over, true),
            (twin, true),
        ] {
            assert_eq!(triangles_cross(&floor, &t), expected, "{t:?}");
            assert_eq!(triangles_cross(&t, &floor), expected, "{t:?}");
        }
    }
}
