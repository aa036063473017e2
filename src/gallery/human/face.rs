//! Brows, eyes, nose and mouth on the bare head. Millimetres in the head's space; `q` is mirrored to x ≥ 0.

use glam::Vec3;

use super::ear::Ear;
use crate::gallery::implicit::{bump, chain, common, curve, cut, ellipsoid, ramp, round_cone, stroke, tube, union};

/// Centre and half-axes of the eyeball: wider than a ball, so that it fills the corners of the lids.
pub const EYE: (Vec3, Vec3) = (Vec3::new(31.5, 0.0, 77.8), Vec3::new(15.4, 12.8, 12.8));

/// The curves of the face: brows, lids, lips and the line of the mouth; and the ear.
#[derive(Debug)]
pub struct Face {
    brow: Vec<Knot>,
    hair: Vec<Knot>,
    lid: Vec<Knot>,
    upper_lip: Vec<Knot>,
    lower_lip: Vec<Knot>,
    mouth_line: Vec<Knot>,
    ear: Ear,
}

type Knot = (Vec3, f32);

impl Face {
    /// Proportions of the neoclassical canon: the mouth a third of the way from nose to chin, the ear as long as the nose.
    pub(crate) fn new() -> Self {
        let k = |x: f32, y: f32, z: f32, r: f32| (Vec3::new(x, y, z), r);
        let corner = k(25.5, -72.6, 91.2, 2.0);
        let brow =
            [k(5.0, 13.0, 92.5, 7.0), k(28.0, 18.0, 90.0, 7.0), k(46.0, 15.5, 77.0, 7.0), k(57.0, 3.0, 61.0, 7.0)];
        let hair = [k(10.0, 14.5, 0.0, 7.5), k(26.0, 19.5, 0.0, 8.0), k(42.0, 18.5, 0.0, 7.0), k(54.0, 11.0, 0.0, 5.0)];
        let lid = [
            k(17.5, 4.0, 0.0, 2.6),
            k(24.0, 8.8, 0.0, 3.2),
            k(32.0, 10.6, 0.0, 3.4),
            k(41.0, 8.8, 0.0, 3.2),
            k(48.0, 3.6, 0.0, 2.6),
        ];
        let upper = [
            k(-6.0, -65.6, 101.6, 5.0),
            k(0.0, -66.4, 102.0, 4.9),
            k(6.0, -65.6, 101.6, 5.0),
            k(15.5, -68.4, 98.2, 4.2),
            corner,
        ];
        let lower = [
            k(-9.0, -77.6, 99.6, 5.8),
            k(0.0, -78.0, 100.3, 6.1),
            k(9.0, -77.6, 99.6, 5.8),
            k(18.0, -75.4, 96.0, 4.2),
            corner,
        ];
        let line = [
            k(-7.0, -71.2, 0.0, 2.9),
            k(0.0, -71.8, 0.0, 2.9),
            k(7.0, -71.2, 0.0, 2.9),
            k(16.0, -72.0, 0.0, 2.8),
            k(25.0, -72.6, 0.0, 2.2),
        ];
        Self {
            brow: curve(&brow, 5),
            hair: curve(&hair, 5),
            lid: curve(&lid, 4),
            upper_lip: curve(&upper, 5),
            lower_lip: curve(&lower, 5),
            mouth_line: curve(&line, 5),
            ear: Ear::new(),
        }
    }

    /// The head `f` with its features.
    pub fn features(&self, p: Vec3, q: Vec3, f: f32) -> f32 {
        let mut f = f;
        if q.z > 30.0 && q.y > -130.0 && q.y < 60.0 {
            f = union(f, tube(q, &self.brow), 18.0);
            f = cut(f, ellipsoid(q, Vec3::new(32.0, 0.0, 104.0), Vec3::new(18.0, 12.0, 16.0)), 18.0);
            f = Self::nose(q, f);
            f = self.mouth(p, q, f);
            f = Self::eye(q, f);
            // The hair of the brow and the fold of the lid, whatever the depth of the skin there.
            f -= 0.9 * stroke(q.with_z(0.0), &self.hair);
            f += 0.9 * stroke(q.with_z(0.0), &self.lid);
        }
        if q.x < 45.0 { f } else { union(f, self.ear(q), 4.0) }
    }

