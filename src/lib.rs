//! `homunculus`: warp a body or a picture until local size is proportional to importance.

pub mod boundary;
pub mod certificate;
pub mod collision;
pub mod edge;
pub mod error;
pub mod importance;
pub mod voxel;

pub use error::{Error, Result};
