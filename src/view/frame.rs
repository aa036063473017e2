//! Where things are: source units, view space.

use bevy::prelude::*;
use glam::DVec3;

use crate::boundary::Boundary;

/// Source units to view space and back: the longest side of the rest shape becomes 2, its foot y = 0, its middle x = z = 0.
///
/// A flat boundary (no extent in z) is centred in y as well: a picture hangs, it does not stand.
///
/// On the entity of every [`Body`](super::Body) after its first frame; [`ViewFrame::of`] gives the same earlier.
#[derive(Component, Debug, Clone, Copy, PartialEq)]
pub struct ViewFrame {
    /// View units per source unit, > 0.
    pub scale: f64,
    /// Source position that becomes the origin.
    pub origin: DVec3,
    /// Whether the boundary has no extent in z: it is shown as a picture, not as a body on a floor.
    pub is_flat: bool,
}

impl ViewFrame {
    /// The frame of a boundary at rest. A boundary without extent keeps its scale.
    pub fn of(boundary: &Boundary) -> Self {
        let (low, high) = boundary.bounds().unwrap_or((DVec3::ZERO, DVec3::ONE));
        let longest = (high - low).max_element();
        let scale = if longest > 0.0 && longest.is_finite() { 2.0 / longest } else { 1.0 };
        let mut origin = (low + high) * 0.5;
        let is_flat = high.z <= low.z;
        if !is_flat {
            origin.y = low.y;
        }
        Self { scale, origin, is_flat }
    }

    /// Source units to view space.
    pub fn world_from_source(&self, p: DVec3) -> Vec3 {
        ((p - self.origin) * self.scale).as_vec3()
    }

    /// View space to source units.
    pub fn source_from_world(&self, p: Vec3) -> DVec3 {
        p.as_dvec3() / self.scale + self.origin
    }

    /// A length in source units, in view space.
    pub fn world_length(&self, source: f64) -> f32 {
        (source * self.scale) as f32
    }

    /// A length in view space, in source units.
    pub fn source_length(&self, world: f32) -> f64 {
        f64::from(world) / self.scale
    }
}

/// The box around a body in the states it is shown in, view space, its [`Placement`] included. On the entity of every
/// [`Body`](super::Body) after its first frame; [`extent`](super::extent) gives the same for any states.
#[derive(Component, Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// Lowest corner.
    pub low: Vec3,
    /// Highest corner.
    pub high: Vec3,
}

impl Extent {
    /// The box around both.
    pub fn union(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// The same box elsewhere.
    pub fn moved(self, offset: Vec3) -> Self {
        Self { low: self.low + offset, high: self.high + offset }
    }
}

/// Where a body stands: moved by `offset` in view space. Two bodies side by side have two placements.
#[derive(Component, Debug, Clone, Copy, PartialEq, Default)]
pub struct Placement {
    /// View space.
    pub offset: Vec3,
}
