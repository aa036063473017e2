//! Importance from a map: on a surface through the texture coordinates, in a picture pixel by pixel.
//!
//! Texture coordinates have `v` pointing **down** from the picture's upper left corner, as in glTF and as
//! [`Boundary::vertex_uvs`] promises; readers of formats with `v` pointing up (OBJ, PLY) flip it when they read.
//! Coordinates outside 0..=1 repeat the picture; unlike a renderer's, the edges of a tile do not bleed into the
//! opposite edge, as a map of importance is no wallpaper.

use std::path::Path;

use glam::Vec2;

use super::field::Pixels;
use super::stack::{OnSurface, Place, Surface};
use super::{Ask, IMAGE_RANGE, Offer, Range, colour_map};
use crate::boundary::Boundary;
use crate::format::{Kind, Use};
use crate::picture::read;
use crate::{Error, Result};

/// Widest and tallest picture read; 8192² is 256 MB once decoded.
const MAX_SIDE: u32 = 8192;

/// A map on a surface.
#[derive(Debug)]
pub(super) struct Map {
    picture: Picture,
    /// `[triangles]`
    corner_uvs: Vec<Option<[Vec2; 3]>>,
    /// Importance of black and of white.
    range: (f64, f64),
}

/// The map through the texture coordinates: luminance becomes the range.
pub(super) fn on_surface(path: &Path, range: Option<Range>, surface: &mut Surface) -> Result<Map> {
    let Surface { boundary, reading, .. } = surface;
    let range = reading.admit_range(range.unwrap_or(IMAGE_RANGE), || path.display().to_string())?;
    let Some(corner_uvs) = corner_uvs(boundary) else {
        let sentence = format!(
            "{} has no texture coordinates, so a picture cannot be laid on it; unwrap the mesh or use --values",
            boundary.name
        );
        return Err(Error::in_file(path, sentence));
    };
    let picture = Picture::read(path)?;
    if corner_uvs.iter().all(Option::is_none) {
        reading.warnings.push(format!("{}: no triangle has texture coordinates", path.display()));
    }
    Ok(Map { picture, corner_uvs, range })
}

impl OnSurface for Map {
    fn over(&self, below: f64, boundary: &Boundary, place: &Place) -> f64 {
        let Some(uv) = place.uv(boundary, &self.corner_uvs) else { return below };
        let (luminance, opacity) = self.picture.at(uv);
        let value = self.range.0 + luminance * (self.range.1 - self.range.0);
        below + opacity * (value.ln() - below)
    }
}

/// A map as large as the picture: by luminance, or back along the colour map it was painted with.
pub(super) fn on_pixels(path: &Path, range: Option<Range>, pixels: &mut Pixels) -> Result<()> {
    let range = range.unwrap_or(IMAGE_RANGE);
    let (low, high) = pixels.reading.admit_range(range, || path.display().to_string())?;
    let decoded = read::decode(path, &read::file(path)?)?;
    pixels.check_size(path, decoded.pixels.size())?;
    let (values, taken) = colour_map::values(&decoded.pixels);
    pixels.reading.warnings.push(format!("{}: read as {taken}", path.display()));
    pixels.blend(|index, below| {
        let opacity = f64::from(decoded.pixels.wide(index)[3]) / 65535.0;
        let value = low + f64::from(values[index]) * (high - low);
        below + opacity * (value.ln() - below)
    });
    Ok(())
}

const ASK: Ask = Ask { name: "Picture", title: "Importance as a picture", of: Use::Source(Kind::Picture) };

/// In the window, of a body.
pub(super) const OF_BODY: Offer = Offer {
    name: "Picture…",
    hint: "Laid over the surface by its texture coordinates: black ×0.5, white ×2",
    title: "Importance as a picture",
    files: &[ASK],
};

/// In the window, of a picture.
pub(super) const OF_PICTURE: Offer =
    Offer { name: "Map…", hint: "A picture of the same size: black ×0.5, white ×2", ..OF_BODY };

/// A decoded picture.
#[derive(Debug, Clone)]
struct Picture {
    width: usize,
    height: usize,
    /// Row by row from the top: luminance and alpha, 0..=65535.
    texels: Vec<[u16; 2]>,
}

impl Picture {
    /// Decodes the file, whatever its extension says.
    fn read(path: &Path) -> Result<Self> {
        let reader = image::ImageReader::open(path).and_then(image::ImageReader::with_guessed_format);
        let mut reader = reader.map_err(|e| Error::reading(path, e))?;
        let mut limits = image::Limits::default();
        limits.max_image_width = Some(MAX_SIDE);
        limits.max_image_height = Some(MAX_SIDE);
        reader.limits(limits);
        let decoded = reader.decode().map_err(|e| {
            let hint = format!("give a PNG, JPEG or WebP of at most {MAX_SIDE} pixels a side");
            Error::in_file(path, format!("not a picture that can be read ({e}); {hint}"))
        })?;
        let decoded = decoded.into_luma_alpha16();
        let (width, height) = (decoded.width() as usize, decoded.height() as usize);
        Ok(Self { width, height, texels: decoded.pixels().map(|pixel| pixel.0).collect() })
    }

