//! The head: skull, face, nose, eyes, lips and ears. Millimetres inside, from the point between the eyes above the
//! ear holes' plane.

use glam::Vec3;

use super::face::Face;
use crate::gallery::implicit::{Loft, Station, chain, ellipsoid, mirrored, round_cone, union};

/// Height of the eyes above the ground, millimetres: 0.936 of the stature.
const EYE_HEIGHT: f32 = 1638.0;

/// The head.
#[derive(Debug)]
pub struct Head {
    mask: Loft,
    /// Its features.
    pub face: Face,
}

/// A body point (metres) in the head's millimetres.
pub fn to_head(p: Vec3) -> Vec3 {
    Vec3::new(p.x * 1000.0, p.y * 1000.0 - EYE_HEIGHT, p.z * 1000.0)
}

impl Head {
    /// Head 153 mm wide, 196 long, 227 from chin to crown; 108 between the corners of the jaw.
    pub(crate) fn new() -> Self {
        let s = Station::sym;
        let mask = [
            s(-99.0, 20.0, 88.0, 22.0, 2.0),
            s(-86.0, 32.0, 94.0, 5.0, 2.0),
            s(-70.0, 41.0, 95.0, -8.0, 2.0),
            s(-45.0, 51.0, 94.5, -15.0, 2.0),
            s(-20.0, 59.0, 94.0, -20.0, 2.1),
            s(0.0, 62.5, 94.0, -20.0, 2.2),
            s(22.0, 63.5, 96.5, -20.0, 2.2),
            s(45.0, 60.0, 88.0, -15.0, 2.1),
            s(65.0, 50.0, 74.0, -5.0, 2.0),
        ];
        Self { mask: Loft::new(&mask, [14.0, 30.0]), face: Face::new() }
    }

    /// Near-distance in metres; `p` in the body's space, either half.
    pub fn distance(&self, p: Vec3) -> f32 {
        let p = to_head(p);
        let q = mirrored(p, 1.5);
        let v = Vec3::new;
        let mut f = ellipsoid(q, v(0.0, 28.0, 4.0), v(75.0, 84.0, 95.0));
        f = union(f, ellipsoid(q, v(0.0, 40.0, 42.0), v(62.0, 56.0, 59.0)), 40.0);
        f = union(f, self.mask.distance(q), 30.0);
        let jaw =
            chain(q, &[(v(44.0, -42.0, 4.0), 11.0), (v(38.0, -70.0, 18.0), 10.5), (v(13.0, -100.0, 74.0), 11.0)], 16.0);
        f = union(f, jaw, 30.0);
        f = union(f, ellipsoid(q, v(39.0, -46.0, 48.0), v(22.5, 37.0, 37.0)), 36.0);
        f = union(f, ellipsoid(q, v(0.0, -99.0, 84.0), v(18.0, 13.5, 14.5)), 24.0);
        let cheekbone = round_cone(q, v(42.0, -26.0, 66.0), v(60.0, -14.0, 22.0), 16.0, 9.0);
        f = union(f, cheekbone, 36.0);
        f = self.face.features(p, q, f);
        0.001 * f
    }
}
