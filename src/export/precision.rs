//! What numbers of single precision do to places: how far they move them, and what they are told relative to.
//!
//! A GLB has single precision only. Of a statue in metres of a national grid (448262, 5411932) that leaves half a metre. So its
//! places are relative to an [`origin`] near the shape, which the nodes add again: what is certified has to be what comes out of
//! that sum, which [`rounded`] gives.

use std::path::Path;

use glam::DVec3;

use super::Surface;
use crate::boundary::Boundary;
use crate::error::{Error, Result};

/// Places are told relative to an origin of their own where the shape is further from that of the file than this many of its own
/// sizes. Single precision moves nothing by more than 1e-6 of the size up to there, what no viewer shows. A tenth would give
/// ordinary models a translation they had not; ten times would let rounding be seen.
const FAR_FROM_ORIGIN: f64 = 16.0;

/// A format that moves places by more than this part of the size is refused. 1e-5 of a metre is a hundredth of a millimetre,
/// printers cannot tell; a tenth would refuse shapes that are held well, ten times would let thin walls pass through each other.
const MOST_MOVED: f64 = 1e-5;

/// What positions in files of single precision are relative to: zero, or a place near the shape where that is so far out that
/// single precision would be seen. Each coordinate is a number of single precision too.
///
/// It is that of the boundary at rest, so all frames of a growth have one. Vertices of no triangle do not count.
pub fn origin(boundary: &Boundary) -> DVec3 {
    let Some((low, high)) = bounds(boundary, &boundary.positions) else { return DVec3::ZERO };
    let size = (high - low).max_element();
    let reach = low.abs().max(high.abs()).max_element();
    if !(size > 0.0 && size.is_finite() && reach > FAR_FROM_ORIGIN * size) {
        return DVec3::ZERO;
    }
    // Few digits: a power of two not above the size is its unit.
    let unit = size.log2().floor().exp2();
    let near = ((low + high) * 0.5 / unit).round() * unit;
    let single = near.as_vec3().as_dvec3();
    if unit > 0.0 && single.is_finite() { single } else { DVec3::ZERO }
}

/// Positions as a GLB holds them, for one who adds translation and position in double precision: what to certify. They are written
/// again to the bit, in GLB, OBJ, PLY and OFF alike.
pub fn rounded(boundary: &Boundary, positions: &[DVec3]) -> Vec<DVec3> {
    let origin = origin(boundary);
    positions.iter().map(|&p| origin + (p - origin).as_vec3().as_dvec3()).collect()
}

/// Lowest and highest corner of what triangles use.
fn bounds(boundary: &Boundary, positions: &[DVec3]) -> Option<(DVec3, DVec3)> {
    let mut places = boundary.triangles.iter().flatten().filter_map(|&v| positions.get(v as usize));
    let first = *places.next()?;
    Some(places.fold((first, first), |(low, high), &p| (low.min(p), high.max(p))))
}

impl Surface<'_> {
    /// Whether single precision would be seen without an origin of its own.
    pub(super) fn is_far(&self) -> bool {
        origin(self.boundary) != DVec3::ZERO
    }

    /// What only formats with single precision need: each coordinate, relative to an origin, within its range and precision.
    pub(super) fn check_single(&self, origin: DVec3, path: &Path) -> Result<()> {
        let too_far = |p: &DVec3| (*p - origin).abs().max_element() > f64::from(f32::MAX);
        if let Some(vertex) = self.positions.iter().position(too_far) {
            return Err(Error::in_file(
                path,
                format!("vertex {vertex} is further out than the format can say; write .obj instead"),
            ));
        }
        let Some((low, high)) = bounds(self.boundary, self.positions) else { return Ok(()) };
        let used = self.boundary.triangles.iter().flatten().map(|&v| self.positions[v as usize] - origin);
        let moved = used.map(|p| (p - p.as_vec3().as_dvec3()).abs().max_element()).fold(0.0, f64::max);
        let size = (high - low).max_element();
        if moved <= MOST_MOVED * size {
            return Ok(());
        }
        let format = path.extension().map_or_else(String::new, |e| e.to_string_lossy().to_uppercase());
        let others = if format == "GLB" { ".obj or .ply" } else { ".obj, .ply or .glb" };
        Err(Error::in_file(
            path,
            format!(
                "the single precision of {format} would move vertices by up to {moved:.1e} in units of the input, so far is it from \
                 the origin for its size of {size:.1e}; write {others} instead"
            ),
        ))
    }
}
