//! A human of our own: relaxed A-pose, palms to the front, modelled from lofts and round cones.
//!
//! Y is up, the face looks along +Z, lengths are metres, the soles stand on y = 0 and the crown is at 1.75.

mod arm;
mod face;
mod hand;
mod head;
mod leg;
mod regions;
mod torso;
mod values;

pub use arm::Arm;
pub use hand::{Finger, Hand};
pub use head::Head;
pub use leg::{Leg, Toe};
pub use regions::{NAMES, memberships};
pub use torso::Torso;
pub use values::{Table, read_values, scenes};

use glam::Vec3;

use super::implicit::union;

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
    pub const LOW: Vec3 = Vec3::new(-0.75, -0.02, -0.20);
    /// Highest corner.
    pub const HIGH: Vec3 = Vec3::new(0.75, 1.78, 0.26);

    /// Near-distance to the skin, metres: negative inside. Parts farther than their melt are not computed.
    pub fn distance(&self, p: Vec3) -> f32 {
        let q = Vec3::new(p.x.abs(), p.y, p.z);
        let mut f = (p - Vec3::new(0.0, 1.2, 0.0)).length() + 0.5;
        if q.y > 0.74 && q.y < 1.66 && q.x < 0.34 {
            f = f.min(self.torso.distance(p));
        }
        if q.y > 1.44 && q.x < 0.18 {
            f = union(f, self.head.distance(p), 0.030);
        }
        if q.y < 1.02 && q.x < 0.36 {
            // Thighs and trunk flow into each other, less so in the groin and below the buttock.
            f = union(f, self.leg.distance(q), 0.05);
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
            fine + t * (0.0104 - fine)
        };
        let hand = self.arm.hand.frame.world(Vec3::new(-0.01, 0.11, 0.0));
        [
            near(Vec3::new(0.032, 1.638, 0.090), 0.017, 0.32, 0.0016),
            near(Vec3::new(0.0, 1.580, 0.105), 0.030, 0.34, 0.0019),
            near(Vec3::new(0.082, 1.620, -0.012), 0.038, 0.32, 0.0021),
            near(hand, 0.115, 0.40, 0.0029),
            near(Vec3::new(0.165, 0.02, 0.08), 0.120, 0.55, 0.0037),
        ]
        .into_iter()
        .fold(0.0096, f32::min)
    }
}
