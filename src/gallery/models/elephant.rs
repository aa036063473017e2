//! An African elephant, tusks to both sides of its trunk.

use glam::{Vec2, Vec3};

use super::shapes::{Solid, Tube, extrude, frame, polygon};
use crate::gallery::implicit::{ball, chain, ellipsoid, round_cone};

const fn v(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

/// The ear's outline: outwards from the head and up, metres.
const EAR: [Vec2; 11] = [
    Vec2::new(-0.04, 0.10),
    Vec2::new(0.05, 0.22),
    Vec2::new(0.20, 0.28),
    Vec2::new(0.36, 0.24),
    Vec2::new(0.44, 0.10),
    Vec2::new(0.43, -0.08),
    Vec2::new(0.34, -0.26),
    Vec2::new(0.24, -0.40),
    Vec2::new(0.17, -0.40),
    Vec2::new(0.11, -0.24),
    Vec2::new(-0.02, -0.12),
];

/// The implicit shape.
pub fn solid() -> Solid {
    let mut s = Solid::new(
        v(-0.80, -0.02, -1.10),
        v(0.80, 1.66, 1.52),
        0.06,
        &[
            ("body", 0.034),
            ("head", 0.026),
            ("ear", 0.024),
            ("trunk", 0.019),
            ("tusk", 0.0125),
            ("leg", 0.030),
            ("foot", 0.022),
            ("tail", 0.020),
        ],
    );
    s.add("body", 0.0, |p| ellipsoid(p, v(0.0, 0.97, -0.12), v(0.36, 0.395, 0.60)));
    s.add("body", 0.20, |p| ellipsoid(p, v(0.0, 1.06, 0.24), v(0.285, 0.335, 0.30)));
    s.add("body", 0.20, |p| ellipsoid(p, v(0.0, 0.99, -0.48), v(0.31, 0.345, 0.33)));
    s.add("head", 0.16, |p| round_cone(p, v(0.0, 1.10, 0.40), v(0.0, 1.20, 0.66), 0.25, 0.215));
    s.add("head", 0.12, |p| ellipsoid(p, v(0.0, 1.36, 0.64), v(0.185, 0.15, 0.185)));
    s.add("head", 0.10, |p| ellipsoid(p, v(0.0, 1.00, 0.70), v(0.115, 0.13, 0.17)));
    s.pair("head", 0.05, |p| ellipsoid(p, v(0.130, 1.10, 0.80), v(0.070, 0.115, 0.085)));
    s.pair("head", 0.012, |p| ball(p, v(0.188, 1.215, 0.755), 0.030));
    s.pair("head", 0.03, |p| round_cone(p, v(0.175, 1.258, 0.74), v(0.165, 1.245, 0.80), 0.022, 0.018));
    legs(&mut s);
    ears(&mut s);
    let trunk = Tube::new(&[
        (v(0.0, 1.22, 0.74), 0.150),
        (v(0.0, 1.05, 0.90), 0.128),
        (v(0.0, 0.82, 0.985), 0.104),
        (v(0.0, 0.58, 1.005), 0.088),
        (v(0.0, 0.36, 1.03), 0.076),
        (v(0.0, 0.205, 1.12), 0.068),
        (v(0.0, 0.19, 1.265), 0.061),
        (v(0.0, 0.30, 1.375), 0.055),
        (v(0.0, 0.43, 1.400), 0.050),
    ]);
    s.add("trunk", 0.07, move |p| {
        // Rings of the skin, fading towards the tip.
        let t = trunk.along(p);
        trunk.distance(p) + 0.0042 * (1.0 - 0.5 * t) * (t * 150.0).cos()
    });
    let tusk = Tube::new(&[
        (v(0.128, 1.04, 0.80), 0.050),
        (v(0.185, 0.87, 0.93), 0.047),
        (v(0.222, 0.74, 1.06), 0.043),
        (v(0.212, 0.675, 1.20), 0.036),
        (v(0.150, 0.680, 1.32), 0.027),
        (v(0.082, 0.735, 1.39), 0.017),
    ]);
    s.pair("tusk", 0.022, move |p| tusk.distance(p));
    let tail = Tube::new(&[
        (v(0.0, 1.13, -0.76), 0.055),
        (v(0.0, 1.00, -0.89), 0.040),
        (v(0.0, 0.76, -0.95), 0.032),
        (v(0.0, 0.56, -0.97), 0.028),
    ]);
    s.add("tail", 0.05, move |p| tail.distance(p));
    s.add("tail", 0.02, |p| ellipsoid(p, v(0.0, 0.47, -0.98), v(0.042, 0.105, 0.045)));
    // Soles.
    s.cut(0.03, |p| p.y);
    s
}

fn legs(s: &mut Solid) {
    for (knots, foot) in [
        (
            [(v(0.165, 0.86, 0.24), 0.185), (v(0.190, 0.48, 0.275), 0.130), (v(0.195, 0.16, 0.27), 0.118)],
            v(0.195, 0.05, 0.28),
        ),
        (
            [(v(0.150, 0.84, -0.44), 0.215), (v(0.185, 0.46, -0.50), 0.135), (v(0.190, 0.16, -0.47), 0.118)],
            v(0.190, 0.05, -0.46),
        ),
    ] {
        s.pair("leg", 0.07, move |p| chain(p, &knots, 0.10));
        s.pair("foot", 0.05, move |p| ellipsoid(p, foot, v(0.138, 0.105, 0.145)));
        for turn in [-48.0_f32, -16.0, 16.0, 48.0] {
            let (sin, cos) = turn.to_radians().sin_cos();
            s.pair("foot", 0.008, move |p| {
                ellipsoid(p, foot + v(0.128 * sin, 0.0, 0.136 * cos), v(0.030, 0.036, 0.022))
            });
        }
    }
}

fn ears(s: &mut Solid) {
    // Set on behind the cheek, turned back by a third of a right angle and bowl-shaped.
    let set = frame(v(0.185, 1.235, 0.54), Vec3::Y, v(0.52, 0.0, 0.85));
    s.pair("ear", 0.05, move |p| {
        let q = set.local(p);
        let (out, up) = (q.x, q.y);
        let bowl = 0.42 * (out - 0.05) * (out - 0.05) + 0.10 * up * up;
        extrude(polygon(Vec2::new(out, up), &EAR) - 0.045, q.z + 0.02 - bowl, 0.031, 0.028) * 0.9
    });
}
