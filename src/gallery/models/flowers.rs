//! A bunch of lilies in a vase, anthers wide open.

use glam::Vec3;

use super::shapes::{Solid, Tube, around, extrude, frame, stick};
use crate::gallery::implicit::{Frame, Loft, Station, ellipsoid, round_cone};

const fn v(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

/// Where each flower sits, where it looks, and how it is turned about its axis (radians).
const FLOWERS: [(Vec3, Vec3, f32); 4] = [
    (v(-0.36, 1.12, 0.06), v(-0.62, 0.52, 0.58), 0.2),
    (v(0.02, 1.36, -0.04), v(0.05, 0.80, 0.60), 0.8),
    (v(0.40, 1.08, 0.02), v(0.70, 0.42, 0.58), 0.5),
    (v(0.02, 0.90, 0.24), v(-0.02, 0.22, 0.97), 0.0),
];
/// Where the stems leave the vase.
const MOUTH: Vec3 = v(0.0, 0.50, 0.0);
/// Petals and stamens of a flower.
const COUNT: u32 = 6;

/// The implicit shape.
pub fn solid() -> Solid {
    let mut s = Solid::new(
        v(-0.86, -0.02, -0.42),
        v(0.88, 1.78, 0.66),
        0.03,
        &[
            ("vase", 0.026),
            ("stem", 0.018),
            ("leaf", 0.018),
            ("petal", 0.0165),
            ("filament", 0.013),
            ("anther", 0.0105),
        ],
    );
    vase(&mut s);
    for (k, (at, towards, turn)) in FLOWERS.into_iter().enumerate() {
        let bend = MOUTH.lerp(at, 0.45) + v(-0.15 * at.x, 0.10, 0.0);
        let root = MOUTH + v(0.16 * at.x, -0.04, 0.20 * at.z);
        let neck = at - towards.normalize() * 0.10;
        let stem = Tube::new(&[(root, 0.024), (bend, 0.022), (neck, 0.023), (at, 0.030)]);
        s.add("stem", 0.03, move |p| stem.distance(p));
        flower(&mut s, frame(at, towards, if k == 3 { Vec3::Y } else { Vec3::Z }), turn);
    }
    for (root, tip, towards) in [
        (v(-0.06, 0.52, 0.03), v(-0.50, 0.70, 0.12), v(0.0, 0.6, 1.0)),
        (v(0.07, 0.52, 0.02), v(0.52, 0.66, 0.14), v(0.0, 0.6, 1.0)),
        (v(0.02, 0.52, -0.06), v(0.14, 0.92, -0.34), v(0.0, 0.4, -1.0)),
    ] {
        leaf(&mut s, frame(root, tip - root, towards), root.distance(tip));
    }
    s
}

fn vase(s: &mut Solid) {
    let ring = |y: f32, r: f32| Station::sym(y, r, r, -r, 2.0);
    let outer = Loft::new(
        &[
            ring(0.03, 0.125),
            ring(0.10, 0.170),
            ring(0.22, 0.200),
            ring(0.34, 0.165),
            ring(0.44, 0.118),
            ring(0.51, 0.135),
        ],
        [0.03, 0.03],
    );
    s.add("vase", 0.0, move |p| outer.distance(p));
    s.add("vase", 0.014, |p| super::shapes::torus(p - v(0.0, 0.522, 0.0), 0.128, 0.024));
}

fn flower(s: &mut Solid, f: Frame, turn: f32) {
    s.add("petal", 0.03, move |p| ellipsoid(f.local(p), v(0.0, 0.030, 0.0), v(0.062, 0.075, 0.062)));
    s.add("petal", 0.016, move |p| {
        let q = around(f.local(p), COUNT, turn);
        // Outline from above, as a radius over the angle: petals that part gently, joined to a cup below.
        let (angle, radius) = (q.x.atan2(q.z), q.x.hypot(q.z).max(0.02));
        let wave = COUNT as f32 * angle;
        let lobe = (0.5 + 0.5 * wave.cos()).max(1e-3);
        let reach = 0.112 + 0.190 * lobe.powf(1.15);
        let slope = -0.190 * 1.15 * lobe.powf(0.15) * 0.5 * wave.sin() * COUNT as f32 / radius;
        let outline = (radius - reach) / (1.0 + slope * slope).sqrt();
        let side = q.x;
        // Cupped, and rolled back at the tip.
        let rise = 1.05 * radius - 2.6 * radius * radius + 1.4 * side * side;
        extrude(outline, q.y - rise, 0.0175, 0.0165) * 0.85
    });
    let tip = v(0.0, 0.195, 0.098);
    let phase = turn + 0.5 * std::f32::consts::TAU / COUNT as f32;
    let filament = Tube::new(&[(v(0.0, 0.03, 0.024), 0.0150), (v(0.0, 0.12, 0.064), 0.0145), (tip, 0.0140)]);
    s.add("filament", 0.012, move |p| filament.distance(around(f.local(p), COUNT, phase)));
    let anther = frame(tip + v(0.0, 0.006, 0.002), v(0.0, 1.0, 0.55), Vec3::Z);
    s.add("anther", 0.008, move |p| {
        let q = anther.local(around(f.local(p), COUNT, phase));
        ellipsoid(q, Vec3::ZERO, v(0.0235, 0.042, 0.0225))
    });
    s.add("filament", 0.010, move |p| round_cone(f.local(p), v(0.0, 0.04, 0.0), v(0.0, 0.150, 0.0), 0.0160, 0.0150));
}

/// A long leaf along the frame's y, its blade across x.
fn leaf(s: &mut Solid, f: Frame, length: f32) {
    s.add("leaf", 0.02, move |p| {
        let q = f.local(p);
        let t = (q.y / length).clamp(0.0, 1.0);
        let outline = ellipsoid(v(q.x, q.y - 0.5 * length, 0.0), Vec3::ZERO, v(0.066, 0.5 * length, 1.0));
        // Arched, with a keel.
        let arch = 0.30 * length * t * (1.0 - t) + 0.9 * q.x * q.x;
        extrude(outline, q.z - arch, 0.0185, 0.017) * 0.85
    });
    s.add("leaf", 0.02, move |p| stick(p, f.origin, f.world(v(0.0, 0.08, 0.02)), 0.022));
}
