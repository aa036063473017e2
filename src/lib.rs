//! `homunculus`: warp a body or a picture until local size is proportional to importance.

pub mod boundary;
pub mod error;
pub mod gallery;
pub mod importance;

pub use error::{Error, Result};
