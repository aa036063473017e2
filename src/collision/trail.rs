//! The states that growth passes in the plane, where parts flow further between two keyframes than straight motions
//! lead.

use bevy::prelude::Component;
use glam::{Vec2, Vec3A};

/// States since the last keyframe may take this much memory; where they would take more, each second is let go.
const MOST_BYTES: usize = 256 << 20;

/// Flat states since the last keyframe. The motion from each to the next is proven to be valid.
#[derive(Component, Debug, Clone, Default)]
pub struct Trail(Vec<Vec<Vec2>>);

impl Trail {
    /// Keeps a flat state on the way to the next keyframe, in case that the straight motion there is not proven. From
    /// each to the next it must be.
    pub fn pass(&mut self, positions: &[Vec3A]) {
        if size_of::<Vec2>() * positions.len() * self.0.len() > MOST_BYTES {
            let mut is_kept = false;
            self.0.retain(|_| {
                is_kept = !is_kept;
                is_kept
            });
        }
        self.0.push(positions.iter().map(|p| p.truncate()).collect());
    }

    /// The states passed, up to this one where it is among them: what came after a state that was returned to does not
    /// lead there. None are left.
    pub fn take_up_to(&mut self, positions: &[Vec3A]) -> Vec<Vec<Vec2>> {
        let is_it = |passed: &Vec<Vec2>| passed.iter().zip(positions).all(|(a, b)| *a == b.truncate());
        let mut passed = std::mem::take(&mut self.0);
        let end = passed.iter().position(is_it).unwrap_or(passed.len());
        passed.truncate(end);
        passed
    }

    /// Forgets all.
    pub fn clear(&mut self) {
        self.0.clear();
    }
}
