//! How large each region of a picture was asked to be and has become.

use std::collections::BTreeMap;

use glam::DVec2;
use rayon::prelude::*;
use serde::Serialize;

use super::field::Field;
use crate::picture::{Affine, FlatMesh, Picture, pieces};

/// Triangles whose sums are added together: fixed, so that the result is the same for any number of threads.
const CHUNK: usize = 1024;

/// Area of one region.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RegionArea {
    /// Its name, or its id where it has none.
    pub name: String,
    /// Σ f² over its pixels of the domain, pixels.
    pub asked: f64,
    /// Area of its pixels' images, pixels.
    pub achieved: f64,
}

impl RegionArea {
    /// |achieved / asked − 1|.
    pub fn error(&self) -> f64 {
        (self.achieved / self.asked - 1.0).abs()
    }
}

/// Asked and achieved area of each region of the field that has pixels in the domain, in order of the ids.
///
/// Each pixel's image is measured exactly: its square is cut by the triangles at rest, and each piece grows by its
/// triangle's Jacobian determinant. `warped`: `[vertices]` of the mesh, pixels. Empty without regions.
pub fn areas(field: &Field, picture: &Picture, mesh: &FlatMesh, warped: &[DVec2]) -> Vec<RegionArea> {
    let Some(regions) = &field.regions else { return Vec::new() };
    let mut asked: BTreeMap<u32, f64> = BTreeMap::new();
    let region_of = |pixel: usize| Some(regions.of_pixel[pixel]).filter(|r| picture.domain[pixel] && *r != u32::MAX);
    for pixel in 0..picture.domain.len() {
        if let Some(region) = region_of(pixel) {
            *asked.entry(region).or_default() += f64::from(field.values[pixel]).powi(2);
        }
    }
    let of_chunk = |triangles: &[[u32; 3]]| {
        let mut sums = vec![0.0; regions.names.len()];
        for corners in triangles {
            let (rest, warped) = (corners.map(|v| mesh.rest[v as usize]), corners.map(|v| warped[v as usize]));
            let Some(map) = Affine::between(rest, warped) else { continue };
            let growth = map.linear.determinant().abs();
            pieces(rest, picture.size, |pixel, area| {
                if let Some(region) = region_of(pixel) {
                    sums[region as usize] += growth * area;
                }
            });
        }
        sums
    };
    let chunks: Vec<Vec<f64>> = mesh.triangles.par_chunks(CHUNK).map(of_chunk).collect();
    let achieved = |region: u32| chunks.iter().map(|sums| sums[region as usize]).sum();
    let area = |(region, asked)| RegionArea {
        name: regions.names[region as usize].clone(),
        asked,
        achieved: achieved(region),
    };
    asked.into_iter().map(area).collect()
}

/// The region that misses its area most.
pub fn worst(areas: &[RegionArea]) -> Option<&RegionArea> {
    areas.iter().max_by(|a, b| a.error().total_cmp(&b.error()))
}

/// The median of [`RegionArea::error`]; the mean of the two in the middle of an even number. 0 without regions.
pub fn median_error(areas: &[RegionArea]) -> f64 {
    let mut errors: Vec<f64> = areas.iter().map(RegionArea::error).collect();
    errors.sort_by(f64::total_cmp);
    let middle = errors.len() / 2;
    match errors.len() {
        0 => 0.0,
        n if n % 2 == 1 => errors[middle],
        _ => (errors[middle - 1] + errors[middle]) / 2.0,
    }
}
