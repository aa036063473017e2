//! 3.2  **F** of a picture: importance per pixel, the linear size factor asked for.
//!
//! As on bodies, importance is layers over a base value that blend in ln f (see [`crate::importance`]): discs, pictures of
//! the same size read as maps, and regions with values. A statistic shall become area, so `per_area` takes the square root
//! of value over area, and scales it so that all regions together keep theirs.

use std::path::Path;

use glam::{DVec2, UVec2};
use rayon::prelude::*;

use super::admission::Reading;
use super::{Layer, regions};
use crate::picture::{Picture, read};
use crate::{Error, Result};

/// Importance of each pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// The picture's width and height.
    pub size: UVec2,
    /// `[height × width]` importance, > 0 and finite, row by row from the top.
    pub values: Vec<f32>,
    /// The regions of the last layer that has some.
    pub regions: Option<Regions>,
    /// Sentences for the user: how maps were read, what was clamped, what is extreme.
    pub warnings: Vec<String>,
    /// How many values `clamp` changed or left out.
    pub clamped: usize,
}

/// Which pixel belongs to which region.
#[derive(Debug, Clone, PartialEq)]
pub struct Regions {
    /// `[regions]` the value in the picture of ids, rising.
    pub ids: Vec<u32>,
    /// `[regions]` the table's `name`, or the id in digits.
    pub names: Vec<String>,
    /// `[height × width]` index of the region, `u32::MAX` for none.
    pub of_pixel: Vec<u32>,
}

impl Field {
    /// Reads and checks the layers and evaluates them for each pixel. Relative paths are taken from `scene_dir`.
    ///
    /// # Errors
    /// Names the file, the row, the value and what to do about it: values that are ≤ 0 or not finite (unless `clamp`),
    /// pictures of another size, tables with unknown, repeated or missing regions.
    pub fn load(layers: &[Layer], base: f32, clamp: bool, picture: &Picture, scene_dir: &Path) -> Result<Self> {
        let mut pixels = Pixels::new(base, clamp, picture)?;
        layers.iter().try_for_each(|layer| layer.within(scene_dir).on_pixels(&mut pixels))?;
        Ok(pixels.finish())
    }

    /// Regions and values that are in memory, over a base value; the names stand for files in messages.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub fn of_regions(
        picture: &Picture,
        base: f32,
        ids: (&str, &[u8]),
        values: (&str, &[u8]),
        per_area: bool,
    ) -> Result<Self> {
        let mut pixels = Pixels::new(base, false, picture)?;
        let (ids, decoded) = (Path::new(ids.0), read::decode(Path::new(ids.0), ids.1)?);
        regions::set(&mut pixels, (ids, &decoded.pixels), (Path::new(values.0), values.1), per_area)?;
        Ok(pixels.finish())
    }

    /// Importance of a rectangle (pixels, `low` < `high`): the root of the mean f² over the parts of the domain's pixels
    /// in it, so that areas add up; `None` where the domain has none there.
    pub fn over(&self, domain: &[bool], low: DVec2, high: DVec2) -> Option<f32> {
        let first = low.floor().max(DVec2::ZERO).as_uvec2();
        let last = high.ceil().max(DVec2::ZERO).as_uvec2().min(self.size);
        let (mut sum, mut area) = (0.0, 0.0);
        for y in first.y..last.y {
            let height = high.y.min(f64::from(y + 1)) - low.y.max(f64::from(y));
            for x in first.x..last.x {
                let index = (y * self.size.x + x) as usize;
                if domain[index] {
                    let part = height * (high.x.min(f64::from(x + 1)) - low.x.max(f64::from(x)));
                    sum += part * f64::from(self.values[index]).powi(2);
                    area += part;
                }
            }
        }
        (area > 0.0).then(|| (sum / area).sqrt() as f32)
    }
}

/// A field while layers come in.
pub(super) struct Pixels<'a> {
    pub picture: &'a Picture,
    /// `[pixels]` ln f.
    logarithms: Vec<f64>,
    /// The regions of the last layer that has some.
    pub regions: Option<Regions>,
    pub reading: Reading,
}

impl<'a> Pixels<'a> {
    fn new(base: f32, clamp: bool, picture: &'a Picture) -> Result<Self> {
        let (reading, ln_base) = Reading::new(base, clamp)?;
        Ok(Self { picture, logarithms: vec![ln_base; picture.domain.len()], regions: None, reading })
    }

    /// Lays something over: ln f of a pixel from its index and what is below.
    pub fn blend(&mut self, over: impl Fn(usize, f64) -> f64 + Sync) {
        self.logarithms.par_iter_mut().enumerate().for_each(|(index, below)| *below = over(index, *below));
    }

    /// Refuses a picture of another size.
    pub fn check_size(&self, path: &Path, size: UVec2) -> Result<()> {
        let wanted = self.picture.size;
        if size == wanted {
            return Ok(());
        }
        let sentence = format!(
            "it has {} × {} pixels and {} has {} × {}; give a map of the same size",
            size.x, size.y, self.picture.name, wanted.x, wanted.y
        );
        Err(Error::in_file(path, sentence))
    }

    fn finish(self) -> Field {
        let (warnings, clamped) = self.reading.finish();
        Field {
            size: self.picture.size,
            values: self.logarithms.par_iter().map(|l| l.exp() as f32).collect(),
            regions: self.regions,
            warnings,
            clamped,
        }
    }
}

/// What layers say that speak of vertices.
pub(super) fn no_vertices() -> Error {
    Error::input(
        "a picture has no vertices, so --attribute and --values without --regions say nothing about it; \
         use --image, --sphere or --regions",
    )
}
