//! A finger: phalanges between thicker joints, the pad, the nail, the creases at the joints.

use glam::{Vec2, Vec3};

use super::hand::METACARPALS;
use crate::gallery::implicit::{bump, chain, ramp, round_cone, stroke, union};

/// A finger in the hand's frame: the joints' centres and radii, knuckle to tip.
#[derive(Debug, Clone)]
pub struct Finger {
    /// Knuckle, first joint, second joint, tip (the thumb: root, knuckle, joint, tip).
    pub knots: [(Vec3, f32); 4],
    /// The joints with the waists between them.
    flesh: [(Vec3, f32); 6],
    /// Unit vector that the nail faces.
    nail: Vec3,
}

/// Fan of each finger from the hand's axis towards the little finger, degrees. 28 degrees from one to the next, with
/// knuckles 32 mm apart, leave 27 mm between neighbours where their outer two thirds begin, so that no cell meets two
/// of them at 96 cells (18 mm, 26 mm across a face).
const FAN: [f32; 4] = [-43.0, -14.5, 13.5, 41.5];
/// Lengths of the three phalanges, metres; the last one to the centre of the tip's ball.
const PHALANGES: [[f32; 3]; 4] =
    [[0.048, 0.029, 0.021], [0.051, 0.032, 0.022], [0.048, 0.031, 0.022], [0.040, 0.025, 0.019]];
/// Thickness of each finger against the middle finger's.
const THICKNESS: [f32; 4] = [0.97, 1.0, 0.95, 0.86];

impl Finger {
    /// The index (0) to the little finger (3).
    pub(super) fn long(i: usize) -> Self {
        let (sin, cos) = FAN[i].to_radians().sin_cos();
        let out = Vec3::new(sin, cos, 0.0);
        let t = THICKNESS[i];
        let mut at = METACARPALS[i][1];
        let mut knots = [(at, 0.0128 * t); 4];
        let radii = [0.0119 * t, 0.0104 * t, 0.0088 * t];
        // A relaxed hand: each phalanx leans a little more to the palm than the one before.
        for (k, lean) in [4.0_f32, 12.0, 18.0].into_iter().enumerate() {
            let (s, c) = lean.to_radians().sin_cos();
            at += (out * c + Vec3::Z * s) * PHALANGES[i][k];
            knots[k + 1] = (at, radii[k]);
        }
        Self::through(knots, -Vec3::Z)
    }

    pub(super) fn thumb() -> Self {
        let v = Vec3::new;
        let knots = [
            (v(-0.026, 0.024, 0.008), 0.0160),
            (v(-0.068, 0.055, 0.017), 0.0132),
            (v(-0.103, 0.072, 0.021), 0.0124),
            (v(-0.127, 0.087, 0.023), 0.0108),
        ];
        Self::through(knots, v(-0.35, 0.0, -0.94))
    }

    fn through(knots: [(Vec3, f32); 4], nail: Vec3) -> Self {
        let waist = |k: usize| {
            let ((a, ra), (b, rb)) = (knots[k], knots[k + 1]);
            (a.lerp(b, 0.52), 0.445 * (ra + rb))
        };
        let along = (knots[3].0 - knots[2].0).normalize();
        let flesh = [knots[0], waist(0), knots[1], waist(1), knots[2], knots[3]];
        Self { knots, flesh, nail: nail.reject_from(along).normalize() }
    }

    /// Near-distance; `p` in the hand's frame.
    pub fn distance(&self, p: Vec3) -> f32 {
        let k = &self.knots;
        let (joint, tip, r) = (k[2].0, k[3].0, k[3].1);
        let mut f = chain(p, &self.flesh, 0.002);
        if f > 0.03 {
            return f;
        }
        let along = (tip - joint).normalize();
        let side = along.cross(self.nail);
        // The pad on the palm's side; the nail on the other.
        let pad = [tip - along * 0.009 - self.nail * 0.0020, tip - along * 0.001 - self.nail * 0.0016];
        f = union(f, round_cone(p, pad[0], pad[1], r * 0.97, r * 0.93), 0.006);
        // Between the joints the flesh lies on the palm's side; on the back the bone shows, and the joints stand out.
        for pair in k[..3].windows(2) {
            let ((a, ra), (b, rb)) = (pair[0], pair[1]);
            let r = 0.445 * (ra + rb);
            let palmward = -0.0032 * self.nail.reject_from((b - a).normalize()).normalize();
            f = union(f, round_cone(p, a.lerp(b, 0.34) + palmward, a.lerp(b, 0.70) + palmward, r, 0.94 * r), 0.006);
        }
        let d = p - tip;
        f += nail(Vec3::new(d.dot(side), d.dot(along) + 0.15 * r, d.dot(self.nail)), r);
        for (i, (at, r)) in k.iter().enumerate().skip(1).take(2) {
            let out = (k[i + 1].0 - k[i - 1].0).normalize();
            let back = self.nail.reject_from(out).normalize();
            let across = out.cross(back) * (r * 0.7);
            // A crease on the palm's side, loose skin over the joint on the other.
            let palm = *at - back * *r;
            f += 0.0010 * stroke(p, &[(palm - across, 0.0048), (palm + across, 0.0048)]);
            f -= 0.0008 * bump(p.distance(*at + back * *r), 0.011);
        }
        f
    }
}

/// What a nail adds to the field of a tip of radius `r`: a furrow around a plate that stands out a little. `d` from the
/// nail's middle, x across the finger, y along it, z outward.
pub(super) fn nail(d: Vec3, r: f32) -> f32 {
    if d.z < 0.2 * r {
        return 0.0;
    }
    let corner = 0.5 * r;
    let over = d.truncate().abs() - Vec2::new(0.68 * r - corner, 0.88 * r - corner);
    let rim = over.max(Vec2::ZERO).length() + over.max_element().min(0.0) - corner;
    0.0010 * bump(rim, 0.0022) - 0.0004 * ramp(-rim, 0.0, 0.0018)
}
