//! 3.2  Voxelization: the boundary B becomes a lattice complex C = (V, E) and C_t = (V, T).
//!
//! # Theory
//! Every cell the surface touches is marked (conservative rasterization), the outside is flood-filled from the padded
//! grid's corner, everything that is not outside is inside. So holes smaller than a cell close, and neither winding nor
//! self-intersections of the input matter. Each inside cell is split into the six tetrahedra of the Kuhn subdivision
//! along its diagonal, the same in every cell, so neighbours conform; that gives seven edge directions.
//!
//! # Changes from the paper
//! The paper appends the edges of each cell without saying which; axis edges alone do not resist shear, so the
//! face and body diagonals of the Kuhn subdivision belong to E here.
//!
//! # Practice
//! All lattice coordinates are in cells (edge length 1); [`Grid`] converts to and from source units.

mod blend;
mod complex;
mod flat;
mod limits;
pub mod plugin;
mod rasterize;
mod welds;

pub use blend::{blend, blend_places};
pub use complex::{Complex, DIRECTIONS, Dimension, KUHN, KUHN_FLAT, NEIGHBOURS, opposite};
pub use flat::{Flat, Share, Shares};
pub use limits::{
    MAX_FLAT_RESOLUTION, MAX_RESOLUTION, MIN_RESOLUTION, check_flat_resolution, check_resolution, memory_estimate,
};
pub use rasterize::rasterize;
pub use welds::suspected_welds;

use glam::{DVec3, UVec3};

use crate::{Error, Result, boundary::Boundary};

/// Nodes per parallel task. Fixed, so that sums are split in the same places for any number of threads.
pub(crate) const CHUNK: usize = 2048;

/// Where the lattice lies in source space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    /// Source position of lattice corner (0, 0, 0).
    pub origin: DVec3,
    /// h, the edge length of a cell in source units, > 0.
    pub cell_size: f64,
    /// Number of cells along each axis, ≥ 1.
    pub cells: UVec3,
}

/// Room between the surface and the lattice's outer faces, in cells, so that rounding cannot put a vertex outside.
///
/// Larger wastes resolution; smaller than about 1e-6 meets the rounding of f32 at 256 cells.
const MARGIN: f64 = 1.0e-3;

impl Grid {
    /// The grid of `resolution` ≥ 1 cells along the longest axis of `boundary`, centred on it.
    ///
    /// # Errors
    /// A boundary without extent.
    pub fn around(boundary: &Boundary, resolution: u32) -> Result<Self> {
        let mut low = DVec3::INFINITY;
        let mut high = DVec3::NEG_INFINITY;
        for corner in boundary.triangles.iter().flatten() {
            let p = boundary.positions[*corner as usize];
            low = low.min(p);
            high = high.max(p);
        }
        let extent = high - low;
        let longest = extent.max_element();
        if !(longest.is_finite() && longest > 0.0) {
            return Err(Error::input(format!(
                "{}: the surface has no extent; all of its {} triangles lie in one point",
                boundary.name,
                boundary.triangles.len()
            )));
        }
        let cell_size = longest / (f64::from(resolution) - 2.0 * MARGIN);
        // The longest axis gives the resolution but for rounding, which must not add a cell.
        let most = DVec3::splat(f64::from(resolution));
        let cells = (extent / cell_size + 2.0 * MARGIN).ceil().max(DVec3::ONE).min(most);
        let origin = (low + high) * 0.5 - cells * (0.5 * cell_size);
        Ok(Self { origin, cell_size, cells: cells.as_uvec3() })
    }

    /// Source units to cells.
    pub fn lattice_from_source(&self, p: DVec3) -> DVec3 {
        (p - self.origin) / self.cell_size
    }

    /// Cells to source units.
    pub fn source_from_lattice(&self, p: DVec3) -> DVec3 {
        self.origin + p * self.cell_size
    }
}

/// B to C: rasterize, flood-fill, subdivide.
///
/// # Errors
/// As [`Grid::around`].
pub fn voxelize(boundary: &Boundary, resolution: u32) -> Result<Complex> {
    let grid = Grid::around(boundary, resolution)?;
    let inside = rasterize(boundary, &grid);
    Ok(Complex::from_cells(grid, &inside))
}
