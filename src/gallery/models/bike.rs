//! A city bicycle, seen from its right: the chain is on this side, the front wheel to the right.

use glam::{Vec2, Vec3, Vec3Swizzles as _};

use super::shapes::{Solid, Tube, around, disc, extrude, frame, polygon, stick, torus};
use crate::gallery::implicit::{ball, round_box, round_cone};

const fn v(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

const REAR: Vec3 = v(-0.53, 0.345, 0.0);
const FRONT: Vec3 = v(0.565, 0.345, 0.0);
const CRANK: Vec3 = v(-0.085, 0.300, 0.0);
const SEAT: Vec3 = v(-0.255, 0.760, 0.0);
const HEAD: [Vec3; 2] = [v(0.375, 0.885, 0.0), v(0.415, 0.755, 0.0)];
/// The saddle from above: nose to the right.
const SADDLE: [Vec2; 7] = [
    Vec2::new(-0.430, 0.045),
    Vec2::new(-0.395, 0.072),
    Vec2::new(-0.300, 0.045),
    Vec2::new(-0.160, 0.006),
    Vec2::new(-0.160, -0.006),
    Vec2::new(-0.300, -0.045),
    Vec2::new(-0.395, -0.072),
];

/// The implicit shape.
pub fn solid() -> Solid {
    let mut s = Solid::new(
        v(-0.90, -0.01, -0.42),
        v(0.93, 1.08, 0.42),
        0.018,
        &[
            ("frame", 0.0165),
            ("wheel", 0.0170),
            ("spokes", 0.0145),
            ("handlebar", 0.0145),
            ("brake", 0.0115),
            ("crank", 0.0150),
            ("saddle", 0.0125),
            ("grip", 0.0110),
            ("pedal", 0.0110),
        ],
    );
    wheel(&mut s, REAR, 0.165);
    wheel(&mut s, FRONT, 0.085);
    frame_tubes(&mut s);
    handlebar(&mut s);
    drive(&mut s);
    s.add("saddle", 0.015, |p| {
        // Thin at the rim, and a hollow along the middle.
        let rise = 0.5 * (p.x + 0.27).powi(2) - 1.1 * p.z * p.z;
        extrude(polygon(p.xz(), &SADDLE) - 0.030, p.y - 0.935 - rise, 0.028, 0.024) * 0.95
    });
    s
}

fn wheel(s: &mut Solid, at: Vec3, hub: f32) {
    let axle = frame(at, Vec3::Z, Vec3::Y);
    s.add("wheel", 0.012, move |p| torus(axle.local(p), 0.310, 0.0275));
    s.add("spokes", 0.012, move |p| disc(axle.local(p), 0.036, 0.045, 0.015));
    s.add("frame", 0.008, move |p| stick(p, at - v(0.0, 0.0, hub.min(0.105)), at + v(0.0, 0.0, hub), 0.020));
    s.add("spokes", 0.012, move |p| {
        stick(around(axle.local(p), 10, 0.3), v(0.0, 0.0, 0.02), v(0.0, 0.0, 0.305), 0.0148)
    });
}

fn frame_tubes(s: &mut Solid) {
    let [top, bottom] = HEAD;
    for (a, b, r) in [
        (CRANK, SEAT, 0.0245),
        (CRANK, bottom - v(0.006, -0.03, 0.0), 0.0255),
        (SEAT - v(-0.012, 0.035, 0.0), top - v(0.0, 0.035, 0.0), 0.0235),
        (top, bottom, 0.030),
        (SEAT, v(-0.305, 0.905, 0.0), 0.020),
    ] {
        s.add("frame", 0.018, move |p| stick(p, a, b, r));
    }
    let fork = Tube::new(&[
        (v(0.418, 0.735, 0.078), 0.022),
        (v(0.452, 0.62, 0.080), 0.021),
        (v(0.500, 0.46, 0.084), 0.019),
        (FRONT + v(0.0, 0.0, 0.084), 0.018),
    ]);
    for (from, to, bend) in [(SEAT - v(0.0, 0.02, 0.0), REAR, 0.072), (CRANK, REAR, 0.076)] {
        let tip = to + v(0.0, 0.0, 0.094);
        let root = v(from.x, from.y, bend);
        s.add("frame", 0.012, move |p| stick(v(p.x, p.y, p.z.abs()), root, tip, 0.0165));
        s.add("frame", 0.012, move |p| stick(p, root, v(root.x, root.y, -root.z), 0.020));
    }
    s.add("frame", 0.016, move |p| fork.distance(v(p.x, p.y, p.z.abs())));
    s.add("frame", 0.016, |p| stick(p, v(0.418, 0.738, 0.078), v(0.418, 0.738, -0.078), 0.0225));
    s.add("crank", 0.010, |p| stick(p, CRANK + v(0.0, 0.0, 0.185), CRANK - v(0.0, 0.0, 0.185), 0.027));
}

fn handlebar(s: &mut Solid) {
    let stem = v(0.432, 0.965, 0.0);
    s.add("handlebar", 0.016, move |p| round_cone(p, HEAD[0], v(0.363, 0.930, 0.0), 0.026, 0.024));
    s.add("handlebar", 0.016, move |p| stick(p, v(0.363, 0.930, 0.0), stem, 0.023));
    let bar = Tube::new(&[
        (stem, 0.020),
        (v(0.436, 0.975, 0.09), 0.019),
        (v(0.405, 0.995, 0.19), 0.018),
        (v(0.345, 0.995, 0.275), 0.018),
        (v(0.275, 0.985, 0.345), 0.018),
    ]);
    s.add("handlebar", 0.012, move |p| bar.distance(v(p.x, p.y, p.z.abs())));
    let grip = Tube::new(&[
        (v(0.362, 0.996, 0.256), 0.0285),
        (v(0.3181, 0.992, 0.303), 0.0265),
        (v(0.262, 0.983, 0.357), 0.0285),
    ]);
    s.add("grip", 0.008, move |p| grip.distance(v(p.x, p.y, p.z.abs())));
    let lever = Tube::new(&[
        (v(0.400, 0.990, 0.200), 0.017),
        (v(0.448, 0.975, 0.240), 0.0155),
        (v(0.412, 0.962, 0.315), 0.0150),
        (v(0.362, 0.955, 0.372), 0.0160),
    ]);
    s.add("brake", 0.010, move |p| lever.distance(v(p.x, p.y, p.z.abs())));
}

fn drive(s: &mut Solid) {
    let side = v(0.0, 0.0, 0.138);
    let (ring, cog) = (frame(CRANK + side, Vec3::Z, Vec3::Y), frame(REAR + side, Vec3::Z, Vec3::Y));
    s.add("crank", 0.008, move |p| disc(ring.local(p), 0.098, 0.0155, 0.010));
    s.add("crank", 0.008, move |p| disc(cog.local(p), 0.050, 0.0155, 0.010));
    for (up, ratio) in [(0.083, 0.035), (-0.083, -0.035)] {
        s.add("crank", 0.006, move |p| {
            stick(p, CRANK + side + v(0.0, up, 0.0), REAR + side + v(0.0, ratio, 0.0), 0.0150)
        });
    }
    // Right crank forward, left crank back.
    for turn in [1.0_f32, -1.0] {
        let (root, tip) = (CRANK + v(0.0, 0.0, 0.185 * turn), CRANK + v(0.165 * turn, -0.035 * turn, 0.192 * turn));
        s.add("crank", 0.012, move |p| round_cone(p, root, tip, 0.024, 0.020));
        let pedal = tip + v(0.0, 0.0, 0.085 * turn);
        s.add("crank", 0.008, move |p| stick(p, tip, pedal, 0.0165));
        s.add("pedal", 0.010, move |p| round_box(p - pedal, v(0.055, 0.020, 0.042), 0.014));
        s.add("pedal", 0.006, move |p| ball(p, pedal + v(0.0, 0.0, 0.040 * turn), 0.018));
    }
}
