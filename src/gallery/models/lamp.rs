//! A balanced-arm desk lamp with a bulb in its shade.

use glam::Vec3;

use super::shapes::{Solid, disc, frame, stick};
use crate::gallery::implicit::{Frame, Loft, Station, ball, round_cone, union};

const fn v(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

const FOOT: Vec3 = v(-0.06, 0.13, 0.0);
const ELBOW: Vec3 = v(-0.55, 0.86, 0.0);
const HEAD: Vec3 = v(0.16, 1.44, 0.0);

/// The implicit shape.
pub fn solid() -> Solid {
    let mut s = Solid::new(
        v(-0.72, -0.02, -0.46),
        v(0.86, 1.66, 0.46),
        0.05,
        &[("base", 0.026), ("arm", 0.018), ("joint", 0.017), ("shade", 0.018), ("socket", 0.015), ("bulb", 0.0125)],
    );
    s.add("base", 0.0, |p| disc(p - v(-0.06, 0.035, 0.0), 0.36, 0.035, 0.026));
    s.add("base", 0.05, |p| disc(p - v(-0.06, 0.075, 0.0), 0.12, 0.03, 0.022));
    arm(&mut s, FOOT, ELBOW);
    arm(&mut s, ELBOW, HEAD);
    for (at, radius) in [(FOOT, 0.070), (ELBOW, 0.078), (HEAD, 0.066)] {
        let hub = frame(at, Vec3::Z, Vec3::Y);
        s.add("joint", 0.010, move |p| disc(hub.local(p), radius, 0.082, 0.018));
        s.add("joint", 0.006, move |p| disc(hub.local(p), 0.5 * radius, 0.100, 0.014));
    }
    shade(&mut s, frame(HEAD + v(0.055, -0.01, 0.0), v(0.56, -0.83, 0.0), Vec3::Z));
    s
}

/// Two rods side by side, far enough apart to stay two.
fn arm(s: &mut Solid, a: Vec3, b: Vec3) {
    s.add("arm", 0.014, move |p| stick(v(p.x, p.y, p.z.abs()), a + v(0.0, 0.0, 0.052), b + v(0.0, 0.0, 0.052), 0.024));
}

/// The shade opens along the frame's y.
fn shade(s: &mut Solid, f: Frame) {
    let ring = |y: f32, r: f32| Station::sym(y, r, r, -r, 2.0);
    let outer = Loft::new(
        &[
            ring(-0.02, 0.090),
            ring(0.06, 0.112),
            ring(0.16, 0.150),
            ring(0.28, 0.232),
            ring(0.40, 0.296),
            ring(0.50, 0.325),
        ],
        [0.03, 0.4],
    );
    let inner = Loft::new(
        &[
            ring(0.10, 0.085),
            ring(0.16, 0.112),
            ring(0.28, 0.190),
            ring(0.40, 0.254),
            ring(0.52, 0.284),
            ring(0.66, 0.30),
        ],
        [0.03, 0.2],
    );
    s.add("shade", 0.02, move |p| {
        let q = f.local(p);
        // The mouth is cut straight.
        -union(-outer.distance(q), 0.475 - q.y, 0.014)
    });
    s.cut(0.022, move |p| inner.distance(f.local(p)));
    // A bead around the mouth.
    s.add("shade", 0.012, move |p| {
        let q = f.local(p) - v(0.0, 0.468, 0.0);
        super::shapes::torus(q, 0.298, 0.026)
    });
    s.add("socket", 0.02, move |p| disc(f.local(p) - v(0.0, 0.125, 0.0), 0.060, 0.075, 0.014));
    s.add("bulb", 0.012, move |p| {
        let q = f.local(p);
        let neck = round_cone(q, v(0.0, 0.20, 0.0), v(0.0, 0.375, 0.0), 0.050, 0.105);
        union(neck, ball(q, v(0.0, 0.415, 0.0), 0.140), 0.05)
    });
}
