//! The large intestine with a polyp on a loop of the sigmoid colon. The gut is a solid here and the polyp sits on its
//! outside, where it can be seen.

use std::f32::consts::PI;

use glam::Vec3;

use super::shapes::{Solid, Tube};
use crate::gallery::implicit::{ball, curve, ramp, round_cone, union};

const fn v(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

/// The gut from caecum to rectum, seen from the front: `(point, radius)`.
const GUT: [(Vec3, f32); 23] = [
    (v(-0.66, -0.60, 0.0), 0.130),
    (v(-0.68, -0.40, 0.0), 0.152),
    (v(-0.69, -0.02, 0.0), 0.142),
    (v(-0.70, 0.30, -0.03), 0.138),
    (v(-0.60, 0.56, -0.04), 0.134),
    (v(-0.36, 0.60, 0.04), 0.130),
    (v(-0.08, 0.46, 0.12), 0.126),
    (v(0.24, 0.46, 0.08), 0.122),
    (v(0.46, 0.67, -0.01), 0.118),
    (v(0.66, 0.69, -0.06), 0.115),
    (v(0.755, 0.48, -0.06), 0.112),
    (v(0.73, 0.05, -0.02), 0.108),
    (v(0.70, -0.30, 0.00), 0.106),
    (v(0.61, -0.55, 0.04), 0.104),
    (v(0.41, -0.60, 0.08), 0.104),
    (v(0.29, -0.38, 0.10), 0.104),
    (v(0.16, -0.10, 0.10), 0.104),
    (v(-0.10, -0.02, 0.08), 0.104),
    (v(-0.25, -0.22, 0.05), 0.104),
    (v(-0.18, -0.50, 0.00), 0.106),
    (v(-0.03, -0.72, -0.06), 0.112),
    (v(0.0, -0.94, -0.06), 0.122),
    (v(0.0, -1.12, -0.02), 0.090),
];
/// Length of one pouch (haustrum), metres.
const POUCH: f32 = 0.128;
/// How deep the folds between the pouches are, metres.
const FOLD: f32 = 0.034;
/// Where the polyp sits, and where to it grows.
const POLYP: [Vec3; 2] = [v(0.030, -0.070, 0.090), v(-0.020, -0.235, 0.110)];
/// The middle of the stretch around it and its reach along the gut, metres.
const STRETCH: (Vec3, f32) = (v(0.05, -0.045, 0.095), 0.30);

/// The implicit shape.
pub fn solid() -> Solid {
    let mut s = Solid::new(
        v(-0.90, -1.24, -0.26),
        v(0.92, 0.88, 0.34),
        0.07,
        &[("colon", 0.024), ("stretch", 0.018), ("polyp", 0.0125), ("ileum", 0.020), ("appendix", 0.018)],
    );
    let gut = Gut::new();
    let focus = gut.at(STRETCH.0).0;
    s.add("colon", 0.0, move |p| gut.distance(p));
    let ileum = Tube::new(&[
        (v(-0.58, -0.34, 0.06), 0.066),
        (v(-0.45, -0.31, 0.15), 0.062),
        (v(-0.40, -0.40, 0.22), 0.060),
        (v(-0.43, -0.54, 0.24), 0.060),
    ]);
    s.add("ileum", 0.05, move |p| ileum.distance(p));
    let appendix = Tube::new(&[
        (v(-0.68, -0.70, -0.02), 0.042),
        (v(-0.72, -0.82, 0.0), 0.034),
        (v(-0.66, -0.92, 0.02), 0.031),
        (v(-0.56, -0.95, 0.02), 0.029),
    ]);
    s.add("appendix", 0.04, move |p| appendix.distance(p));
    let [root, tip] = POLYP;
    s.add("polyp", 0.035, move |p| round_cone(p, root, tip, 0.036, 0.030));
    s.add("polyp", 0.020, move |p| {
        let head = union(ball(p, tip, 0.066), ball(p, tip + v(0.042, -0.022, 0.020), 0.040), 0.02);
        union(head, ball(p, tip + v(-0.040, -0.020, 0.022), 0.042), 0.02)
    });
    let gut = Gut::new();
    s.paint("stretch", move |p| {
        let (along, ..) = gut.at(p);
        let near = ramp(STRETCH.1 - (along - focus).abs(), -0.07, 0.07);
        let polyp = round_cone(p, root, tip, 0.036, 0.066);
        near * ramp(polyp, 0.015, 0.045)
    });
    s
}

/// A tube with pouches: three bands run along it and hold it in folds between them.
struct Gut {
    tube: Tube,
    /// Point, direction, side and length from the start, along the middle line.
    line: Vec<(Vec3, Vec3, Vec3, f32)>,
    length: f32,
}

impl Gut {
    fn new() -> Self {
        let fine = curve(&GUT, 8);
        let mut line: Vec<(Vec3, Vec3, Vec3, f32)> = Vec::with_capacity(fine.len());
        for (i, &(point, _)) in fine.iter().enumerate() {
            let ahead = (fine[(i + 1).min(fine.len() - 1)].0 - fine[i.saturating_sub(1)].0).normalize();
            // The side is carried along without twist.
            let (side, so_far) = line.last().map_or((Vec3::Z, 0.0), |l| (l.2, l.3 + l.0.distance(point)));
            line.push((point, ahead, side.reject_from(ahead).normalize(), so_far));
        }
        let length = line.last().map_or(0.0, |l| l.3);
        Self { tube: Tube::polyline(fine), line, length }
    }

    /// How far along the middle line `p` is, metres, at which angle around it, and how far outside of its bend: −1 at
    /// the bend's centre, 0 on the line.
    fn at(&self, p: Vec3) -> (f32, f32, f32) {
        let place = self.tube.along(p) * (self.line.len() - 1) as f32;
        let i = (place as usize).min(self.line.len() - 2);
        let (a, b, t) = (self.line[i], self.line[i + 1], place - i as f32);
        let (centre, ahead) = (a.0.lerp(b.0, t), a.1.lerp(b.1, t));
        let side = a.2.lerp(b.2, t);
        let out = p - centre;
        let (j, k) = (i.saturating_sub(3), (i + 4).min(self.line.len() - 1));
        let curvature = (self.line[k].1 - self.line[j].1) / (self.line[k].3 - self.line[j].3);
        (a.3 + t * (b.3 - a.3), out.dot(ahead.cross(side)).atan2(out.dot(side)), -out.dot(curvature))
    }

    fn distance(&self, p: Vec3) -> f32 {
        let tube = self.tube.distance(p);
        // Far inside and outside no fold matters.
        if tube.abs() > 0.12 {
            return tube;
        }
        let (along, angle, bend) = self.at(p);
        // Folds: narrow between two pouches, deepest between the bands, and none at the rectum.
        let fold = (PI * along / POUCH).cos().powi(4);
        let bands = 0.25 + 0.75 * (1.5 * angle).sin().powi(2);
        let calm = ramp(self.length - along, 0.10, 0.34) * ramp(along, 0.02, 0.10);
        // None on the inside of a bend, where the gut is folded already.
        let open = ramp(bend, -0.85, -0.15);
        0.86 * (tube + FOLD * fold * bands * calm * open)
    }
}