    fn nose(q: Vec3, f: f32) -> f32 {
        let v = Vec3::new;
        // A tent that falls softly to the cheeks, the bridge on it, then the tip between its wings.
        let side = round_cone(q, v(4.0, 0.0, 86.0), v(8.0, -31.0, 95.5), 9.0, 10.5);
        let bridge =
            chain(q, &[(v(0.0, 10.0, 90.0), 8.5), (v(0.0, -18.0, 100.5), 7.8), (v(0.0, -35.0, 110.5), 8.5)], 9.0);
        let tip = ellipsoid(q, v(0.0, -38.0, 114.0), v(10.5, 9.0, 10.5));
        let wing = ellipsoid(q, v(12.6, -43.5, 102.5), v(6.0, 7.6, 10.5));
        let rim = round_cone(q, v(5.0, -43.5, 112.5), v(12.5, -46.4, 105.0), 4.8, 4.9);
        let base = round_cone(q, v(0.0, -44.0, 113.5), v(0.0, -47.0, 98.0), 4.4, 5.0);
        let mut f = union(f, side, 24.0);
        let nose = union(union(union(union(bridge, tip, 14.0), wing, 11.0), rim, 8.0), base, 6.0);
        f = union(f, nose, 11.0);
        cut(f, ellipsoid(q, v(7.5, -47.5, 106.0), v(3.4, 6.2, 5.2)), 2.0)
    }

    fn mouth(&self, p: Vec3, q: Vec3, f: f32) -> f32 {
        let v = Vec3::new;
        // The teeth push the muzzle out; the lips are two rolls on it that meet in a line.
        let muzzle = ellipsoid(q, v(0.0, -71.0, 75.0), v(36.0, 27.0, 27.0));
        let mut f = union(f, muzzle, 20.0);
        // Groove above the lip between its ridges, fold between lip and chin, dimple at the corner.
        f += 1.5 * stroke(p, &[(v(0.0, -52.0, 104.0), 5.0), (v(0.0, -61.0, 106.0), 6.0)]);
        f += 2.0 * bump(((q - v(0.0, -89.0, 101.0)) / v(24.0, 10.0, 16.0)).length(), 1.0);
        f = union(f, self.lips(q), 4.5);
        f += 0.8 * bump(q.distance(v(29.0, -73.0, 91.0)), 9.0);
        // Pressed in, not cut out: a cut would undermine the lips, and the triangles of its rims would cross.
        f + 1.3 * (1.0 - 0.5 * ramp(q.x, 16.0, 27.0)) * stroke(q.with_z(0.0), &self.mouth_line)
    }

    /// Near-distance to the two lips, millimetres.
    pub fn lips(&self, q: Vec3) -> f32 {
        union(tube(q, &self.upper_lip), tube(q, &self.lower_lip), 8.0)
    }

    /// Near-distance to the ear, millimetres.
    pub fn ear(&self, q: Vec3) -> f32 {
        self.ear.distance(q)
    }

    fn eye(q: Vec3, f: f32) -> f32 {
        let (centre, radii) = EYE;
        let d = q - centre;
        let f = union(f, ellipsoid(q, centre, radii + 2.8), 6.0);
        // The opening: an almond between two arcs, the inner corner a little lower.
        let (x, y) = (d.x, d.y - 0.08 * d.x);
        let (upper, lower) = (y - 5.0 + 0.0225 * x * x, -4.3 - y + 0.0195 * x * x);
        let opening = common(common(upper, lower, 1.2), 5.0 - d.z, 1.0);
        let f = cut(f, opening, 2.6);
        // Cornea and pupil give the eye a direction to look in.
        let gaze = (d - Vec3::new(-0.8, 0.6, 0.0)).truncate().length();
        let front = f32::from(d.z > 0.0);
        let ball = ellipsoid(q, centre, radii)
            - front * (0.6 * bump(gaze, 7.0) - 1.3 * bump(gaze, 3.2) - 0.5 * bump(gaze - 6.0, 1.8));
        union(f, ball, 1.6)
    }
}
