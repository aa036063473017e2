//! 3.2  **F**, the importance: the linear size factor asked for, > 0, 1 = keep.
//!
//! # Theory
//! The paper paints importance with a brush or reads it from a data set, on the boundary. Here it is a [`Stack`] of
//! [`Layer`]s over a base value, and a function of the boundary's surface: what a user can say in one way can be
//! corrected in another by a layer above. Everything blends in ln f, as "twice" and "half" are equally far from "keep".
//!
//! # Changes from the paper
//! The paper's importance is a value per boundary vertex. Meshes with large triangles have few vertices and the lattice
//! many cells, so spheres and pictures are evaluated at any [`Sample`] of the surface, and only what is known
//! per vertex is interpolated.
//!
//! # Practice
//! Each source of importance has a file of its own, which says what it means on a surface and in a picture. [`Stack::load`]
//! and [`Field::load`] read and check every file once; what they evaluate is a pure function of each sample or pixel, so
//! it is the same for any number of threads.

mod admission;
mod areas;
mod attribute;
mod colour;
mod colour_map;
pub mod field;
mod image;
mod layer;
pub mod plugin;
mod regions;
mod sphere;
mod spread;
mod stack;
mod table;
mod values;

pub use areas::{RegionArea, areas, median_error, worst};
pub use colour::colours;
pub use field::Field;
pub use layer::{Ask, CLAMP_MAX, CLAMP_MIN, IMAGE_RANGE, Layer, Offer, Offered, Range};
pub use sphere::falloff;
pub use spread::{Sampling, Spread, asked_sizes, cell_importance, node_importance, smoothed};
pub use stack::{Sample, Stack};
