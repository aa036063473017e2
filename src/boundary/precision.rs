//! What numbers of single precision are relative to.

use glam::DVec3;

use super::Boundary;

/// Places are told relative to an origin of their own where the shape is further from that of the file than this many of its own
/// sizes. Single precision moves nothing by more than 1e-6 of the size up to there, what no viewer shows. A tenth would give
/// ordinary models a translation they had not; ten times would let rounding be seen.
const FAR_FROM_ORIGIN: f64 = 16.0;

impl Boundary {
    /// What places in files of single precision are relative to: zero, or a place near the shape where that is so far out that
    /// single precision would be seen. Each coordinate is a number of single precision too.
    ///
    /// It is that of the boundary at rest, so all frames of a growth have one. Vertices of no triangle do not count.
    pub fn origin(&self) -> DVec3 {
        let Some((low, high)) = self.bounds_of_triangles(&self.positions) else { return DVec3::ZERO };
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

    /// Positions of its vertices as a file of single precision holds them, for one who adds what they are relative to in double
    /// precision: what to certify. They are written to the bit in GLB and PLY, and again when they come from there; OBJ and OFF
    /// have the same digits, of which readers make single or double precision.
    pub fn rounded(&self, positions: &[DVec3]) -> Vec<DVec3> {
        let origin = self.origin();
        positions.iter().map(|&p| rounded(p, origin)).collect()
    }

    /// Lowest and highest corner of what triangles use, with the vertices somewhere else.
    pub(crate) fn bounds_of_triangles(&self, positions: &[DVec3]) -> Option<(DVec3, DVec3)> {
        let mut places = self.triangles.iter().flatten().filter_map(|&v| positions.get(v as usize));
        let first = *places.next()?;
        Some(places.fold((first, first), |(low, high), &p| (low.min(p), high.max(p))))
    }
}

/// A place as single precision holds it, relative to an origin.
pub(crate) fn rounded(p: DVec3, origin: DVec3) -> DVec3 {
    let single = (p - origin).as_vec3().as_dvec3();
    // Zeros keep their sign.
    if origin == DVec3::ZERO { single } else { origin + single }
}
