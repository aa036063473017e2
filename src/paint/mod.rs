//! 3.2  Importance by hand: strokes and fills over the layers of a scene, each of which can be taken back.
//!
//! # Theory
//! Painting happens in ln f at the boundary's vertices, over what the scene's [layers](crate::importance::Layer) say
//! there. What the hand adds is kept as the difference to the layers, so that between vertices the layers keep all their
//! detail and only the difference is interpolated.
//!
//! A stroke has a strength that it reaches and does not exceed, however often it passes over a place: what counts at a
//! vertex is the greatest weight of all its dabs. So a stroke does not depend on how many dabs the pointer made of it.
//!
//! # Practice
//! A [`Painting`] is at any time what replaying its edits over its layers gives, to the bit. Undo puts back the values
//! that were there; it computes nothing.

mod apply;
mod canvas;
mod edit;
mod ground;
mod painting;

pub use canvas::Canvas;
pub use edit::{Action, Axis, Brush, Dab, Edit, Falloff, Fill};
pub use ground::{Ground, PaintedPicture};
pub use painting::{Painting, Under};

use crate::{Result, boundary::Boundary, importance::Stack};

/// `[vertices]` what a scene's strokes add to ln f over its layers.
///
/// # Errors
/// Names the stroke, the value and its range, or the region that is not there.
pub fn differences(boundary: &Boundary, stack: &Stack, strokes: &[Edit]) -> Result<Vec<f64>> {
    let canvas = Canvas::new(boundary);
    for (index, edit) in strokes.iter().enumerate() {
        edit.check(index, &canvas)?;
    }
    let under: Vec<f64> = stack.at_vertices(boundary).iter().map(|f| f64::from(*f).ln()).collect();
    let painted = apply::replay(&canvas, &under, strokes);
    Ok(painted.iter().zip(&under).map(|(painted, under)| painted - under).collect())
}
