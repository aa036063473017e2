//! A spread hand: metacarpals, thumb and little-finger muscle, five fingers with pads and nails.

use glam::Vec3;

use crate::gallery::implicit::{Frame, bump, chain, ellipsoid, round_box, round_cone, union};

/// A finger in the hand's frame: the joints' centres and radii, knuckle to tip.
#[derive(Debug, Clone)]
pub struct Finger {
    /// Knuckle, first joint, second joint, tip (the thumb: root, knuckle, joint, tip).
    pub knots: [(Vec3, f32); 4],
    /// Unit vector that the nail faces.
    nail: Vec3,
}

/// One hand.
#[derive(Debug, Clone)]
pub struct Hand {
    /// Origin at the wrist, y towards the fingers, z out of the palm, x towards the little finger.
    pub frame: Frame,
    /// Thumb, index, middle, ring, little.
    pub fingers: [Finger; 5],
}

/// Where each metacarpal starts and its knuckle, index to little finger: metres, an eighth over life size.
const METACARPALS: [[Vec3; 2]; 4] = [
    [Vec3::new(-0.016, 0.018, -0.001), Vec3::new(-0.036, 0.106, 0.000)],
    [Vec3::new(-0.005, 0.016, -0.003), Vec3::new(-0.011, 0.111, -0.004)],
    [Vec3::new(0.006, 0.016, -0.003), Vec3::new(0.014, 0.107, -0.003)],
    [Vec3::new(0.016, 0.018, -0.001), Vec3::new(0.037, 0.097, 0.001)],
];
/// Fan of each finger from the hand's axis towards the little finger, degrees. 22 degrees from one to the next leave
/// 23 mm (measured) between neighbours at their middle, more towards the tips, which stay apart at 96 cells (18 mm).
const FAN: [f32; 4] = [-30.0, -8.0, 15.0, 39.0];
/// Lengths of the three phalanges, metres; the last one to the centre of the tip's ball.
const PHALANGES: [[f32; 3]; 4] =
    [[0.048, 0.029, 0.021], [0.052, 0.033, 0.022], [0.049, 0.031, 0.022], [0.039, 0.024, 0.019]];
/// Thickness of each finger against the middle finger's.
const THICKNESS: [f32; 4] = [0.98, 1.0, 0.95, 0.84];

impl Hand {
    /// A hand at `wrist` whose middle axis runs `along` and whose palm looks `towards`.
    pub fn new(wrist: Vec3, along: Vec3, towards: Vec3) -> Self {
        let fingers = [thumb(), finger(0), finger(1), finger(2), finger(3)];
        Self { frame: Frame::new(wrist, along, towards), fingers }
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
        // The hollow of the palm.
        f + 0.0045 * bump(p.distance(Vec3::new(0.0, 0.066, 0.020)), 0.034)
    }
}

impl Finger {
    /// Near-distance; `p` in the hand's frame.
    pub fn distance(&self, p: Vec3) -> f32 {
        let k = &self.knots;
        let mut f = chain(p, k, 0.003);
        let (joint, tip, r) = (k[2].0, k[3].0, k[3].1);
        let along = (tip - joint).normalize();
        let side = along.cross(self.nail);
        // Pad on the palm's side, nail on the other.
        f = union(
            f,
            round_cone(p, tip - along * 0.008 - self.nail * 0.0016, tip - self.nail * 0.0012, r * 0.95, r * 0.92),
            0.006,
        );
        let d = p - (tip - along * 0.001 + self.nail * (r * 0.80));
        let nail = Vec3::new(d.dot(side), d.dot(along), d.dot(self.nail));
        let plate = ellipsoid(nail, Vec3::ZERO, Vec3::new(r * 0.72, r * 0.95, r * 0.26));
        union(f, plate, 0.0015)
    }
}

fn palm(p: Vec3) -> f32 {
    let v = Vec3::new;
    let mut f = round_box(p - v(0.0, 0.058, 0.001), v(0.034, 0.050, 0.0125), 0.012);
    for [base, head] in METACARPALS {
        f = union(f, round_cone(p, base, head, 0.0175, 0.0142), 0.016);
    }
    let thenar = chain(
        p,
        &[(v(-0.018, 0.020, 0.006), 0.018), (v(-0.036, 0.048, 0.011), 0.0185), (v(-0.050, 0.066, 0.013), 0.014)],
        0.012,
    );
    let web = round_cone(p, v(-0.030, 0.070, 0.004), v(-0.044, 0.066, 0.008), 0.012, 0.010);
    let hypothenar = chain(
        p,
        &[(v(0.020, 0.022, 0.006), 0.016), (v(0.030, 0.050, 0.007), 0.0165), (v(0.034, 0.080, 0.004), 0.013)],
        0.012,
    );
    let pads = round_cone(p, v(-0.030, 0.098, 0.006), v(0.030, 0.092, 0.006), 0.0105, 0.0100);
    f = union(f, union(thenar, web, 0.02), 0.016);
    f = union(f, hypothenar, 0.016);
    union(f, pads, 0.014)
}

fn finger(i: usize) -> Finger {
    let (sin, cos) = FAN[i].to_radians().sin_cos();
    let out = Vec3::new(sin, cos, 0.0);
    let t = THICKNESS[i];
    let mut at = METACARPALS[i][1];
    let mut knots = [(at, 0.0125 * t); 4];
    let radii = [0.0111 * t, 0.0100 * t, 0.0086 * t];
    // A relaxed hand: each phalanx leans a little more to the palm than the one before.
    for (k, lean) in [4.0_f32, 12.0, 18.0].into_iter().enumerate() {
        let (s, c) = lean.to_radians().sin_cos();
        at += (out * c + Vec3::Z * s) * PHALANGES[i][k];
        knots[k + 1] = (at, radii[k]);
    }
    let along = (knots[3].0 - knots[2].0).normalize();
    Finger { knots, nail: (-Vec3::Z).reject_from(along).normalize() }
}

fn thumb() -> Finger {
    let v = Vec3::new;
    let knots = [
        (v(-0.026, 0.022, 0.008), 0.0150),
        (v(-0.062, 0.056, 0.016), 0.0128),
        (v(-0.092, 0.080, 0.020), 0.0110),
        (v(-0.110, 0.101, 0.022), 0.0092),
    ];
    let along = (knots[3].0 - knots[2].0).normalize();
    Finger { knots, nail: v(-0.45, 0.0, -0.9).reject_from(along).normalize() }
}
