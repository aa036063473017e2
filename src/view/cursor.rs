//! The brush, drawn on the surface where it would paint.

use bevy::prelude::*;

/// The brush over the [`Body`](super::Body) on the same entity, a ring on the surface. All of it in view space **at rest**:
/// what is within the radius of the rest shape is within the brush, however it has grown since.
#[derive(Component, Debug, Clone, PartialEq, Default)]
pub struct Cursor {
    /// Centre, or `None` where the pointer is not on the surface.
    pub at: Option<Vec3>,
    /// Surface normal there; tilts nothing yet stays for brushes that face one way: what faces away is not painted.
    pub normal: Vec3,
    /// > 0.
    pub radius: f32,
    /// Where mirrored copies of the brush paint, at most 7.
    pub mirrored: Vec<Vec3>,
    /// What a click would do, shown within the ring.
    pub dab: Option<Dab>,
}

/// The colour a dab would leave.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dab {
    /// Value to be painted, in the units of the field shown; its colour is the legend's.
    pub value: f32,
    /// How much of it at the centre, 0..=1.
    pub strength: f32,
    /// Falloff: 0 = to the rim evenly, 1 = smoothly from the centre.
    pub softness: f32,
}
