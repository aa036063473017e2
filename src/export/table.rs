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

/// Parts of one object that share rows.
struct Runs {
    /// The object, and the rows from the first to the last.
    runs: Vec<(u32, Range<usize>)>,
    /// `[parts]` index into `runs`.
    of_part: Vec<usize>,
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

    /// Puts the rows of added vertices, and of further combinations, behind those of the object they belong to, so that objects
    /// which had rows of their own have them still: in each the vertices of the file come first, in their order.
    ///
    /// `own`: how many vertices the file has. Nothing happens where that is all, or objects share vertices.
    pub fn gather(&mut self, own: usize) {
        if own == self.rows.len() || self.rows.iter().all(|row| (row.vertex as usize) < own) {
            return;
        }
        let has_own = |slice: &Slice| slice.triangles.iter().flatten().any(|&row| (row as usize) < own);
        if !self.parts.iter().all(has_own) {
            return;
        }
        let runs = self.runs(|row| row < own);
        let mut run_of_row = vec![NONE; self.rows.len()];
        for (slice, &run) in self.parts.iter().zip(&runs.of_part) {
            for &row in slice.triangles.iter().flatten() {
                let slot = &mut run_of_row[row as usize];
                if *slot != NONE && *slot != run as u32 {
                    return;
                }
                *slot = run as u32;
            }
        }
        // What no triangle uses stays behind what comes before it.
        let mut last = 0;
        for slot in &mut run_of_row {
            *slot = if *slot == NONE { last } else { *slot };
            last = *slot;
        }
        if !run_of_row[..own].is_sorted() {
            return;
        }
        let mut order: Vec<u32> = (0..self.rows.len() as u32).collect();
        order.sort_by_key(|&row| run_of_row[row as usize]);
        let mut moved_to = vec![0; order.len()];
        (0..).zip(&order).for_each(|(new, &old)| moved_to[old as usize] = new);
        self.rows = order.iter().map(|&old| self.rows[old as usize]).collect();
        for row in self.parts.iter_mut().flat_map(|slice| &mut slice.triangles).flatten() {
            *row = moved_to[*row as usize];
        }
        self.open_windows();
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
        let Runs { runs, of_part } = self.runs(|_| true);
        let in_order = runs.windows(2).all(|pair| pair[0].1.end <= pair[1].1.start && (pair[0].0 <= pair[1].0));
        for (slice, &run) in self.parts.iter_mut().zip(&of_part) {
            // Rows that no triangle uses belong to the run before them, so that none is lost.
            let start = if run == 0 { 0 } else { runs[run].1.start };
            let end = runs.get(run + 1).map_or(total, |next| next.1.start);
            slice.window = if in_order { start..end } else { 0..total };
        }
    }

    /// Runs of parts of one object that share rows, of those that count.
    fn runs(&self, counts: impl Fn(usize) -> bool) -> Runs {
        let mut runs: Vec<(u32, Range<usize>)> = Vec::new();
        let mut of_part = Vec::new();
        for slice in &self.parts {
            let rows = || slice.triangles.iter().flatten().map(|&r| r as usize).filter(|&row| counts(row));
            let own = rows().min().unwrap_or(0)..rows().max().map_or(0, |m| m + 1);
            match runs.last_mut() {
                Some((object, run)) if *object == slice.part.object && own.start < run.end && run.start < own.end => {
                    *run = run.start.min(own.start)..run.end.max(own.end);
                }
                _ => runs.push((slice.part.object, own)),
            }
            of_part.push(runs.len() - 1);
        }
        Runs { runs, of_part }
    }
}

/// `[triangles]` part of each; empty for one part.
fn parts_of_triangles(boundary: &Boundary) -> Vec<u32> {
    let source = &boundary.source;
    if source.polygon_parts.is_empty() || source.triangle_corners.is_empty() {
        return Vec::new();
    }
    let part = |polygon: u32| source.polygon_parts[polygon as usize];
    source.polygons_of_triangles().into_iter().map(part).collect()
}
