//! What is drawn: a boundary with its complex, between two of its states.

use std::sync::Arc;

use bevy::prelude::*;
use glam::Vec3A;

use super::{Looks, Picker, Placement};
use crate::{boundary::Boundary, transfer::Binding, voxel::Complex};

/// A boundary, its complex, and what ties them together. Cheap to clone.
///
/// Its surface is drawn with the materials and textures of the file, or studio grey where there are none.
#[derive(Component, Debug, Clone)]
#[require(Looks, Picker, Placement, Transform, Visibility)]
pub struct Body {
    /// B.
    pub boundary: Arc<Boundary>,
    /// C.
    pub complex: Arc<Complex>,
    /// B to C.
    pub binding: Arc<Binding>,
}

/// Two states of the complex and the blend between them. Without this component a [`Body`] is drawn at rest.
///
/// States are told apart by their `Arc`: what was computed for one is kept as long as the `Arc` lives. Changing only
/// `blend` writes a few bytes to the GPU.
#[derive(Component, Debug, Clone)]
pub struct Pose {
    /// `[nodes]` V'' in cells, shown at blend 0.
    pub from: Arc<Vec<Vec3A>>,
    /// `[nodes]` V'' in cells, shown at blend 1.
    pub to: Arc<Vec<Vec3A>>,
    /// 0..=1.
    pub blend: f32,
}

impl Body {
    /// Binds a boundary to its complex.
    pub fn new(boundary: Arc<Boundary>, complex: Arc<Complex>) -> Self {
        let binding = Arc::new(Binding::new(&boundary, &complex));
        Self { boundary, complex, binding }
    }
}

impl Pose {
    /// One state alone.
    pub fn still(state: Arc<Vec<Vec3A>>) -> Self {
        Self { from: state.clone(), to: state, blend: 0.0 }
    }
}
