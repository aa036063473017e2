//! `homunculus`: warp a body or a picture until local size is proportional to importance.

pub mod app;
pub mod boundary;
pub mod diagnostics;
pub mod error;
pub mod export;
pub mod gallery;
pub mod importance;
pub mod scene;
pub mod schedule;

pub use error::{Error, Result};
