//! 3.2  **F** of a picture: importance per pixel, the linear size factor asked for.
//!
//! As on bodies, importance is layers over a base value that blend in ln f (see [`crate::importance`]): discs, pictures of
//! the same size read as maps, and regions with values. A statistic shall become area, so `per_area` takes the square root
//! of value over area, and scales it so that all regions together keep theirs.

mod colour_map;
mod regions;

use std::path::{Path, PathBuf};

use glam::{DVec2, UVec2};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::importance::admission::Admission;
use crate::importance::{IMAGE_RANGE, Range, falloff};
use crate::picture::{Picture, Pixels, read};
use crate::{Error, Result};

/// One statement about importance. Layers apply in the order given, each over what is below it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Layer {
    /// A dab: `value` at the centre, smoothly (C²) nothing at the radius.
    Disc {
        /// Centre, pixels.
        centre: [f64; 2],
        /// Radius in pixels, > 0.
        radius: f64,
        /// Importance at the centre, > 0.
        value: f32,
    },
    /// A picture of the same size: grey by luminance, a known colour map by its values; 0..1 becomes `range`, and
    /// transparency lets through what is below.
    Image {
        /// PNG, JPEG or WebP.
        path: PathBuf,
        /// Importance of the least and of the greatest value; [`IMAGE_RANGE`] where absent.
        #[serde(default)]
        range: Option<Range>,
    },
    /// A picture of the same size whose grey value (8 or 16 bits) is a region's id, and a CSV table with the columns
    /// `region` (the id), `importance` or `value`, and if wanted `name`. The id 0 is no region unless the table has it.
    Regions {
        /// The picture of ids.
        ids: PathBuf,
        /// The table.
        values: PathBuf,
        /// Whether the column `value` shall become area.
        #[serde(default)]
        per_area: bool,
    },
}

impl Layer {
    /// A disc as it is written on the command line: `X,Y,RADIUS,F`, or as for bodies `X,Y,Z,RADIUS,F` with Z ignored.
    ///
    /// # Errors
    /// Says how many numbers there are, or which is none.
    pub fn disc(text: &str) -> Result<Self, String> {
        let number = |part: &str| part.trim().parse::<f64>().map_err(|_| format!("`{}` is no number", part.trim()));
        let numbers = text.split(',').map(number).collect::<Result<Vec<f64>, String>>()?;
        match numbers[..] {
            [x, y, radius, value] | [x, y, _, radius, value] => {
                Ok(Self::Disc { centre: [x, y], radius, value: value as f32 })
            }
            _ => Err(format!("four numbers X,Y,RADIUS,F are needed, there are {}", numbers.len())),
        }
    }
}

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
        let mut field = Building::new(base, clamp, picture)?;
        for layer in layers {
            match layer {
                Layer::Disc { centre, radius, value } => field.disc(DVec2::from_array(*centre), *radius, *value)?,
                Layer::Image { path, range } => field.image(&scene_dir.join(path), range.unwrap_or(IMAGE_RANGE))?,
                Layer::Regions { ids, values, per_area } => {
                    let (ids, values) = (scene_dir.join(ids), scene_dir.join(values));
                    let decoded = read::decode(&ids, &read::file(&ids)?)?;
                    let text = std::fs::read(&values).map_err(|e| Error::reading(&values, e))?;
                    field.regions(&ids, &decoded.pixels, &values, &text, *per_area)?;
                }
            }
        }
        Ok(field.finish())
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
        let mut field = Building::new(base, false, picture)?;
        let decoded = read::decode(Path::new(ids.0), ids.1)?;
        field.regions(Path::new(ids.0), &decoded.pixels, Path::new(values.0), values.1, per_area)?;
        Ok(field.finish())
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
struct Building<'a> {
    picture: &'a Picture,
    /// `[pixels]` ln f.
    logarithms: Vec<f64>,
    regions: Option<Regions>,
    admission: Admission,
    warnings: Vec<String>,
}

impl<'a> Building<'a> {
    fn new(base: f32, clamp: bool, picture: &'a Picture) -> Result<Self> {
        let mut admission = Admission { clamp, ..Admission::default() };
        let base = admission.admit(base, &base.to_string(), || "base".into())?.unwrap_or(1.0);
        let logarithms = vec![f64::from(base).ln(); picture.domain.len()];
        Ok(Self { picture, logarithms, regions: None, admission, warnings: Vec::new() })
    }

    fn disc(&mut self, centre: DVec2, radius: f64, value: f32) -> Result<()> {
        if !(centre.is_finite() && radius > 0.0 && radius.is_finite()) {
            let sentence = format!("disc at {centre}: the centre must be finite and the radius {radius} > 0");
            return Err(Error::input(sentence));
        }
        let value = self.admit(value, || format!("disc at {centre}"))?;
        let width = self.picture.size.x as usize;
        let weight = |index: usize| {
            let place = DVec2::new((index % width) as f64 + 0.5, (index / width) as f64 + 0.5);
            falloff(place.distance(centre) / radius)
        };
        let touched = self.logarithms.par_iter_mut().enumerate().map(|(index, below)| {
            let weight = weight(index);
            *below += weight * (value.ln() - *below);
            weight > 0.0 && self.picture.domain[index]
        });
        if !touched.reduce(|| false, |a, b| a || b) {
            self.warnings.push(format!("disc at {centre}: nothing of the body lies within its radius {radius}"));
        }
        Ok(())
    }

    fn image(&mut self, path: &Path, (low, high): Range) -> Result<()> {
        let (low, high) =
            (self.admit(low, || path.display().to_string())?, self.admit(high, || path.display().to_string())?);
        let decoded = read::decode(path, &read::file(path)?)?;
        self.check_size(path, decoded.pixels.size())?;
        let (values, taken) = colour_map::values(&decoded.pixels);
        self.warnings.push(format!("{}: read as {taken}", path.display()));
        let blend = |(index, below): (usize, &mut f64)| {
            let opacity = f64::from(decoded.pixels.wide(index)[3]) / 65535.0;
            let value = low + f64::from(values[index]) * (high - low);
            *below += opacity * (value.ln() - *below);
        };
        self.logarithms.par_iter_mut().enumerate().for_each(blend);
        Ok(())
    }

    fn regions(&mut self, ids: &Path, pixels: &Pixels, table: &Path, text: &[u8], per_area: bool) -> Result<()> {
        self.check_size(ids, pixels.size())?;
        let joined = regions::join(ids, pixels, &self.picture.domain, table, text, per_area, &mut self.admission)?;
        let set = |(below, region): (&mut f64, &u32)| {
            if let Some(value) = joined.importance.get(*region as usize).copied().flatten() {
                *below = f64::from(value).ln();
            }
        };
        self.logarithms.par_iter_mut().zip(&joined.regions.of_pixel).for_each(set);
        self.warnings.extend(joined.warnings);
        self.regions = Some(joined.regions);
        Ok(())
    }

    fn finish(mut self) -> Field {
        self.warnings.extend(self.admission.warnings());
        Field {
            size: self.picture.size,
            values: self.logarithms.par_iter().map(|l| l.exp() as f32).collect(),
            regions: self.regions,
            warnings: self.warnings,
            clamped: self.admission.clamped,
        }
    }

    /// Admits a value that was written by hand; NaN keeps.
    fn admit(&mut self, value: f32, place: impl FnOnce() -> String) -> Result<f64> {
        Ok(f64::from(self.admission.admit(value, &value.to_string(), place)?.unwrap_or(1.0)))
    }

    fn check_size(&self, path: &Path, size: UVec2) -> Result<()> {
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
}
