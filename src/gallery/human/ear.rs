//! The ear: a plate with a rolled rim, an inner ridge, the hollow and the tragus. Millimetres in the head's space.

use glam::Vec3;

use crate::gallery::implicit::{curve, cut, ellipsoid, tube, union};

/// The curves of the ear in its own plane: x to the back along the plate, y up, z outward from it.
#[derive(Debug)]
pub struct Ear {
    helix: Vec<(Vec3, f32)>,
    antihelix: Vec<(Vec3, f32)>,
}

impl Ear {
    pub(crate) fn new() -> Self {
        let k = |x: f32, y: f32, z: f32, r: f32| (Vec3::new(x, y, z), r);
        let helix = [
            k(5.0, -1.0, 2.5, 2.0),
            k(0.5, 11.0, 3.0, 2.5),
            k(4.0, 23.5, 4.0, 2.8),
            k(14.0, 29.5, 5.0, 3.0),
            k(24.5, 24.5, 5.5, 3.0),
            k(28.0, 12.0, 5.5, 2.9),
            k(25.5, -2.0, 5.0, 2.8),
            k(19.0, -14.5, 4.0, 3.0),
            k(11.5, -24.0, 2.0, 4.6),
            k(4.5, -22.0, 0.5, 3.8),
        ];
        let antihelix =
            [k(13.0, 19.0, 2.5, 2.2), k(19.0, 8.5, 3.2, 2.6), k(17.5, -5.0, 3.2, 2.6), k(10.5, -13.0, 3.0, 2.4)];
        Self { helix: curve(&helix, 5), antihelix: curve(&antihelix, 5) }
    }

    /// Near-distance, millimetres; `q` in the half x ≥ 0.
    pub fn distance(&self, q: Vec3) -> f32 {
        let v = Vec3::new;
        // It stands off the head by some 22 degrees and leans back.
        let (sin, cos) = 22.0_f32.to_radians().sin_cos();
        let d = q - v(67.0, -20.0, -2.0);
        let e = v(-d.z * cos + d.x * sin, d.y - 0.12 * d.z, d.x * cos + d.z * sin);
        let plate = ellipsoid(e, v(11.5, 1.0, 1.9), v(18.6, 30.5, 5.2));
        let root = ellipsoid(e, v(5.0, 5.0, -4.0), v(11.0, 28.0, 7.0));
        let mut ear = union(union(plate, root, 6.0), tube(e, &self.helix), 5.0);
        ear = union(ear, tube(e, &self.antihelix), 4.0);
        ear = cut(ear, ellipsoid(e, v(8.5, -2.5, 6.8), v(6.8, 9.0, 5.6)), 3.0);
        union(ear, ellipsoid(e, v(0.5, -5.0, 4.0), v(3.4, 5.5, 3.4)), 3.0)
    }
}
