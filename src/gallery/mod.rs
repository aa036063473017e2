//! STUB of the gallery.

use crate::boundary::Boundary;
use crate::{Error, Result};
use glam::DVec3;

/// STUB
pub fn list() -> Vec<&'static str> {
    vec!["hand"]
}

/// STUB
///
/// # Errors
/// Unknown names.
pub fn open(name: &str) -> Result<Boundary> {
    if name != "hand" {
        return Err(Error::input(format!("gallery:{name} does not exist")));
    }
    let p = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    Ok(Boundary::from_triangles(name, p.to_vec(), vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]))
}
