//! How many cells there may be, and what they cost.

use crate::{Error, Result, diagnostics::human_bytes};

/// Fewest cells along the longest axis: below 8 a limb is thinner than a cell.
pub const MIN_RESOLUTION: u32 = 8;

/// Most cells along the longest axis: 256³ fills a laptop's memory.
pub const MAX_RESOLUTION: u32 = 256;

/// Memory per inside cell, about: neighbour tables and entries of two operators (2 × 112 B and their coarser lattices),
/// corners, targets and rotations of the cell, vectors of the iteration, nine keyframes. Measured at 71,000 cells as peak
/// memory less the program's own. Too low here promises what swaps; too high frightens off what would run.
const BYTES_PER_CELL: f64 = 1300.0;

/// Memory a complex of so many inside cells takes to warp, in bytes, about.
pub fn memory_estimate(cells: f64) -> f64 {
    cells * BYTES_PER_CELL
}

/// Cells along the longest side of a picture, at most.
pub const MAX_FLAT_RESOLUTION: u32 = 512;

/// Whether so many cells along the longest axis can be had.
///
/// # Errors
/// Names the range, and the memory that a solid box of that resolution would take.
pub fn check_resolution(resolution: u32) -> Result<()> {
    check(resolution, MAX_RESOLUTION, "solid box", 3)
}

/// Refuses a resolution out of range for a picture.
///
/// # Errors
/// Names the range, and the memory that a full square of that resolution would take.
pub fn check_flat_resolution(resolution: u32) -> Result<()> {
    check(resolution, MAX_FLAT_RESOLUTION, "full square", 2)
}

/// Refuses what is not within `MIN_RESOLUTION..=most`; `full` is what has a cell at each place along so many axes.
fn check(resolution: u32, most: u32, full: &str, axes: i32) -> Result<()> {
    if (MIN_RESOLUTION..=most).contains(&resolution) {
        return Ok(());
    }
    let bytes = human_bytes(memory_estimate(f64::from(resolution).powi(axes)));
    Err(Error::input(format!(
        "resolution {resolution} is not within {MIN_RESOLUTION} to {most}: a {full} would take about {bytes} of memory"
    )))
}
