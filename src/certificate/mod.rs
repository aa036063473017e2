//! The certificate: no inverted element, no crossing, decided by exact predicates.

mod predicates;
mod surface;
mod tree;

pub use predicates::{Triangle, collinear, orientation, triangles_cross};
pub use surface::Surface;
pub use tree::{Bounds, Tree};
