//! Brows, eyes, nose, mouth and ears on the bare head. Millimetres in the head's space; `q` is mirrored to x ≥ 0.

use glam::Vec3;

use crate::gallery::implicit::{ball, bump, chain, common, curve, cut, ellipsoid, round_cone, union};

/// Centre and radius of the eyeball.
pub const EYE: (Vec3, f32) = (Vec3::new(32.0, 0.0, 79.5), 12.6);

/// The curves of the face: brows, lips, the line of the mouth, the ears' rims.
#[derive(Debug)]
pub struct Face {
    brow: Vec<Knot>,
    upper_lip: Vec<Knot>,
    lower_lip: Vec<Knot>,
    mouth_line: Vec<Knot>,
    helix: Vec<Knot>,
    antihelix: Vec<Knot>,
}

type Knot = (Vec3, f32);

impl Face {
    /// Proportions of the neoclassical canon: the mouth a third of the way from nose to chin, the ear as long as the nose.
    pub(crate) fn new() -> Self {
        let k = |x: f32, y: f32, z: f32, r: f32| (Vec3::new(x, y, z), r);
        let corner = k(25.0, -72.4, 91.0, 2.0);
        let brow =
            [k(5.0, 14.0, 93.0, 7.0), k(28.0, 18.5, 90.0, 7.0), k(46.0, 15.5, 77.0, 7.0), k(57.0, 2.0, 61.0, 7.0)];
        let upper = [
            k(-6.0, -67.0, 104.2, 4.0),
            k(0.0, -67.8, 104.6, 3.8),
            k(6.0, -67.0, 104.2, 4.0),
            k(15.0, -69.4, 100.0, 3.3),
            corner,
        ];
        let lower = [
            k(-9.0, -76.6, 102.0, 4.8),
            k(0.0, -76.9, 103.2, 5.2),
            k(9.0, -76.6, 102.0, 4.8),
            k(17.0, -74.8, 98.0, 3.2),
            corner,
        ];
        let line = [
            k(-7.0, -71.4, 108.6, 0.9),
            k(0.0, -72.0, 109.4, 0.9),
            k(7.0, -71.4, 108.6, 0.9),
            k(15.0, -72.0, 104.2, 0.9),
            k(22.0, -72.4, 97.6, 0.9),
        ];
        let helix = [
            k(6.0, 1.0, 3.5, 2.2),
            k(0.5, 12.0, 3.0, 2.6),
            k(4.0, 24.0, 4.0, 2.9),
            k(14.0, 29.5, 5.0, 3.0),
            k(24.5, 24.0, 5.5, 3.0),
            k(28.0, 12.0, 5.5, 2.9),
            k(26.0, -2.0, 5.0, 2.7),
            k(19.5, -15.0, 4.0, 2.9),
            k(11.0, -25.0, 2.0, 4.2),
            k(4.0, -23.0, 0.0, 3.6),
        ];
        let antihelix =
            [k(14.0, 19.0, 2.5, 2.4), k(19.0, 8.0, 3.2, 2.6), k(17.0, -6.0, 3.2, 2.6), k(10.0, -13.5, 3.0, 2.4)];
        Self {
            brow: curve(&brow, 4),
            upper_lip: curve(&upper, 4),
            lower_lip: curve(&lower, 4),
            mouth_line: curve(&line, 4),
            helix: curve(&helix, 3),
            antihelix: curve(&antihelix, 3),
        }
    }

    /// The head `f` with its features.
    pub fn features(&self, p: Vec3, q: Vec3, f: f32) -> f32 {
        if q.z < -45.0 || q.y > 60.0 || q.y < -130.0 {
            return f;
        }
        let mut f = f;
        if q.z > 30.0 {
            f = union(f, chain(q, &self.brow, 4.0), 18.0);
            f = cut(f, ellipsoid(q, Vec3::new(32.0, 0.0, 103.0), Vec3::new(19.0, 12.0, 16.0)), 16.0);
            f = nose(q, f);
            f = self.mouth(p, q, f);
            f = eyes(q, f);
        }
        if q.x < 45.0 { f } else { union(f, self.ear(q), 4.0) }
    }

