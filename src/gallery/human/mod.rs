//! A human of our own: relaxed A-pose, palms to the front, modelled from lofts and round cones.
//!
//! Y is up, the face looks along +Z, lengths are metres, the soles stand on y = 0 and the crown is at 1.75.

mod arm;
mod ear;
mod face;
mod finger;
mod hand;
mod head;
mod leg;
mod regions;
mod torso;
mod values;

pub use arm::Arm;
pub use finger::Finger;
pub use hand::Hand;
pub use head::Head;
pub use leg::{Leg, Toe};
pub use regions::{NAMES, memberships};
pub use torso::Torso;
pub use values::{Table, read_values, scenes};

use glam::Vec3;

use super::implicit::{ramp, union};

/// All parts of the body.
#[derive(Debug)]
pub struct Human {
    /// Trunk and neck.
    pub torso: Torso,
    /// Head with face and ears.
    pub head: Head,
    /// Left arm (x > 0); the right one is its mirror image.
    pub arm: Arm,
    /// Left leg.
    pub leg: Leg,
}

impl Default for Human {
    fn default() -> Self {
        Self { torso: Torso::new(), head: Head::new(), arm: Arm::new(), leg: Leg::new() }
    }
}

impl Human {
    /// Lowest corner of a box around the body.
    pub const LOW: Vec3 = Vec3::new(-0.79, -0.02, -0.20);
    /// Highest corner.
    pub const HIGH: Vec3 = Vec3::new(0.79, 1.78, 0.26);

    /// Near-distance to the skin, metres: negative inside. Parts farther than their melt are not computed.
    pub fn distance(&self, p: Vec3) -> f32 {
        let q = Vec3::new(p.x.abs(), p.y, p.z);
        let mut f = (p - Vec3::new(0.0, 1.2, 0.0)).length() + 0.5;
        if q.y > 0.74 && q.y < 1.66 && q.x < 0.34 {
            f = f.min(self.torso.distance(p));
        }
        if q.y > 1.40 && q.x < 0.18 {
            f = union(f, self.head.distance(p), 0.038);
        }
        if q.y < 1.02 && q.x < 0.36 {
            // Thighs and trunk flow into each other, less so in the groin and below the buttock.
            let melt = 0.045 + 0.045 * ramp(q.x, 0.07, 0.15);
            f = union(f, self.leg.distance(q), melt);
        }
        if q.x > 0.08 && q.y > 0.6 {
            f = union(f, self.arm.distance(q), 0.045);
        }
        f
    }

    /// The wanted length of a triangle's edge at `p`, metres: fine where the eye looks and where the warp magnifies.
    pub fn edge_length(&self, p: Vec3) -> f32 {
        let q = Vec3::new(p.x.abs(), p.y, p.z);
        let near = |centre: Vec3, inner: f32, outer: f32, fine: f32| {
            let t: f32 = ((q.distance(centre) - inner) / (outer - inner)).clamp(0.0, 1.0);
            fine + t * (0.0120 - fine)
        };
        let hand = self.arm.hand.frame.world(Vec3::new(-0.01, 0.11, 0.0));
        let tip = |digit: &Finger| near(self.arm.hand.frame.world(digit.knots[3].0), 0.013, 0.11, 0.0016);
        let tips = self.arm.hand.fingers.iter().map(tip);
        [
            near(Vec3::new(0.032, 1.638, 0.090), 0.018, 0.19, 0.0011),
            near(Vec3::new(0.0, 1.568, 0.103), 0.028, 0.23, 0.0015),
            near(Vec3::new(0.0, 1.592, 0.110), 0.016, 0.23, 0.0014),
            near(Vec3::new(0.082, 1.620, -0.012), 0.034, 0.20, 0.0017),
            near(Vec3::new(0.0, 1.047, 0.105), 0.012, 0.16, 0.0040),
            near(Vec3::new(0.0, 0.870, -0.105), 0.045, 0.30, 0.0055),
            near(hand, 0.125, 0.36, 0.0033),
            near(Vec3::new(0.165, 0.02, 0.08), 0.110, 0.42, 0.0040),
            near(Vec3::new(0.168, 0.01, 0.140), 0.050, 0.35, 0.0029),
        ]
        .into_iter()
        .chain(tips)
        .fold(0.0112, f32::min)
    }
}