    /// Bilinear luminance and opacity, each 0..=1, at a texture coordinate (`v` down). Luminance is the mean of what is
    /// opaque, so transparent pixels do not darken their neighbours.
    fn at(&self, uv: Vec2) -> (f64, f64) {
        let (left, right, x) = neighbours(tile(uv.x), self.width);
        let (upper, lower, y) = neighbours(tile(uv.y), self.height);
        let mut luminance = 0.0;
        let mut opacity = 0.0;
        for (row, wy) in [(upper, 1.0 - y), (lower, y)] {
            for (column, wx) in [(left, 1.0 - x), (right, x)] {
                let [luma, alpha] = self.texels[row * self.width + column].map(|c| f64::from(c) / 65535.0);
                luminance += wx * wy * alpha * luma;
                opacity += wx * wy * alpha;
            }
        }
        if opacity > 0.0 { (luminance / opacity, opacity) } else { (0.0, 0.0) }
    }
}

/// The coordinate within its tile; 1 stays 1.
fn tile(t: f32) -> f64 {
    let t = f64::from(t);
    if (0.0..=1.0).contains(&t) { t } else { t - t.floor() }
}

/// The two texels whose centres enclose `t` in 0..=1, and the weight of the second.
fn neighbours(t: f64, texels: usize) -> (usize, usize, f64) {
    let last = texels.saturating_sub(1);
    let position = (t * texels as f64 - 0.5).clamp(0.0, last as f64);
    let first = position as usize;
    (first, (first + 1).min(last), position - first as f64)
}

/// `[triangles]` texture coordinates of the corners, `v` down; `None` for triangles that have none. A vertex on a seam
/// has several, one for each side.
fn corner_uvs(boundary: &Boundary) -> Option<Vec<Option<[Vec2; 3]>>> {
    let source = &boundary.source;
    if source.uvs.is_empty() {
        return None;
    }
    let uv_of_corner = |corner: u32| {
        let uv = *source.corner_uvs.get(corner as usize)?;
        source.uvs.get(uv as usize).copied().filter(|uv| uv.is_finite())
    };
    let corners = |[a, b, c]: &[u32; 3]| Some([uv_of_corner(*a)?, uv_of_corner(*b)?, uv_of_corner(*c)?]);
    let mut uvs: Vec<_> = source.triangle_corners.iter().map(corners).collect();
    uvs.resize(boundary.triangles.len(), None);
    Some(uvs)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Upper row black, white; lower row 0.2, transparent.
    fn quadrants() -> Picture {
        Picture { width: 2, height: 2, texels: vec![[0, 65535], [65535, 65535], [13107, 65535], [65535, 0]] }
    }

    fn upright(at: impl Fn(Vec2) -> (f64, f64)) -> bool {
        at(Vec2::new(0.25, 0.25)) == (0.0, 1.0)
            && at(Vec2::new(0.75, 0.25)) == (1.0, 1.0)
            && (at(Vec2::new(0.25, 0.75)).0 - 0.2).abs() < 1e-9
            && at(Vec2::new(0.75, 0.75)).1 == 0.0
    }

    #[test]
    fn v_points_down() {
        assert!(upright(|uv| quadrants().at(uv)));
    }

    #[test]
    fn sabotage_a_flip_is_seen() {
        assert!(!upright(|uv| quadrants().at(Vec2::new(uv.x, 1.0 - uv.y))));
        assert!(!upright(|uv| quadrants().at(Vec2::new(1.0 - uv.x, uv.y))));
    }

    #[test]
    fn blends_between_centres_and_not_across_edges() {
        let picture = quadrants();
        assert!((picture.at(Vec2::new(0.5, 0.0)).0 - 0.5).abs() < 1e-9);
        assert_eq!(picture.at(Vec2::new(0.0, 0.0)), (0.0, 1.0));
        assert_eq!(picture.at(Vec2::new(1.0, 0.0)), (1.0, 1.0));
        assert_eq!(picture.at(Vec2::new(1.25, -0.25)), picture.at(Vec2::new(0.25, 0.75)));
    }

    #[test]
    fn transparency_does_not_brighten() {
        let (luminance, opacity) = quadrants().at(Vec2::new(0.5, 0.75));
        assert!((luminance - 0.2).abs() < 1e-9 && (opacity - 0.5).abs() < 1e-9);
    }
}
