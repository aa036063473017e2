//! The vertex table of a GLB: one row for each vertex of the boundary, in order, then a row for each further combination of
//! texture coordinate and normal that corners of a vertex have. And which rows each part needs.

use std::collections::HashMap;
use std::ops::Range;

use super::normals::Smoothing;
use crate::boundary::Boundary;
use crate::boundary::source::{NONE, Part};

/// One row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Row {
    /// The boundary's vertex.
    pub vertex: u32,
    /// Its texture coordinate or [`NONE`].
    pub uv: u32,
    /// Its smoothing class, or [`NONE`] where no triangle uses the vertex.
    pub class: u32,
}

/// Rows, and the triangles of each part in terms of rows.
pub(crate) struct Table {
    /// All rows; the first are the boundary's vertices.
    pub rows: Vec<Row>,
    /// Parts with at least one triangle.
    pub parts: Vec<Slice>,
}

/// A part and its triangles.
pub(crate) struct Slice {
    /// Object and material.
    pub part: Part,
    /// Triangles, as indices of rows.
    pub triangles: Vec<[u32; 3]>,
    /// The rows this part is written with: its own where parts have each their own, else all.
    pub window: Range<usize>,
}

impl Table {
    /// The table of a boundary.
    pub fn new(boundary: &Boundary, smoothing: &Smoothing) -> Self {
        let source = &boundary.source;
        let count = boundary.positions.len();
        let mut rows: Vec<Row> = (0..count as u32).map(|vertex| Row { vertex, uv: NONE, class: NONE }).collect();
        let mut further: HashMap<Row, u32> = HashMap::new();
        let mut row_of = |row: Row| {
            let first = &mut rows[row.vertex as usize];
            if first.class == NONE {
                *first = row;
            }
            if *first == row {
                return row.vertex;
            }
            *further.entry(row).or_insert_with(|| {
                rows.push(row);
                rows.len() as u32 - 1
            })
        };
        let plain = [Part { object: NONE, material: NONE, extensions: None }];
        let parts: &[Part] = if source.parts.is_empty() { &plain } else { &source.parts };
        let mut slices: Vec<Slice> =
            parts.iter().map(|part| Slice { part: part.clone(), triangles: Vec::new(), window: 0..0 }).collect();
        let part_of_triangle = parts_of_triangles(boundary);
        for (index, triangle) in boundary.triangles.iter().enumerate() {
            let uv = |corner: usize| match source.triangle_corners.get(index) {
                Some(corners) if !source.corner_uvs.is_empty() => source.corner_uvs[corners[corner] as usize],
                _ => NONE,
            };
            let row = |corner: usize| Row {
                vertex: triangle[corner],
                uv: uv(corner),
                class: smoothing.classes[index][corner],
            };
            let part = part_of_triangle.get(index).copied().unwrap_or(0);
            slices[part as usize].triangles.push([row_of(row(0)), row_of(row(1)), row_of(row(2))]);
        }
        slices.retain(|slice| !slice.triangles.is_empty());
        let mut table = Self { rows, parts: slices };
        table.open_windows();
        table
    }

    /// Whether each object has rows of its own, so that it can be a mesh of its own.
    pub fn is_separable(&self) -> bool {
        self.parts
            .iter()
            .zip(self.parts.iter().skip(1))
            .all(|(a, b)| a.window == b.window || a.window.end <= b.window.start)
            && self
                .parts
                .iter()
                .zip(self.parts.iter().skip(1))
                .all(|(a, b)| a.part.object == b.part.object || a.window != b.window)
    }

    /// Gives each run of parts of one object that share rows its own window, if these come in order; else all rows to all.
    fn open_windows(&mut self) {
        let total = self.rows.len();
        let mut runs: Vec<(u32, Range<usize>)> = Vec::new();
        let mut run_of = Vec::new();
        for slice in &self.parts {
            let rows = || slice.triangles.iter().flatten().map(|&r| r as usize);
            let own = rows().min().unwrap_or(0)..rows().max().map_or(0, |m| m + 1);
            match runs.last_mut() {
                Some((object, run)) if *object == slice.part.object && own.start < run.end && run.start < own.end => {
                    *run = run.start.min(own.start)..run.end.max(own.end);
                }
                _ => runs.push((slice.part.object, own)),
            }
            run_of.push(runs.len() - 1);
        }
        let in_order = runs.windows(2).all(|pair| pair[0].1.end <= pair[1].1.start && (pair[0].0 <= pair[1].0));
        for (slice, &run) in self.parts.iter_mut().zip(&run_of) {
            // Rows that no triangle uses belong to the run before them, so that none is lost.
            let start = if run == 0 { 0 } else { runs[run].1.start };
            let end = runs.get(run + 1).map_or(total, |next| next.1.start);
            slice.window = if in_order { start..end } else { 0..total };
        }
    }
}

/// `[triangles]` part of each; empty for one part.
fn parts_of_triangles(boundary: &Boundary) -> Vec<u32> {
    let source = &boundary.source;
    if source.polygon_parts.is_empty() || source.triangle_corners.is_empty() {
        return Vec::new();
    }
    let of_corner = (0..source.polygons.len()).flat_map(|p| source.polygons.range(p).map(move |_| p));
    let of_corner: Vec<u32> = of_corner.map(|polygon| source.polygon_parts[polygon]).collect();
    source.triangle_corners.iter().map(|corners| of_corner[corners[0] as usize]).collect()
}
