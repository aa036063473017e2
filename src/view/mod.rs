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
mod awaited;
mod body;
mod canvas;
mod colours;
mod contact;
mod cursor;
mod drawn;
pub mod fields;
mod file_materials;
mod frame;
mod ghost;
pub mod headless;
mod looks;
mod material;
mod normals;
mod openness;
mod orbit;
mod pick;
mod premultiplied;
mod present;
mod size_legend;
mod state;
mod studio;

pub use adapter::{Adapter, Quality, adapter};
pub use awaited::Unhurried;
pub use body::{Body, Pose};
pub use cursor::{Cursor, Dab};
pub use frame::{Extent, Placement, ViewFrame};
pub use ghost::Ghost;
pub use looks::{Legend, Looks, Mode, VoxelColour, Wipe};
pub use orbit::{Axis, FIELD_OF_VIEW, Orbit};
pub use pick::{Hit, Picker, RestShape, Target};
pub use size_legend::SizeLegend;
pub use state::extent;
pub use studio::{Backdrop, Studio};

use bevy::{prelude::*, render::RenderApp};

/// Draws bodies, in a window or into an image. Add it after Bevy's own plugins; insert a [`Quality`] before, or the
/// adapter's default is taken. Shaders come with the program: no file is needed beside it.
///
/// A camera is a `Camera3d` with an [`Orbit`]; give it [`Tonemapping::None`](bevy::core_pipeline::tonemapping::Tonemapping),
/// since the studio's shaders develop their own picture and leave the colours of legends alone.
pub struct ViewPlugin;

impl Plugin for ViewPlugin {
    fn build(&self, app: &mut App) {
        material::load_shaders(app);
        app.add_plugins(MaterialPlugin::<material::SurfaceMaterial>::default());
        present::add_systems(app);
        studio::build(app);
        orbit::build(app);
        size_legend::build(app);
        // Materials are bound to buffers made in the same frame.
        if let Some(render) = app.get_sub_app_mut(RenderApp) {
            material::order(render);
        }
    }

    fn finish(&self, app: &mut App) {
        // The adapter is known from here on.
        app.init_resource::<Quality>();
    }
}

/// When the view reads its components: change bodies, poses, looks and cameras before, in `Update`.
#[derive(SystemSet, Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ViewSystems {
    /// In `PostUpdate`, before transforms are propagated.
    Present,
}
