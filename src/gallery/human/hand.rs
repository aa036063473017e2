//! A spread hand: metacarpals, thumb and little-finger muscle, the lines of the palm.

use glam::Vec3;

use super::finger::Finger;
use crate::gallery::implicit::{Frame, bump, chain, curve, ramp, round_box, round_cone, stroke, union};

/// One hand.
#[derive(Debug, Clone)]
pub struct Hand {
    /// Origin at the wrist, y towards the fingers, z out of the palm, x towards the little finger.
    pub frame: Frame,
    /// Thumb, index, middle, ring, little.
    pub fingers: [Finger; 5],
    lines: [Vec<(Vec3, f32)>; 3],
}

/// Where each metacarpal starts and its knuckle, index to little finger: metres, a fifth over life size.
pub(super) const METACARPALS: [[Vec3; 2]; 4] = [
    [Vec3::new(-0.017, 0.020, -0.001), Vec3::new(-0.0475, 0.108, 0.000)],
    [Vec3::new(-0.006, 0.018, -0.003), Vec3::new(-0.0160, 0.117, -0.004)],
    [Vec3::new(0.007, 0.018, -0.003), Vec3::new(0.0160, 0.113, -0.003)],
    [Vec3::new(0.018, 0.020, -0.001), Vec3::new(0.0470, 0.099, 0.001)],
];

impl Hand {
    /// A hand at `wrist` whose middle axis runs `along` and whose palm looks `towards`.
    pub fn new(wrist: Vec3, along: Vec3, towards: Vec3) -> Self {
        let fingers = [Finger::thumb(), Finger::long(0), Finger::long(1), Finger::long(2), Finger::long(3)];
        let k = |x: f32, y: f32| (Vec3::new(x, y, 0.0), 0.0050);
        // Around the thumb's ball, across the middle, below the fingers.
        let life = [k(-0.040, 0.084), k(-0.014, 0.072), k(-0.004, 0.048), k(-0.006, 0.024)];
        let head = [k(-0.040, 0.085), k(-0.010, 0.081), k(0.020, 0.066), k(0.036, 0.056)];
        let heart = [k(-0.022, 0.108), k(-0.006, 0.098), k(0.018, 0.089), k(0.050, 0.088)];
        Self {
            frame: Frame::new(wrist, along, towards),
            fingers,
            lines: [curve(&life, 4), curve(&head, 4), curve(&heart, 4)],
        }
    }

    /// Near-distance; `q` in the body's space (half x ≥ 0).
    pub fn distance(&self, q: Vec3) -> f32 {
        let p = self.frame.local(q);
        let mut f = palm(p);
        let mut digits = f32::INFINITY;
        for digit in &self.fingers {
            digits = union(digits.min(1.0), digit.distance(p), 0.012);
        }
        f = union(f, digits, 0.016);
        if p.z > 0.0 && p.y < 0.12 {
            // The hollow of the palm and its lines.
            f += 0.0050 * bump(p.distance(Vec3::new(0.0, 0.068, 0.021)), 0.038);
            let flat = p.with_z(0.0);
            f +=
                0.0010 * ramp(p.z, 0.002, 0.010) * self.lines.iter().map(|line| stroke(flat, line)).fold(0.0, f32::max);
        }
        f
    }
}

fn palm(p: Vec3) -> f32 {
    let v = Vec3::new;
    let mut f = round_box(p - v(0.0, 0.060, 0.001), v(0.041, 0.052, 0.0130), 0.0125);
    for [base, head] in METACARPALS {
        f = union(f, round_cone(p, base, head, 0.0175, 0.0140), 0.016);
        // The knuckle and the tendon that runs to it.
        f -= 0.0022 * bump(p.distance(head - Vec3::Z * 0.013), 0.015);
        f -= 0.0005 * stroke(p, &[(base - Vec3::Z * 0.017, 0.007), (head - Vec3::Z * 0.015, 0.008)]);
    }
    let thenar = chain(
        p,
        &[(v(-0.018, 0.022, 0.006), 0.018), (v(-0.038, 0.050, 0.012), 0.0195), (v(-0.056, 0.064, 0.014), 0.015)],
        0.012,
    );
    let web = round_cone(p, v(-0.034, 0.074, 0.004), v(-0.050, 0.066, 0.009), 0.012, 0.010);
    let hypothenar = chain(
        p,
        &[(v(0.022, 0.024, 0.006), 0.016), (v(0.034, 0.054, 0.007), 0.0165), (v(0.038, 0.084, 0.004), 0.013)],
        0.012,
    );
    let pads = round_cone(p, v(-0.040, 0.101, 0.006), v(0.040, 0.095, 0.006), 0.0105, 0.0100);
    f = union(f, union(thenar, web, 0.02), 0.016);
    f = union(f, hypothenar, 0.016);
    union(f, pads, 0.014)
}
