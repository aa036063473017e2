//! What numbers of single precision do to places: how far they move them, and which formats cannot say where a shape is.
//!
//! A GLB has single precision only. Of a statue in metres of a national grid (448262, 5411932) that leaves half a metre. So its
//! places are relative to [`Boundary::origin`](crate::boundary::Boundary::origin), which the nodes add again: what is certified has to be what comes out of that sum.

use std::path::Path;

use glam::DVec3;

use super::Surface;
use crate::error::{Error, Result};

/// A format that moves places by more than this part of the size is refused. 1e-5 of a metre is a hundredth of a millimetre,
/// printers cannot tell; a tenth would refuse shapes that are held well, ten times would let thin walls pass through each other.
const MOST_MOVED: f64 = 1e-5;

impl Surface<'_> {
    /// Whether single precision would be seen without an origin of its own.
    pub(super) fn is_far(&self) -> bool {
        self.boundary.origin() != DVec3::ZERO
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
        let Some((low, high)) = self.boundary.bounds_of_triangles(self.positions) else { return Ok(()) };
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
