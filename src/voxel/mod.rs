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

mod complex;
mod rasterize;
mod welds;

pub use complex::{Complex, DIRECTIONS, KUHN, NEIGHBOURS, opposite};
pub use rasterize::rasterize;
pub use welds::suspected_welds;

use glam::{DVec3, UVec3};

use crate::{Error, Result, boundary::Boundary};

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

/// Cells along the longest axis that this program accepts.
///
/// Below 4 nothing of a shape is left; above 256 the lattice of a solid block outgrows a laptop's memory.
pub const RESOLUTIONS: std::ops::RangeInclusive<u32> = 4..=256;

/// Room between the surface and the lattice's outer faces, in cells, so that rounding cannot put a vertex outside.
///
/// Larger wastes resolution; smaller than about 1e-6 meets the rounding of f32 at 256 cells.
const MARGIN: f64 = 1.0e-3;

impl Grid {
    /// The grid of `resolution` cells along the longest axis of `boundary`, centred on it.
    ///
    /// # Errors
    /// A resolution outside [`RESOLUTIONS`], or a boundary without extent.
    pub fn around(boundary: &Boundary, resolution: u32) -> Result<Self> {
        if !RESOLUTIONS.contains(&resolution) {
            return Err(Error::input(format!(
                "resolution {resolution} is outside {}..={}; a solid block of it would take about {}",
                RESOLUTIONS.start(),
                RESOLUTIONS.end(),
                human_bytes(memory_of_block(resolution)),
            )));
        }
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
        let cells = (extent / cell_size + 2.0 * MARGIN).ceil().max(DVec3::ONE);
        let origin = (low + high) * 0.5 - cells * (0.5 * cell_size);
        Ok(Self { origin, cell_size, cells: cells.as_uvec3().min(UVec3::splat(resolution)) })
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

/// Bytes a solid block of `resolution`³ cells would take in the solver: what to tell who asks for too much.
pub fn memory_of_block(resolution: u32) -> f64 {
    f64::from(resolution).powi(3) * BYTES_PER_CELL
}

/// Bytes of solver state per cell of a solid domain: neighbour and weight tables of two operators (2 × 112 and their
/// coarser levels), cell corners, vectors of the iteration, film keyframes. Measured, rounded up.
pub const BYTES_PER_CELL: f64 = 900.0;

/// `1234567890.0` → `1.1 GiB`.
pub fn human_bytes(bytes: f64) -> String {
    const UNITS: [&str; 6] = ["B", "KiB", "MiB", "GiB", "TiB", "PiB"];
    let mut value = bytes;
    let mut unit = 0;
    while value >= 1024.0 && unit + 1 < UNITS.len() {
        value /= 1024.0;
        unit += 1;
    }
    format!("{value:.1} {}", UNITS[unit])
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
