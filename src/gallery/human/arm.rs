//! Shoulder muscle, upper arm, elbow and forearm, of the half x ≥ 0; the hand is in `hand`.

use glam::Vec3;

use super::hand::Hand;
use crate::gallery::implicit::{Frame, Loft, Station, ball, chain, ellipsoid, union};

/// One arm with its hand.
#[derive(Debug)]
pub struct Arm {
    /// y from the shoulder to the elbow, z forward, x towards the body.
    pub upper: Frame,
    /// y from the elbow to the wrist, z forward, x towards the body.
    pub fore: Frame,
    /// The hand at its end.
    pub hand: Hand,
    upper_loft: Loft,
    fore_loft: Loft,
}

/// Centre of the shoulder joint.
pub const SHOULDER: Vec3 = Vec3::new(0.172, 1.408, -0.022);
/// Centre of the elbow: 0.30 m from the shoulder, 40 degrees from the vertical.
pub const ELBOW: Vec3 = Vec3::new(0.358, 1.172, -0.030);
/// Centre of the wrist: 0.25 m from the elbow, a little forward.
pub const WRIST: Vec3 = Vec3::new(0.518, 0.982, 0.004);

impl Arm {
    /// Upper arm 0.30 around, forearm 0.27, wrist 0.17.
    pub(crate) fn new() -> Self {
        let s = Station::between;
        let upper = [
            s(0.000, -0.046, 0.044, 0.044, -0.046, 2.0),
            s(0.070, -0.049, 0.044, 0.045, -0.047, 2.0),
            s(0.130, -0.043, 0.043, 0.044, -0.045, 2.0),
            s(0.190, -0.039, 0.041, 0.043, -0.041, 2.0),
            s(0.250, -0.038, 0.038, 0.037, -0.037, 2.1),
            s(0.300, -0.040, 0.040, 0.034, -0.037, 2.2),
        ];
        let fore = [
            s(-0.020, -0.038, 0.037, 0.034, -0.036, 2.1),
            s(0.030, -0.043, 0.040, 0.036, -0.037, 2.1),
            s(0.080, -0.042, 0.038, 0.036, -0.036, 2.1),
            s(0.140, -0.036, 0.032, 0.030, -0.030, 2.2),
            s(0.200, -0.029, 0.027, 0.022, -0.023, 2.3),
            s(0.245, -0.028, 0.027, 0.018, -0.019, 2.4),
            s(0.275, -0.029, 0.028, 0.017, -0.018, 2.4),
        ];
        Self {
            upper: Frame::new(SHOULDER, ELBOW - SHOULDER, Vec3::Z),
            fore: Frame::new(ELBOW, WRIST - ELBOW, Vec3::Z),
            hand: Hand::new(WRIST, Vec3::new(0.60, -0.79, 0.10), Vec3::new(-0.25, 0.0, 1.0)),
            upper_loft: Loft::new(&upper, [0.03, 0.03]),
            fore_loft: Loft::new(&fore, [0.03, 0.02]),
        }
    }

    /// Near-distance to arm and hand; `q` in the half x ≥ 0.
    pub fn distance(&self, q: Vec3) -> f32 {
        let f = self.limb(q);
        if q.distance(self.hand.frame.origin) < 0.38 {
            return union(f, self.hand.distance(q), 0.025);
        }
        f
    }

    /// Shoulder to wrist without the hand.
    pub fn limb(&self, q: Vec3) -> f32 {
        let v = Vec3::new;
        let u = self.upper.local(q);
        let mut upper = self.upper_loft.distance(u);
        let deltoid = chain(
            u,
            &[(v(0.004, 0.002, 0.0), 0.047), (v(-0.014, 0.055, 0.0), 0.049), (v(-0.020, 0.130, 0.0), 0.026)],
            0.03,
        );
        let biceps = ellipsoid(u, v(0.004, 0.175, 0.020), v(0.029, 0.080, 0.030));
        let triceps = ellipsoid(u, v(0.008, 0.135, -0.022), v(0.032, 0.090, 0.032));
        upper = union(upper, deltoid, 0.025);
        upper = union(upper, union(biceps, triceps, 0.02), 0.02);
        let l = self.fore.local(q);
        let mut fore = self.fore_loft.distance(l);
        fore = union(fore, ellipsoid(l, v(-0.022, 0.035, 0.010), v(0.024, 0.080, 0.024)), 0.025);
        fore = union(fore, ellipsoid(l, v(0.018, 0.060, 0.004), v(0.024, 0.075, 0.028)), 0.025);
        fore = union(fore, ball(l, v(0.022, 0.238, -0.010), 0.0095), 0.02);
        let f = union(upper, fore, 0.03);
        union(f, ball(l, v(0.008, -0.012, -0.030), 0.012), 0.02)
    }
}
