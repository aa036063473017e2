//! States between two states.

use glam::{DVec2, Vec3A};
use rayon::prelude::*;

use super::CHUNK;

/// `(1 − t) a + t b` of places in the plane.
pub fn blend_places(a: &[DVec2], b: &[DVec2], t: f64) -> Vec<DVec2> {
    a.par_iter().zip(b).with_min_len(CHUNK).map(|(a, b)| a.lerp(*b, t)).collect()
}

/// `(1 − t) a + t b`.
pub fn blend(a: &[Vec3A], b: &[Vec3A], t: f32) -> Vec<Vec3A> {
    a.par_iter().zip(b).with_min_len(CHUNK).map(|(a, b)| *a + t * (*b - *a)).collect()
}
