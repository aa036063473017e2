//! Where the drawn picture lies and how large it is.

use glam::{DVec2, IVec2, UVec2};

use super::super::locate::{Affine, Locator, bounds};
use super::super::{FlatMesh, Picture};
use crate::{Error, Result};

/// Most pixels that are drawn: 64 megapixels, 256 MB at 8 bits a channel.
pub const MAX_DRAWN: u64 = 64_000_000;

/// A rectangle of the plane and its resolution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Canvas {
    /// Upper left corner, pixels of the picture.
    pub low: IVec2,
    /// Size in output pixels, each at least 1.
    pub size: UVec2,
    /// Output pixels along one pixel of the picture, > 0.
    pub scale: f64,
}

impl Canvas {
    /// The picture's own rectangle.
    ///
    /// # Errors
    /// A scale that is not > 0 and finite, or more than [`MAX_DRAWN`] output pixels.
    pub fn of(picture: &Picture, scale: f64) -> Result<Self> {
        Self::over(DVec2::ZERO, picture.size.as_dvec2(), scale)
    }

    /// The picture's own rectangle, grown to hold its body in each of the states: one canvas for a whole animation.
    ///
    /// `states`: places `[vertices]` of the mesh, pixels.
    ///
    /// # Errors
    /// As [`Self::of`].
    pub fn around<'a>(
        picture: &Picture,
        mesh: &FlatMesh,
        states: impl IntoIterator<Item = &'a [DVec2]>,
        scale: f64,
    ) -> Result<Self> {
        let locator = Locator::new(&mesh.rest, &mesh.triangles, 0.0);
        let outline: Vec<_> = outline(picture).filter_map(|p| Some((p, locator.find(p)?))).collect();
        let (mut low, mut high) = (DVec2::ZERO, picture.size.as_dvec2());
        for state in states {
            let place = |&(p, triangle): &(DVec2, usize)| {
                let map = Affine::between(mesh.corners(&mesh.rest, triangle), mesh.corners(state, triangle))?;
                Some(map.at(p))
            };
            let (least, greatest) = bounds(outline.iter().filter_map(place));
            // One pixel beyond, as outlines are smoothed.
            low = low.min(DVec2::select(least.cmplt(DVec2::ZERO), (least - 1.0).floor(), DVec2::ZERO));
            let size = picture.size.as_dvec2();
            high = high.max(DVec2::select(greatest.cmpgt(size), (greatest + 1.0).ceil(), size));
        }
        Self::over(low, high, scale)
    }

    fn over(low: DVec2, high: DVec2, scale: f64) -> Result<Self> {
        if !(scale > 0.0 && scale.is_finite()) {
            return Err(Error::input(format!(
                "the scale {scale} is not greater than 0; 1 keeps the picture's resolution"
            )));
        }
        let size = ((high - low) * scale - 1e-9).ceil().max(DVec2::ONE);
        let pixels = size.x * size.y;
        let is_too_large = pixels > MAX_DRAWN as f64 || low.abs().max_element() > 1e9;
        if is_too_large {
            let smaller = (scale * (MAX_DRAWN as f64 / pixels).sqrt() * 100.0).floor() / 100.0;
            return Err(Error::input(format!(
                "the warped picture would be {} × {} pixels ({:.1} GB) at scale {scale}; pass a scale of at most {smaller}",
                size.x,
                size.y,
                pixels * 4.0 / 1e9
            )));
        }
        Ok(Self { low: low.as_ivec2(), size: size.as_uvec2(), scale })
    }

    /// Pixels of the picture ↦ output pixels.
    pub fn from_plane(&self, point: DVec2) -> DVec2 {
        (point - self.low.as_dvec2()) * self.scale
    }

    /// Output pixels ↦ pixels of the picture.
    pub fn to_plane(&self, point: DVec2) -> DVec2 {
        point / self.scale + self.low.as_dvec2()
    }
}

/// Corners of pixels where the body meets what is not the body.
fn outline(picture: &Picture) -> impl Iterator<Item = DVec2> {
    let UVec2 { x: width, y: height } = picture.size;
    let inside = move |x: i64, y: i64| {
        let is_there = x >= 0 && y >= 0 && x < i64::from(width) && y < i64::from(height);
        is_there && picture.domain[(y * i64::from(width) + x) as usize]
    };
    let corners = (0..=i64::from(height)).flat_map(move |y| (0..=i64::from(width)).map(move |x| (x, y)));
    corners
        .filter(move |&(x, y)| {
            let around = [(x - 1, y - 1), (x, y - 1), (x - 1, y), (x, y)];
            let count = around.iter().filter(|&&(i, j)| inside(i, j)).count();
            count > 0 && count < 4
        })
        .map(|(x, y)| DVec2::new(x as f64, y as f64))
}
