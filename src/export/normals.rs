//! Normals of warped triangles, smooth where the input was smooth.
//!
//! Corners are sorted once, on the input, into *smoothing classes* which share a normal:
//!
//! - input with normals: corners at the same place with the same normal, up to [`SAME_NORMAL_DEGREES`]. Seams of texture coordinates stay smooth, hard edges hard;
//! - STL, which has one normal for each facet and says nothing of smoothness: corners at the same place whose facets form less
//!   than [`CREASE_DEGREES`];
//! - any other input: corners of the same vertex.
//!
//! A class's normal is the sum of its triangles' unit normals, weighted by the angle at the corner (Thürmer and Wüthrich 1998),
//! so that it does not depend on how polygons were triangulated.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

use crate::boundary::Boundary;
use crate::boundary::source::{NONE, Original};

/// Facets of an STL that form a larger angle meet in a hard edge. Scans and organic models bend less between neighbours,
/// boxes and cylinders' rims more; common modellers propose 30 to 60.
const CREASE_DEGREES: f64 = 40.0;

/// Normals of the input that differ by less are one: at seams, writers round them differently. A tenth would leave the rounding
/// of bytes visible as a crease after warping; ten times would smooth bevels that were meant flat.
const SAME_NORMAL_DEGREES: f32 = 1.0;

/// Facets around one vertex beyond which creases are not sought and all is smooth: the search is quadratic. Even finely
/// tessellated caps seldom have more.
const MAX_FACETS: usize = 64;

/// The smoothing classes of a boundary.
pub(crate) struct Smoothing {
    /// `[triangles]` class of each corner.
    pub classes: Vec<[u32; 3]>,
    /// How many classes.
    pub count: usize,
}

impl Smoothing {
    /// Sorts the corners of a boundary, at rest.
    pub fn new(boundary: &Boundary) -> Self {
        if !boundary.source.corner_normals.is_empty() {
            return Self::by_normal(boundary);
        }
        if matches!(boundary.source.original, Original::Stl(_)) {
            return Self::by_crease(boundary);
        }
        Self { classes: boundary.triangles.clone(), count: boundary.positions.len() }
    }

    fn by_normal(boundary: &Boundary) -> Self {
        let source = &boundary.source;
        let welded = boundary.welded();
        // Where, and which normal exactly; then, at each place, the first normals with their classes.
        let mut known: HashMap<(u32, Option<[u32; 3]>), u32> = HashMap::new();
        let mut leaders: HashMap<u32, Vec<(Vec3, u32)>> = HashMap::new();
        let mut count = 0;
        let least_cosine = SAME_NORMAL_DEGREES.to_radians().cos();
        let mut class = |triangle: usize, corner: usize| {
            let vertex = boundary.triangles[triangle][corner];
            let index =
                source.triangle_corners.get(triangle).map_or(NONE, |c| source.corner_normals[c[corner] as usize]);
            let normal = source.normals.get(index as usize).map(|&normal| normal + Vec3::ZERO);
            let place = if normal.is_some() { welded[vertex as usize] } else { vertex };
            *known.entry((place, normal.map(|n| n.to_array().map(f32::to_bits)))).or_insert_with(|| {
                let direction = normal.unwrap_or_default().normalize_or_zero();
                let here = leaders.entry(place).or_default();
                let near =
                    here.iter().find(|(leader, _)| leader.dot(direction) >= least_cosine).map(|&(_, class)| class);
                near.unwrap_or_else(|| {
                    if here.len() < MAX_FACETS {
                        here.push((direction, count));
                    }
                    count += 1;
                    count - 1
                })
            })
        };
        let classes = (0..boundary.triangles.len()).map(|t| [0, 1, 2].map(|c| class(t, c))).collect();
        Self { classes, count: count as usize }
    }

    fn by_crease(boundary: &Boundary) -> Self {
        let welded = boundary.welded();
        let facets: Vec<DVec3> = boundary.triangles.iter().map(|t| unit_normal(t, &boundary.positions)).collect();
        let mut around: Vec<Vec<(u32, u8)>> = vec![Vec::new(); boundary.positions.len()];
        for (triangle, corners) in boundary.triangles.iter().enumerate() {
            for corner in 0..3u8 {
                around[welded[corners[usize::from(corner)] as usize] as usize].push((triangle as u32, corner));
            }
        }
        let least_cosine = CREASE_DEGREES.to_radians().cos();
        let mut classes = vec![[0; 3]; boundary.triangles.len()];
        let mut count = 0;
        for corners in &around {
            let mut group: Vec<usize> = (0..corners.len()).collect();
            for i in 0..corners.len() {
                let is_crowd = corners.len() > MAX_FACETS;
                let cosine = |j: usize| facets[corners[i].0 as usize].dot(facets[corners[j].0 as usize]);
                for j in 0..if is_crowd { i.min(1) } else { i } {
                    let (from, to) = (group[i].max(group[j]), group[i].min(group[j]));
                    if from == to || !(is_crowd || cosine(j) >= least_cosine) {
                        continue;
                    }
                    // Only corners up to this one have been joined so far; in a crowd, none to this one.
                    let joined = if is_crowd { &mut group[i..=i] } else { &mut group[..=i] };
                    joined.iter_mut().filter(|g| **g == from).for_each(|g| *g = to);
                }
            }
            for (&(triangle, corner), &leader) in corners.iter().zip(&group) {
                classes[triangle as usize][usize::from(corner)] = count + leader as u32;
            }
            count += corners.len() as u32;
        }
        Self { classes, count: count as usize }
    }

    /// `[classes]` unit normals for positions of the vertices; +z where no triangle has an area.
    pub fn normals(&self, triangles: &[[u32; 3]], positions: &[DVec3]) -> Vec<Vec3> {
        let mut sums = vec![DVec3::ZERO; self.count];
        for (triangle, classes) in triangles.iter().zip(&self.classes) {
            let normal = unit_normal(triangle, positions);
            for corner in 0..3 {
                let [at, next, last] = [0, 1, 2].map(|i| positions[triangle[(corner + i) % 3] as usize]);
                sums[classes[corner] as usize] += normal * angle(next - at, last - at);
            }
        }
        sums.into_iter().map(|sum| sum.try_normalize().unwrap_or(DVec3::Z).as_vec3().normalize()).collect()
    }
}

/// The unit normal of a triangle, or zero.
pub(crate) fn unit_normal(triangle: &[u32; 3], positions: &[DVec3]) -> DVec3 {
    let [a, b, c] = triangle.map(|v| positions[v as usize]);
    let (ab, ac) = (b - a, c - a);
    // Scaled first, so that the product of tiny or huge sides neither vanishes nor overflows.
    let scale = ab.abs().max(ac.abs()).max_element();
    if scale > 0.0 { (ab / scale).cross(ac / scale).normalize_or_zero() } else { DVec3::ZERO }
}

/// The angle between two sides, 0..=π; 0 where one has no length.
fn angle(a: DVec3, b: DVec3) -> f64 {
    let (a, b) = (a.normalize_or_zero(), b.normalize_or_zero());
    if a == DVec3::ZERO || b == DVec3::ZERO { 0.0 } else { a.cross(b).length().atan2(a.dot(b)) }
}
