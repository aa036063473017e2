//! A comic character of our own: all eyes, hands and feet to come.

use glam::Vec3;

use super::shapes::{Solid, Tube, frame, stick};
use crate::gallery::implicit::{ball, ellipsoid, round_cone, union};

const fn v(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

const HEAD: Vec3 = v(0.0, 1.14, 0.0);

/// The implicit shape.
pub fn solid() -> Solid {
    let mut s = Solid::new(
        v(-0.90, -0.02, -0.46),
        v(0.90, 1.95, 0.66),
        0.04,
        &[
            ("body", 0.022),
            ("head", 0.022),
            ("hair", 0.018),
            ("nose", 0.015),
            ("eye", 0.0135),
            ("arm", 0.018),
            ("hand", 0.0125),
            ("leg", 0.018),
            ("foot", 0.017),
        ],
    );
    s.add("body", 0.0, |p| ellipsoid(p, v(0.0, 0.60, 0.0), v(0.225, 0.245, 0.185)));
    // Collar and two buttons.
    s.add("body", 0.03, |p| super::shapes::torus(p - v(0.0, 0.785, 0.0), 0.135, 0.040));
    for y in [0.66, 0.54] {
        s.add("body", 0.010, move |p| ellipsoid(p, v(0.0, y, 0.188), v(0.030, 0.030, 0.022)));
    }
    head(&mut s);
    arms(&mut s);
    legs(&mut s);
    s
}

fn head(s: &mut Solid) {
    s.add("head", 0.05, |p| ellipsoid(p, HEAD, v(0.43, 0.375, 0.36)));
    s.add("head", 0.14, |p| ellipsoid(p, HEAD + v(0.0, -0.13, 0.04), v(0.37, 0.24, 0.32)));
    s.pair("head", 0.04, |p| ellipsoid(p, HEAD + v(0.455, -0.03, -0.02), v(0.085, 0.115, 0.06)));
    // A smile: a groove that ends in dimples.
    let smile = Tube::new(&[
        (v(-0.210, 0.985, 0.298), 0.026),
        (v(-0.125, 0.905, 0.3181), 0.032),
        (v(0.0, 0.872, 0.322), 0.036),
        (v(0.125, 0.905, 0.3181), 0.032),
        (v(0.210, 0.985, 0.298), 0.026),
    ]);
    s.cut(0.022, move |p| smile.distance(p));
    s.add("nose", 0.03, |p| ellipsoid(p, v(0.0, 1.085, 0.425), v(0.080, 0.068, 0.080)));
    s.pair("eye", 0.012, |p| ellipsoid(p, v(0.142, 1.275, 0.285), v(0.112, 0.145, 0.105)));
    s.pair("eye", 0.008, |p| ellipsoid(p, v(0.122, 1.268, 0.378), v(0.042, 0.056, 0.030)));
    s.pair("head", 0.02, |p| {
        let brow = round_cone(p, v(0.09, 1.475, 0.255), v(0.16, 1.500, 0.225), 0.026, 0.028);
        union(brow, round_cone(p, v(0.16, 1.500, 0.225), v(0.235, 1.470, 0.180), 0.028, 0.022), 0.02)
    });
    for (bend, lean) in [(-0.20, 0.02), (0.0, 0.10), (0.20, 0.02)] {
        let strand = Tube::new(&[
            (v(0.25 * bend, 1.46, -0.02), 0.060),
            (v(0.62 * bend, 1.62, -0.03), 0.052),
            (v(1.15 * bend, 1.74 + lean, 0.02), 0.042),
            (v(1.90 * bend, 1.77 + 1.2 * lean, 0.12), 0.022),
        ]);
        s.add("hair", 0.035, move |p| strand.distance(p));
    }
}

fn arms(s: &mut Solid) {
    let wrist = v(0.545, 0.665, 0.13);
    let arm = Tube::new(&[
        (v(0.185, 0.72, 0.0), 0.050),
        (v(0.33, 0.66, 0.01), 0.042),
        (v(0.44, 0.595, 0.06), 0.040),
        (wrist, 0.044),
    ]);
    s.pair("arm", 0.03, move |p| arm.distance(p));
    // A glove: cuff, palm, three fingers and a thumb.
    let glove = frame(wrist, v(0.50, 0.86, 0.10), v(0.15, 0.0, 1.0));
    s.pair("hand", 0.016, move |p| super::shapes::torus(glove.local(p) - v(0.0, 0.012, 0.0), 0.044, 0.026));
    s.pair("hand", 0.018, move |p| ellipsoid(glove.local(p), v(0.0, 0.095, 0.0), v(0.078, 0.085, 0.052)));
    for (x, turn, length) in [(-0.046, -24.0_f32, 0.115), (0.0, 0.0, 0.130), (0.046, 24.0, 0.110)] {
        let (sin, cos) = turn.to_radians().sin_cos();
        let (a, b) = (v(x, 0.125, 0.0), v(x + length * sin, 0.125 + length * cos, 0.012));
        s.pair("hand", 0.016, move |p| round_cone(glove.local(p), a, b, 0.033, 0.031));
    }
    s.pair("hand", 0.018, move |p| {
        round_cone(glove.local(p), v(-0.050, 0.065, 0.018), v(-0.138, 0.118, 0.050), 0.034, 0.029)
    });
}

fn legs(s: &mut Solid) {
    s.pair("leg", 0.03, |p| stick(p, v(0.115, 0.44, 0.0), v(0.150, 0.14, 0.0), 0.052));
    s.pair("foot", 0.03, |p| ellipsoid(p, v(0.158, 0.090, -0.01), v(0.092, 0.092, 0.105)));
    s.pair("foot", 0.07, |p| ellipsoid(p, v(0.180, 0.092, 0.135), v(0.120, 0.105, 0.145)));
    s.pair("foot", 0.012, |p| ball(p, v(0.182, 0.190, 0.120), 0.030));
    s.cut(0.02, |p| p.y - 0.002);
}
