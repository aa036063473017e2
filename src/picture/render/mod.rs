//! 3.5  The warped picture: each output pixel takes the inverse map and filters what lies there.
//!
//! # Theory
//! A warped triangle's inverse map is affine; its Jacobian says which part of the picture an output pixel covers. Where
//! that is less than a pixel of the picture (magnified) a spline through the pixels is read once; where it is more
//! (minified) the output pixel is the mean of as many places as it covers pixels, which is the area's mean.
//! Filtering is done in linear light, premultiplied by alpha: transparent pixels lend their colour to nobody.
//!
//! # Practice
//! The lattice's outline is not the picture's: cells stand out beyond the body, or, where they are about as small as pixels,
//! cut into its smoothed edge. So the outermost triangles' maps go on for a few pixels, and what is seen there is
//! decided by the picture's alpha alone.
//! Rows are drawn in parallel and depend on nothing but the state: the result is the same for any number of threads.

mod canvas;
mod mark;
mod texels;

use glam::DVec2;
use image::{ImageBuffer, RgbaImage};
use rayon::prelude::*;

use super::locate::{Affine, Grid, Locator};
use super::{FlatMesh, Picture, Pixels};
use texels::{Texels, straight};

pub use canvas::{Canvas, MAX_DRAWN};
pub use mark::mark;
pub(super) use texels::dilated as seen;

/// How far the outermost triangles' maps go on, in pixels of the picture: the smoothed rim of an outline and the spline's
/// reach. Less shows the lattice's staircase along the outline; more would let bodies that touch draw over each other.
const REACH: f64 = 3.0;

/// Most places read for one output pixel along one axis; only a picture drawn at under 1/256 needs more.
const MAX_PLACES: f64 = 256.0;

/// A picture and its mesh, ready to be drawn in any number of states.
#[derive(Debug, Clone)]
pub struct Painter<'a> {
    texels: Texels,
    is_deep: bool,
    mesh: &'a FlatMesh,
    rest: Locator<'a>,
    /// Edges of one triangle only, and that triangle.
    rim: Vec<([u32; 2], u32)>,
}

/// Draws one state of a picture: see [`Painter`].
pub fn render(picture: &Picture, mesh: &FlatMesh, warped: &[DVec2], canvas: &Canvas) -> Pixels {
    Painter::new(picture, mesh).render(warped, canvas)
}

impl<'a> Painter<'a> {
    /// Takes 16 bytes for each pixel.
    pub fn new(picture: &Picture, mesh: &'a FlatMesh) -> Self {
        Self {
            texels: Texels::new(picture),
            is_deep: matches!(picture.pixels, Pixels::Sixteen(_)),
            mesh,
            rest: Locator::new(&mesh.rest, &mesh.triangles, 0.0),
            rim: mesh.boundary_edges(),
        }
    }

    /// The picture with the mesh's vertices at `warped` (`[vertices]`, pixels), as deep as it was read.
    pub fn render(&self, warped: &[DVec2], canvas: &Canvas) -> Pixels {
        let state = State::new(self, warped, canvas.scale);
        let width = canvas.size.x as usize;
        let colour = |row: usize, column: usize| {
            straight(self.pixel(&state, canvas, DVec2::new(column as f64 + 0.5, row as f64 + 0.5)))
        };
        if self.is_deep {
            let mut image = ImageBuffer::new(canvas.size.x, canvas.size.y);
            image.par_chunks_mut(4 * width).enumerate().for_each(|(row, line)| {
                for (column, pixel) in line.chunks_exact_mut(4).enumerate() {
                    pixel.copy_from_slice(&colour(row, column).map(|c| (c * 65535.0).round() as u16));
                }
            });
            Pixels::Sixteen(image)
        } else {
            let mut image = RgbaImage::new(canvas.size.x, canvas.size.y);
            image.par_chunks_mut(4 * width).enumerate().for_each(|(row, line)| {
                for (column, pixel) in line.chunks_exact_mut(4).enumerate() {
                    pixel.copy_from_slice(&colour(row, column).map(|c| (c * 255.0).round() as u8));
                }
            });
            Pixels::Eight(image)
        }
    }

