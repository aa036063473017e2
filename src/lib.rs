//! `homunculus`: warp a body or a picture until local size is proportional to importance.

pub mod app;
pub mod boundary;
pub mod certificate;
pub mod collision;
pub mod diagnostics;
pub mod edge;
pub mod error;
pub mod export;
pub mod film;
pub mod gallery;
pub mod importance;
pub mod reference;
pub mod scene;
pub mod schedule;
pub mod transfer;
pub mod voxel;

pub use error::{Error, Result};
