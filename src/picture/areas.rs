//! How large each region was asked to be and has become.

use std::collections::BTreeMap;

use glam::{DVec2, UVec2};
use rayon::prelude::*;
use serde::Serialize;

use super::importance::Field;
use super::locate::{Affine, bounds};
use super::{FlatMesh, Picture};

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

/// Gives each pixel that a triangle overlaps, and the area of the overlap.
pub(crate) fn pieces(triangle: [DVec2; 3], size: UVec2, mut give: impl FnMut(usize, f64)) {
    let (low, high) = bounds(triangle.into_iter());
    let first = low.floor().max(DVec2::ZERO).as_uvec2();
    let last = high.ceil().max(DVec2::ZERO).as_uvec2().min(size);
    let mut row_piece = Vec::new();
    let mut piece = Vec::new();
    for y in first.y..last.y {
        // A strip of one pixel's height, then its squares.
        row_piece.clear();
        row_piece.extend(triangle);
        clip(&mut row_piece, |p| p.y - f64::from(y));
        clip(&mut row_piece, |p| f64::from(y + 1) - p.y);
        for x in first.x..last.x {
            piece.clear();
            piece.extend(&row_piece);
            clip(&mut piece, |p| p.x - f64::from(x));
            clip(&mut piece, |p| f64::from(x + 1) - p.x);
            let area = area(&piece);
            if area > 0.0 {
                give((y * size.x + x) as usize, area);
            }
        }
    }
}

/// Keeps the part of a convex polygon where `side` ≥ 0 (Sutherland & Hodgman 1974); `side` is affine.
fn clip(polygon: &mut Vec<DVec2>, side: impl Fn(DVec2) -> f64) {
    let count = polygon.len();
    for i in 0..count {
        let (a, b) = (polygon[i], polygon[(i + 1) % count]);
        let (sa, sb) = (side(a), side(b));
        if sa >= 0.0 {
            polygon.push(a);
        }
        if (sa > 0.0 && sb < 0.0) || (sa < 0.0 && sb > 0.0) {
            polygon.push(a.lerp(b, sa / (sa - sb)));
        }
    }
    polygon.drain(..count);
}

/// Area of a convex polygon of either orientation.
fn area(polygon: &[DVec2]) -> f64 {
    let Some(&origin) = polygon.first() else { return 0.0 };
    let doubled: f64 = polygon.windows(2).map(|e| (e[0] - origin).perp_dot(e[1] - origin)).sum();
    doubled.abs() / 2.0
}