    fn mouth(&self, p: Vec3, q: Vec3, f: f32) -> f32 {
        let v = Vec3::new;
        // The teeth push the muzzle out; the lips are two rolls on it that meet in a line.
        let muzzle = ellipsoid(q, v(0.0, -70.0, 77.0), v(35.0, 26.0, 27.0));
        let mut f = union(f, muzzle, 20.0);
        f += 1.3 * bump(p.x, 5.5) * bump(p.y + 58.0, 10.0) * bump(p.z - 105.0, 14.0);
        f += 2.0 * bump(q.distance(v(0.0, -87.0, 104.0)), 18.0);
        f = union(f, self.lips(q), 4.0);
        cut(f, chain(q, &self.mouth_line, 1.0), 3.0)
    }

    /// Near-distance to the two lips, millimetres.
    pub fn lips(&self, q: Vec3) -> f32 {
        union(chain(q, &self.upper_lip, 2.0), chain(q, &self.lower_lip, 2.0), 7.0)
    }

    /// Near-distance to the ear, millimetres.
    pub fn ear(&self, q: Vec3) -> f32 {
        let v = Vec3::new;
        // The ear's own plane: x to the back along the plate, z outward from it; it stands off by some 22 degrees.
        let (sin, cos) = 22.0_f32.to_radians().sin_cos();
        let d = q - v(67.0, -20.0, -2.0);
        let e = v(-d.z * cos + d.x * sin, d.y - 0.12 * d.z, d.x * cos + d.z * sin);
        let plate = ellipsoid(e, v(11.0, 1.0, 1.4), v(17.5, 29.0, 4.4));
        let root = ellipsoid(e, v(5.0, 5.0, -4.0), v(11.0, 28.0, 7.0));
        let mut ear = union(union(plate, root, 6.0), chain(e, &self.helix, 1.0), 5.0);
        ear = union(ear, chain(e, &self.antihelix, 1.0), 5.0);
        ear = cut(ear, ellipsoid(e, v(8.5, -2.0, 6.6), v(6.5, 8.5, 5.0)), 3.0);
        union(ear, ellipsoid(e, v(0.5, -5.0, 4.0), v(3.4, 5.5, 3.2)), 3.0)
    }
}

fn nose(q: Vec3, f: f32) -> f32 {
    let v = Vec3::new;
    let bridge = chain(q, &[(v(0.0, 6.0, 93.0), 7.0), (v(0.0, -18.0, 106.0), 6.5), (v(0.0, -36.0, 115.5), 8.0)], 10.0);
    let side = round_cone(q, v(4.0, -4.0, 88.0), v(8.0, -36.0, 95.0), 8.0, 11.0);
    let tip = ellipsoid(q, v(0.0, -39.0, 116.5), v(9.5, 8.0, 9.0));
    let wing = ellipsoid(q, v(11.5, -42.5, 104.5), v(6.0, 6.5, 9.0));
    let base = round_cone(q, v(0.0, -44.0, 114.0), v(0.0, -50.0, 98.0), 4.5, 6.0);
    let mut nose = union(bridge, side, 18.0);
    nose = union(nose, tip, 10.0);
    nose = union(nose, wing, 7.0);
    nose = union(nose, base, 5.0);
    let f = union(f, nose, 14.0);
    let nostril = chain(q, &[(v(7.0, -52.5, 111.0), 3.2), (v(7.5, -44.0, 106.0), 2.6)], 2.0);
    cut(f, nostril, 2.0)
}

fn eyes(q: Vec3, f: f32) -> f32 {
    let (centre, radius) = EYE;
    let d = q - centre;
    let f = union(f, ball(q, centre, radius + 2.4), 9.0);
    // The opening: an almond between two arcs, inner corner a little lower.
    let (x, y) = (d.x, d.y - 0.06 * d.x);
    let upper = 5.8 - 0.0250 * x * x - y;
    let lower = y + 4.4 - 0.0195 * x * x;
    let front = common(common(-upper, -lower, 1.0), -(d.z - 4.0), 1.0);
    let f = cut(f, front, 2.0);
    let iris = 0.6 * bump(d.truncate().length(), 3.2) * f32::from(d.z > 0.0);
    union(f, ball(q, centre, radius) + iris, 0.8)
}
