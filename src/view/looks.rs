//! What the surface shows, and the legend that says so.

use std::sync::Arc;

use bevy::prelude::*;

/// How a [`Body`](super::Body) is drawn.
#[derive(Component, Debug, Clone, Default, PartialEq)]
pub struct Looks {
    /// Which field, if any.
    pub mode: Mode,
    /// `[vertices]` importance f, > 0: for [`Mode::Importance`].
    pub importance: Option<Arc<Vec<f32>>>,
    /// `[vertices]` size achieved over size asked, > 0, 1 = reached: for [`Mode::Fidelity`].
    pub fidelity: Option<Arc<Vec<f32>>>,
    /// `[nodes]` of the complex, > 0: importance, or the size factor reached: for [`Mode::Voxels`].
    pub voxels: Option<Arc<Vec<f32>>>,
    /// Least and greatest value of the colour map, or `None` to take them from the values shown.
    pub range: Option<[f32; 2]>,
    /// Triangles of the boundary drawn red, because they cross others.
    pub marked: Option<Arc<Vec<u32>>>,
    /// Only one side of a line is drawn.
    pub wipe: Option<Wipe>,
}

/// Which field the surface shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Mode {
    /// None: the file's own colours, or studio grey.
    #[default]
    Plain,
    /// Size asked for, by a diverging map of ln f with light grey at 1.
    Importance,
    /// Size achieved over size asked, by another diverging map.
    Fidelity,
    /// The complex instead of the surface, as in Fig. 3.
    Voxels(VoxelColour),
}

/// What the complex is coloured by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum VoxelColour {
    /// Nothing.
    #[default]
    Plain,
    /// Size asked for.
    Importance,
    /// Size factor of the state shown at λ.
    Growth,
}

/// A vertical line on the screen with one body to either side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wipe {
    /// 0 = left, 1 = right edge of the picture.
    pub at: f32,
    /// Whether this body is what lies left of the line, else right of it.
    pub keeps_left: bool,
}

/// What colours mean.
#[derive(Debug, Clone, PartialEq)]
pub struct Legend {
    /// What is shown: "importance".
    pub title: &'static str,
    /// In which unit: "size factor".
    pub unit: &'static str,
    /// Value and sRGB colour, evenly spaced along the bar from its low to its high end.
    pub stops: Vec<(f32, [u8; 3])>,
    /// Place along the bar in 0..=1, and what to write there: `×2`.
    pub ticks: Vec<(f32, String)>,
}

impl Looks {
    /// The legend of what is shown; `None` where colours mean nothing.
    pub fn legend(&self) -> Option<Legend> {
        None
    }
}
