//! A walking robot, arms half bent: a joint at each bend.

use glam::Vec3;

use super::shapes::{Solid, Tube, disc, frame, stick};
use crate::gallery::implicit::{Loft, Station, ball, ellipsoid, ramp, round_box, round_cone};

const fn v(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

const SHOULDER: Vec3 = v(0.345, 1.275, 0.0);
const ELBOW: Vec3 = v(0.405, 0.995, -0.02);
const WRIST: Vec3 = v(0.385, 0.800, 0.165);
const HIP: Vec3 = v(0.128, 0.690, 0.0);
const KNEE: Vec3 = v(0.132, 0.405, 0.025);
const ANKLE: Vec3 = v(0.140, 0.135, -0.015);

/// The implicit shape.
pub fn solid() -> Solid {
    let mut s = Solid::new(
        v(-0.56, -0.02, -0.28),
        v(0.56, 1.98, 0.42),
        0.035,
        &[
            ("body", 0.021),
            ("head", 0.018),
            ("limb", 0.018),
            ("hand", 0.014),
            ("foot", 0.019),
            ("waist", 0.016),
            ("neck", 0.016),
            ("shoulder", 0.0145),
            ("elbow", 0.0135),
            ("wrist", 0.0125),
            ("hip", 0.0145),
            ("knee", 0.0140),
            ("ankle", 0.0135),
        ],
    );
    trunk(&mut s);
    head(&mut s);
    limbs(&mut s);
    s
}

fn trunk(s: &mut Solid) {
    let chest = Loft::new(
        &[
            Station::sym(0.965, 0.150, 0.095, -0.100, 3.4),
            Station::sym(1.06, 0.195, 0.130, -0.125, 3.6),
            Station::sym(1.20, 0.245, 0.155, -0.145, 3.8),
            Station::sym(1.315, 0.250, 0.140, -0.140, 3.8),
        ],
        [0.045, 0.055],
    );
    s.add("body", 0.0, move |p| chest.distance(p));
    // A ring and a core on the chest.
    let plate = frame(v(0.0, 1.205, 0.150), v(0.0, 0.06, 1.0), Vec3::Y);
    s.cut(0.010, move |p| super::shapes::torus(plate.local(p), 0.078, 0.016));
    s.add("body", 0.02, |p| round_box(p - v(0.0, 0.775, 0.0), v(0.165, 0.052, 0.105), 0.045));
    s.add("waist", 0.016, |p| ball(p, v(0.0, 0.875, 0.0), 0.092));
    s.add("waist", 0.010, |p| disc(p - v(0.0, 0.875, 0.0), 0.110, 0.022, 0.016));
}

fn head(s: &mut Solid) {
    s.add("neck", 0.016, |p| disc(p - v(0.0, 1.405, 0.0), 0.058, 0.06, 0.018));
    s.add("neck", 0.010, |p| disc(p - v(0.0, 1.408, 0.0), 0.076, 0.018, 0.014));
    s.add("head", 0.016, |p| round_box(p - v(0.0, 1.585, 0.010), v(0.185, 0.135, 0.150), 0.085));
    // The visor, with two eyes in it.
    s.cut(0.016, |p| round_box(p - v(0.0, 1.595, 0.165), v(0.140, 0.064, 0.042), 0.040));
    s.pair("head", 0.008, |p| ellipsoid(p, v(0.062, 1.595, 0.128), v(0.040, 0.040, 0.030)));
    for side in [-1.0, 1.0] {
        let ear = frame(v(side * 0.188, 1.585, 0.005), Vec3::X, Vec3::Y);
        s.add("head", 0.012, move |p| disc(ear.local(p), 0.060, 0.030, 0.018));
    }
    s.add("head", 0.014, |p| stick(p, v(0.0, 1.70, 0.0), v(0.0, 1.84, 0.0), 0.020));
    s.add("head", 0.012, |p| ball(p, v(0.0, 1.865, 0.0), 0.040));
}

fn limbs(s: &mut Solid) {
    s.pair("shoulder", 0.016, |p| round_cone(p, v(0.20, 1.275, 0.0), SHOULDER, 0.052, 0.050));
    for (a, b, ra, rb) in [
        (SHOULDER, ELBOW, 0.050, 0.046),
        (ELBOW, WRIST, 0.050, 0.040),
        (HIP, KNEE, 0.062, 0.052),
        (KNEE, ANKLE, 0.058, 0.042),
    ] {
        s.pair("limb", 0.014, move |p| round_cone(p, a, b, ra, rb));
    }
    for (name, at, r) in [
        ("shoulder", SHOULDER, 0.092),
        ("elbow", ELBOW, 0.071),
        ("wrist", WRIST, 0.053),
        ("hip", HIP, 0.088),
        ("knee", KNEE, 0.080),
        ("ankle", ANKLE, 0.062),
    ] {
        s.pair(name, 0.012, move |p| ball(p, at, r));
        // All of the ball belongs to the joint, what runs through it too.
        s.paint(name, move |p| ramp(-ball(Vec3::new(p.x.abs(), p.y, p.z), at, 1.10 * r), -0.028, 0.0));
        // The axle's cap, outside.
        let cap = frame(at + v(0.72 * r, 0.0, 0.0), Vec3::X, Vec3::Y);
        s.pair(name, 0.008, move |p| disc(cap.local(p), 0.62 * r, 0.36 * r, 0.20 * r));
    }
    let along = (WRIST - ELBOW).normalize();
    let palm = WRIST + along * 0.085;
    s.pair("hand", 0.016, move |p| round_cone(p, WRIST, palm, 0.038, 0.050));
    // A gripper of two bent fingers.
    let hand = frame(palm, along, v(1.0, 0.3, 0.0));
    for side in [-1.0_f32, 1.0] {
        let finger = Tube::new(&[
            (v(0.0, 0.005, side * 0.028), 0.026),
            (v(0.0, 0.050, side * 0.078), 0.024),
            (v(0.0, 0.110, side * 0.082), 0.022),
            (v(0.0, 0.155, side * 0.045), 0.018),
        ]);
        s.pair("hand", 0.012, move |p| finger.distance(hand.local(p)));
    }
    s.pair("foot", 0.016, |p| round_box(p - v(0.145, 0.045, 0.045), v(0.088, 0.045, 0.165), 0.040));
    s.pair("foot", 0.030, |p| round_cone(p, ANKLE - v(0.0, 0.03, 0.0), v(0.145, 0.06, 0.06), 0.055, 0.055));
    s.cut(0.012, |p| p.y);
}
