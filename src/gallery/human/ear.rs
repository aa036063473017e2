//! The ear: a plate with a rolled rim, a forked inner ridge, the hollow and the tragus. Millimetres in the head's space.

use glam::Vec3;

use crate::gallery::implicit::{curve, cut, ellipsoid, round_cone, tube, union};

/// The curves of the ear in its own plane: x to the back along the plate, y up, z outward from it.
#[derive(Debug)]
pub struct Ear {
    helix: Vec<(Vec3, f32)>,
    antihelix: Vec<(Vec3, f32)>,
    fork: Vec<(Vec3, f32)>,
}

impl Ear {
    pub(crate) fn new() -> Self {
        let k = |x: f32, y: f32, z: f32, r: f32| (Vec3::new(x, y, z), r);
        // The rim starts in the hollow, climbs, goes round the back and thins towards the lobe.
        let helix = [
            k(9.0, -1.5, 1.6, 1.9),
            k(2.5, 4.0, 2.8, 2.3),
            k(0.0, 13.0, 3.2, 2.6),
            k(4.0, 24.0, 3.6, 2.9),
            k(14.0, 30.0, 4.2, 3.0),
            k(24.5, 25.0, 4.6, 2.9),
            k(28.5, 12.5, 4.6, 2.7),
            k(26.0, -2.0, 4.0, 2.5),
            k(20.0, -14.0, 3.2, 2.6),
            k(12.5, -24.0, 1.8, 4.4),
            k(5.5, -22.5, 0.8, 3.8),
        ];
        let antihelix = [
            k(11.5, 21.0, 2.2, 2.0),
            k(17.0, 14.0, 3.2, 2.5),
            k(19.2, 5.0, 3.8, 2.6),
            k(18.0, -4.5, 3.8, 2.6),
            k(14.0, -11.5, 3.6, 2.7),
            k(8.0, -13.0, 3.2, 2.4),
        ];
        let fork = [k(6.5, 12.0, 1.6, 1.8), k(12.0, 13.0, 2.6, 2.1), k(18.0, 9.5, 3.8, 2.4)];
        Self { helix: curve(&helix, 5), antihelix: curve(&antihelix, 5), fork: curve(&fork, 4) }
    }

    /// Near-distance, millimetres; `q` in the half x ≥ 0.
    pub fn distance(&self, q: Vec3) -> f32 {
        let v = Vec3::new;
        // It stands off the head by some 22 degrees and leans back.
        let (sin, cos) = 22.0_f32.to_radians().sin_cos();
        let d = q - v(67.0, -20.0, -2.0);
        let e = v(-d.z * cos + d.x * sin, d.y - 0.12 * d.z, d.x * cos + d.z * sin);
        let plate = ellipsoid(e, v(13.0, 2.0, 0.8), v(17.8, 30.0, 4.4));
        let root = ellipsoid(e, v(5.0, 4.0, -5.0), v(11.0, 27.0, 7.5));
        let mut ear = union(union(plate, root, 6.0), tube(e, &self.helix), 4.5);
        ear = union(ear, tube(e, &self.antihelix).min(tube(e, &self.fork)), 3.0);
        // The hollow reaches down to the ear hole, which the tragus half covers.
        ear = cut(ear, ellipsoid(e, v(9.5, -3.0, 6.6), v(7.0, 8.6, 7.6)), 2.5);
        let tragus = round_cone(e, v(-0.5, -3.0, 2.5), v(3.2, -6.5, 5.0), 4.0, 2.6);
        union(ear, tragus, 3.0)
    }
}
