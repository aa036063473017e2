//! The view: a boundary drawn between two states of its complex, in a photographer's studio.
//!
//! # Theory
//! A film is a few keyframes and blends between them. Both node states of a [`Pose`] lie on the GPU, each surface vertex knows
//! its nodes and weights, and the vertex shader (`shaders/surface.wgsl`) puts the two together: playing a film writes one
//! number a frame. The sum is Section 3.5's, with the displacement, so a state at rest is the input itself.
//!
//! # Practice
//! - An entity with [`Body`], [`Pose`] and [`Looks`] is drawn; [`Placement`] puts it elsewhere, [`Ghost`] shows its rest shape,
//!   [`Cursor`] a brush on it. [`ViewPlugin`] keeps everything else.
//! - What depends on one state (displacements, normals, the shade on the floor) is computed on the CPU when a state is first
//!   seen, and lives as long as the `Arc` that holds the state.
//! - View space: longest side of the rest shape 2, standing on y = 0, centred over the origin; see [`ViewFrame`]. A deformed
//!   state is lifted so that it stands on the floor as well.
//! - [`headless`] renders without a window; [`adapter`] says beforehand whether anything can be rendered.

mod adapter;
mod body;
mod cursor;
mod frame;
mod ghost;
pub mod headless;
mod looks;
mod orbit;
mod pick;
mod size_legend;
mod studio;

pub use adapter::{Adapter, Quality, adapter};
pub use body::{Body, Pose};
pub use cursor::{Cursor, Dab};
pub use frame::{Placement, ViewFrame};
pub use ghost::Ghost;
pub use looks::{Legend, Looks, Mode, VoxelColour, Wipe};
pub use orbit::{Axis, Orbit};
pub use pick::{Hit, Picker, Target};
pub use size_legend::SizeLegend;
pub use studio::{Backdrop, Studio};

use bevy::prelude::*;

/// Draws bodies, in a window or into an image. Add it after Bevy's own plugins.
///
/// Needs the asset source of its shaders: add [`ShadersPlugin`] before `DefaultPlugins`.
pub struct ViewPlugin;

impl Plugin for ViewPlugin {
    fn build(&self, _app: &mut App) {}
}

/// Ships the shaders within the program, as asset source `shaders://`. Add it **before** `DefaultPlugins`.
pub struct ShadersPlugin;

impl Plugin for ShadersPlugin {
    fn build(&self, _app: &mut App) {}
}

/// When the view reads its components: change bodies, poses, looks and cameras before, in `Update` or `PostUpdate`.
#[derive(SystemSet, Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ViewSystems {
    /// In `PostUpdate`, before transforms are propagated.
    Present,
}
