//! Brows, eyes, nose, mouth and ears on the bare head. Millimetres in the head's space; `q` is mirrored to x ≥ 0.

use glam::Vec3;

use crate::gallery::implicit::{ball, bump, chain, common, cut, ellipsoid, round_cone, union};

/// Centre and radius of the eyeball.
pub const EYE: (Vec3, f32) = (Vec3::new(32.0, 0.0, 79.5), 12.6);

/// The head `f` with its features.
pub fn features(p: Vec3, q: Vec3, f: f32) -> f32 {
    let mut f = brows_and_sockets(q, f);
    f = nose(q, f);
    f = mouth(p, q, f);
    f = eyes(q, f);
    ears(q, f)
}

fn brows_and_sockets(q: Vec3, f: f32) -> f32 {
    let v = Vec3::new;
    let brow = chain(q, &[(v(6.0, 15.0, 94.0), 7.0), (v(28.0, 19.0, 90.5), 7.0), (v(48.0, 15.0, 76.0), 7.0), (v(57.0, 2.0, 62.0), 7.0)], 14.0);
    let f = union(f, brow, 18.0);
    let socket = ellipsoid(q, v(32.0, 0.0, 103.0), v(19.0, 12.0, 16.0));
    cut(f, socket, 16.0)
}

fn nose(q: Vec3, f: f32) -> f32 {
    let v = Vec3::new;
    let bridge = chain(q, &[(v(0.0, 6.0, 94.0), 7.5), (v(0.0, -18.0, 107.0), 7.0), (v(0.0, -36.0, 116.0), 8.5)], 10.0);
    let side = round_cone(q, v(4.0, -4.0, 90.0), v(8.0, -36.0, 99.0), 8.0, 9.5);
    let tip = ellipsoid(q, v(0.0, -39.0, 116.5), v(9.5, 8.0, 9.0));
    let wing = ellipsoid(q, v(11.5, -42.5, 105.0), v(6.0, 6.5, 9.0));
    let base = round_cone(q, v(0.0, -44.0, 114.0), v(0.0, -50.0, 98.0), 4.5, 6.0);
    let mut nose = union(bridge, side, 16.0);
    nose = union(nose, tip, 10.0);
    nose = union(nose, wing, 7.0);
    nose = union(nose, base, 5.0);
    let f = union(f, nose, 12.0);
    let nostril = chain(q, &[(v(7.0, -51.5, 111.0), 3.0), (v(7.5, -44.0, 106.0), 2.6)], 2.0);
    cut(f, nostril, 2.0)
}

fn mouth(p: Vec3, q: Vec3, f: f32) -> f32 {
    let v = Vec3::new;
    // The teeth push the muzzle out; the lips are two rolls on it that meet in a line.
    let muzzle = ellipsoid(q, v(0.0, -70.0, 78.0), v(34.0, 25.0, 27.0));
    let mut f = union(f, muzzle, 16.0);
    f += 1.6 * bump(p.x, 5.0) * bump(p.y + 58.0, 9.0) * bump(p.z - 105.0, 14.0);
    f += 2.2 * bump(q.distance(v(0.0, -86.0, 104.0)), 16.0);
    f = union(f, lips(q), 3.5);
    let line = chain(q, &[(v(0.0, -71.9, 109.8), 1.0), (v(7.0, -71.2, 109.0), 1.0), (v(16.0, -71.9, 103.0), 0.9), (v(25.5, -72.6, 94.5), 1.1)], 2.0);
    cut(f, line, 2.2)
}

/// Near-distance to the two lips, millimetres.
pub fn lips(q: Vec3) -> f32 {
    let v = Vec3::new;
    let corner = v(24.5, -72.0, 93.0);
    let upper = chain(q, &[(v(0.0, -67.6, 105.0), 4.0), (v(6.5, -66.6, 104.6), 4.2), (v(15.0, -69.2, 100.5), 3.4), (corner, 1.6)], 4.0);
    let lower = chain(q, &[(v(0.0, -76.8, 103.6), 5.2), (v(9.0, -76.4, 102.4), 4.8), (v(17.0, -74.4, 98.6), 3.2), (corner, 1.6)], 4.0);
    upper.min(lower)
}

fn eyes(q: Vec3, f: f32) -> f32 {
    let (centre, radius) = EYE;
    let d = q - centre;
    let lids = ball(q, centre, radius + 2.2);
    let f = union(f, lids, 9.0);
    // The opening: an almond between two arcs, inner corner a little lower.
    let (x, y) = (d.x, d.y - 0.06 * d.x);
    let upper = 5.6 - 0.0245 * x * x - y;
    let lower = y + 4.4 - 0.0195 * x * x;
    let almond = common(-upper, -lower, 1.0);
    let front = common(almond, -(d.z - 4.0), 1.0);
    let f = cut(f, front, 1.2);
    let iris = 0.6 * bump(d.truncate().length(), 3.0) * f32::from(d.z > 0.0);
    union(f, ball(q, centre, radius) + iris, 0.8)
}

fn ears(q: Vec3, f: f32) -> f32 {
    if q.x < 45.0 { f } else { union(f, ear(q), 4.0) }
}

/// Near-distance to the ear, millimetres.
pub fn ear(q: Vec3) -> f32 {
    let v = Vec3::new;
    // The ear's own plane: u to the back along the plate, w outward from it; it stands off by some 25 degrees.
    let (sin, cos) = 25.0_f32.to_radians().sin_cos();
    let d = q - v(70.0, -20.0, -2.0);
    let e = v(-d.z * cos + d.x * sin, d.y - 0.12 * d.z, d.x * cos + d.z * sin);
    let plate = ellipsoid(e, v(11.0, 1.0, 1.0), v(17.0, 29.0, 3.0));
    let rim = [
        (v(4.0, 2.0, 3.0), 2.0),
        (v(1.0, 14.0, 4.5), 2.4),
        (v(5.0, 25.0, 5.0), 2.7),
        (v(14.0, 30.0, 5.0), 2.8),
        (v(24.0, 25.0, 5.0), 2.8),
        (v(28.0, 13.0, 5.0), 2.7),
        (v(26.0, -1.0, 4.5), 2.5),
        (v(20.0, -14.0, 3.5), 2.5),
        (v(12.0, -24.0, 2.5), 3.6),
        (v(5.0, -25.0, 1.5), 3.4),
    ];
    let helix = chain(e, &rim, 2.0);
    let fold = chain(e, &[(v(15.0, 19.0, 3.0), 2.0), (v(19.0, 8.0, 3.5), 2.2), (v(17.0, -6.0, 3.5), 2.2), (v(9.0, -14.0, 3.5), 2.2)], 2.0);
    let tragus = ellipsoid(e, v(0.5, -5.0, 4.0), v(3.0, 5.0, 3.0));
    let mut ear = union(plate, helix, 3.5);
    ear = union(ear, fold, 3.0);
    ear = cut(ear, ellipsoid(e, v(8.5, -2.0, 6.0), v(6.0, 8.5, 5.5)), 3.0);
    union(ear, tragus, 2.5)
}