    /// Light of the output pixel with this centre.
    fn pixel(&self, state: &State, canvas: &Canvas, centre: DVec2) -> [f32; 4] {
        let point = canvas.to_plane(centre);
        let found = state.find(point);
        let [across, down] = match &found {
            Some(map) => [map.linear.x_axis, map.linear.y_axis].map(|axis| axis / canvas.scale),
            None if state.is_near(point) => [DVec2::ZERO; 2],
            None => return [0.0; 4],
        };
        let centre_of = found.map(|map| map.at(point));
        let is_cut = centre_of.is_none_or(|place| {
            // Part of what the pixel covers may lie beyond the picture.
            let half = (across.abs() + down.abs()) / 2.0 - 1e-6;
            let size = self.texels.size.as_dvec2();
            (place - half).min_element() < 0.0 || (place + half - size).max_element() > 0.0
        });
        let (columns, width) = spread(across.length(), is_cut);
        let (rows, height) = spread(down.length(), is_cut);
        if columns * rows == 1 {
            return centre_of.map_or([0.0; 4], |place| self.light(place));
        }
        let mut sum = [0.0; 4];
        for row in 0..rows {
            for column in 0..columns {
                let part = |k: u32, n: u32| (f64::from(k) + 0.5) / f64::from(n) - 0.5;
                let offset = DVec2::new(part(column, columns) * width, part(row, rows) * height);
                let point = canvas.to_plane(centre + offset);
                if let Some(map) = state.find(point) {
                    let light = self.light(map.at(point));
                    (0..4).for_each(|c| sum[c] += light[c]);
                }
            }
        }
        sum.map(|s| s / (columns * rows) as f32)
    }

    /// Light at a place of the picture; none beyond it.
    fn light(&self, place: DVec2) -> [f32; 4] {
        let is_inside = place.cmpge(DVec2::ZERO).all() && place.cmple(self.texels.size.as_dvec2()).all();
        if is_inside { self.texels.at(place) } else { [0.0; 4] }
    }
}

/// How many places are read along an axis on which an output pixel covers `covered` pixels, and over what part of it.
///
/// The spline already has the width of a pixel, so the places spread over what is missing: variances add up.
fn spread(covered: f64, is_cut: bool) -> (u32, f64) {
    let places = (covered - 1e-6).ceil().clamp(1.0, MAX_PLACES);
    if is_cut {
        return (places.max(4.0) as u32, 1.0);
    }
    (places as u32, (1.0 - (covered * covered).recip()).max(0.0).sqrt())
}

/// The inverse map of one state.
struct State<'a> {
    painter: &'a Painter<'a>,
    warped: &'a [DVec2],
    inside: Locator<'a>,
    /// `[triangles]` warped ↦ rest, `None` for those without area.
    maps: Vec<Option<Affine>>,
    near_rim: Grid,
}

impl<'a> State<'a> {
    fn new(painter: &'a Painter<'a>, warped: &'a [DVec2], scale: f64) -> Self {
        let mesh = painter.mesh;
        let map = |t: usize| Affine::between(mesh.corners(warped, t), mesh.corners(&mesh.rest, t));
        let maps: Vec<_> = (0..mesh.triangles.len()).into_par_iter().map(map).collect();
        let boxes: Vec<_> = painter
            .rim
            .iter()
            .map(|&([a, b], triangle)| {
                let (a, b) = (warped[a as usize], warped[b as usize]);
                let reach = DVec2::splat(maps[triangle as usize].map_or(0.0, reach) + 1.0 / scale);
                (a.min(b) - reach, a.max(b) + reach)
            })
            .collect();
        let (low, high) = super::locate::bounds(boxes.iter().flat_map(|&(low, high)| [low, high]));
        let near_rim = Grid::new(&boxes, low, high);
        Self { painter, warped, inside: Locator::new(warped, &mesh.triangles, 1.0 / scale), maps, near_rim }
    }

    /// Warped ↦ rest around a point: of the triangle that holds it, else of the nearest of the outermost triangles.
    fn find(&self, point: DVec2) -> Option<Affine> {
        if let Some(triangle) = self.inside.find(point) {
            return self.maps[triangle];
        }
        let mut nearest: Option<(f64, Affine)> = None;
        for &edge in self.near_rim.near(point) {
            let ([a, b], triangle) = self.painter.rim[edge as usize];
            let Some(map) = self.maps[triangle as usize] else { continue };
            let (a, b) = (self.warped[a as usize], self.warped[b as usize]);
            let along = ((point - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            let beyond = point - a.lerp(b, along);
            let distance = beyond.length();
            let is_within = (map.linear * beyond).length() <= REACH;
            if is_within && nearest.is_none_or(|(least, _)| distance < least) {
                nearest = Some((distance, map));
            }
        }
        // What another triangle holds at rest is drawn where that is: a gap that opens shows nothing of the other side.
        nearest.map(|(_, map)| map).filter(|map| self.painter.rest.find(map.at(point)).is_none())
    }

    fn is_near(&self, point: DVec2) -> bool {
        self.inside.is_near(point) || !self.near_rim.near(point).is_empty()
    }
}

/// How far [`REACH`] may be in the warped plane: times the largest stretch of the triangle.
fn reach(map: Affine) -> f64 {
    let forward = map.linear.inverse();
    REACH * (forward.x_axis.length_squared() + forward.y_axis.length_squared()).sqrt()
}
