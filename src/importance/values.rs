//! Importance from a table of vertices.

use std::path::Path;

use super::stack::{OfVertices, Surface};
use super::table::{has_column, importance_of, rows, vertex_of};
use super::{Ask, Layer, Offer, field};
use crate::Result;
use crate::format::Use;

/// The table's, for the vertices that it lists.
pub(super) fn on_surface(path: &Path, surface: &mut Surface) -> Result<OfVertices> {
    let vertices = surface.boundary.positions.len();
    let mut found = vec![None; vertices];
    let mut first_row = vec![0; vertices];
    for row in rows(path, "vertex", "importance")? {
        let vertex = vertex_of(path, &row, &mut first_row)?;
        found[vertex] = importance_of(path, &row, &mut surface.reading.admission)?;
    }
    Ok(OfVertices::new(found))
}

/// Pictures have no vertices.
pub(super) fn on_pixels() -> Result<()> {
    Err(field::no_vertices())
}

/// In the window.
pub(super) const OFFER: Offer = Offer {
    name: "Table of values…",
    hint: "CSV: vertex,importance; for a built-in model region,importance",
    title: "Importance of vertices or regions",
    files: &[Ask { name: "Table", title: "Importance of vertices or regions", of: Use::Table }],
};

impl Layer {
    /// The table of what a built-in model's regions are worth, if this layer is one: it has a column `region`.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn table_of_regions(&self) -> Result<Option<&Path>> {
        match self {
            Self::Values { path } => Ok(has_column(path, "region")?.then_some(path)),
            _ => Ok(None),
        }
    }
}
