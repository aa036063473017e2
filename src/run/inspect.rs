//! What would be solved.

use std::sync::Arc;

use super::outcome::{DomainSummary, InputSummary, domain_summary, input_summary};
use crate::{
    Result,
    boundary::Boundary,
    certificate::Shell,
    transfer::{Binding, flat_boundary},
    voxel::{Flat, check_flat_resolution, check_resolution, suspected_welds, voxelize},
};

/// What is in a boundary and what would be voxelized.
///
/// # Errors
/// As [`solve`](super::solve()).
pub fn inspect(boundary: &Boundary, resolution: u32) -> Result<(InputSummary, DomainSummary)> {
    check_resolution(resolution)?;
    let complex = voxelize(boundary, resolution)?;
    let shell = Shell::boundary(boundary, Arc::new(Binding::new(boundary, &complex)), &complex);
    let welds = suspected_welds(boundary, &boundary.welded(), &complex);
    Ok((input_summary(boundary, shell.inherited()), domain_summary(&complex, resolution, welds)))
}

/// The mesh a picture would be drawn on, what it is, and what would be voxelized. Importance and regions are not needed.
///
/// # Errors
/// As [`solve`](super::solve()).
pub fn inspect_picture(picture: &Flat, resolution: u32) -> Result<(Boundary, InputSummary, DomainSummary)> {
    check_flat_resolution(resolution)?;
    let complex = picture.lattice(resolution)?;
    let boundary = flat_boundary(&picture.name, &complex, picture.size);
    // The lattice's own triangles cross nowhere.
    let input = input_summary(&boundary, 0);
    Ok((boundary, input, domain_summary(&complex, resolution, 0)))
}
