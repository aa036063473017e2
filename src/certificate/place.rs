//! Where a state is faulty, as triangles of the boundary: what a picture marks.
//!
//! # Theory
//! Faults are found on the complex as well as on the surface it carries. A crossing pair of the surface is two
//! triangles of it. A crossing pair of the skin, an inverted element and a solid within another one are shown by the
//! triangles whose corners lie in the cells concerned.

use glam::{DVec3, Vec3A};

use super::{Checked, Shell, elements, enclosed_solids};
use crate::{
    boundary::Boundary,
    transfer::CellIndex,
    voxel::{Complex, Dimension},
};

/// Which cells the triangles of a boundary lie in; made once for a complex.
#[derive(Debug, Clone)]
pub struct Places {
    /// `[triangles]` cells of the corners; `u32::MAX` outside of the complex.
    cells: Vec<[u32; 3]>,
}

impl Places {
    /// Locates the boundary in the complex made from it.
    pub fn new(boundary: &Boundary, complex: &Complex) -> Self {
        let index = CellIndex::new(complex);
        let locate = |p: &DVec3| index.locate(complex.grid.lattice_from_source(*p)).unwrap_or(u32::MAX);
        let of_vertex: Vec<u32> = boundary.positions.iter().map(locate).collect();
        Self { cells: boundary.triangles.iter().map(|t| t.map(|v| of_vertex[v as usize])).collect() }
    }

    /// The triangles of the boundary that are faulty in a state, rising. `surfaces` as for [`certify`](super::certify).
    ///
    /// Empty exactly where the state is certified, unless a fault lies where no triangle has a corner, or the outline
    /// of a picture's mesh crosses itself where that of its cells does not.
    pub fn faulty<'a>(&self, complex: &Complex, surfaces: impl Into<Checked<'a>>, positions: &[Vec3A]) -> Vec<u32> {
        let surfaces = surfaces.into();
        let mut is_bad = vec![false; complex.cells.len()];
        for cell in elements::inverted_cells(complex, positions) {
            is_bad[cell] = true;
        }
        let enclosed = enclosed_solids(complex, positions);
        if !enclosed.is_empty() {
            for (bad, solid) in is_bad.iter_mut().zip(&complex.solid) {
                *bad |= enclosed.contains(solid);
            }
        }
        for (s, t) in surfaces.skin.crossings(positions) {
            for face in [s, t] {
                is_bad[complex.cell_of_face[face as usize] as usize] = true;
            }
        }
        let mut faulty: Vec<u32> = (0..self.cells.len() as u32)
            .filter(|&t| self.cells[t as usize].iter().any(|&c| is_bad.get(c as usize).is_some_and(|bad| *bad)))
            .collect();
        if let Some(written) = surfaces.written {
            match complex.dimension {
                // Crossings of a picture's outline are lines, not triangles.
                Dimension::Two => faulty.extend(written.inverted(positions)),
                Dimension::Three => faulty.extend(written.crossings(positions).into_iter().flat_map(|(s, t)| [s, t])),
            }
        }
        faulty.sort_unstable();
        faulty.dedup();
        faulty
    }

    /// The same to be marked in a drawing: of a picture with as many cells around its crossings as it takes to be seen.
    pub fn to_be_seen<'a>(&self, complex: &Complex, surfaces: impl Into<Checked<'a>>, positions: &[Vec3A]) -> Vec<u32> {
        let surfaces = surfaces.into();
        let mut faulty = self.faulty(complex, surfaces, positions);
        if complex.dimension == Dimension::Two {
            faulty.extend(around_crossings(complex, surfaces.skin, positions));
            faulty.sort_unstable();
            faulty.dedup();
        }
        faulty
    }
}

/// A mark is seen when it is as wide as one of so many cells along the longest side.
const SEEN: u32 = 64;

/// Triangles of a picture's mesh where its outline crosses itself in a state, with as many cells around as it takes to
/// be seen.
fn around_crossings(complex: &Complex, skin: &Shell, positions: &[Vec3A]) -> Vec<u32> {
    let faces = skin.crossings(positions).into_iter().flat_map(|(s, t)| [s, t]);
    let mut cells: Vec<u32> = faces.map(|face| complex.cell_of_face[face as usize]).collect();
    for _ in 0..complex.grid.cells.max_element() / SEEN {
        let corners = cells.iter().flat_map(|&cell| complex.corners[cell as usize]);
        cells = corners.flat_map(|node| complex.cells_around[node as usize]).filter(|&c| c != u32::MAX).collect();
        cells.sort_unstable();
        cells.dedup();
    }
    // The halved lattice has eight triangles in each cell, cell by cell.
    cells.into_iter().flat_map(|cell| 8 * cell..8 * cell + 8).collect()
}
