//! What a user can say about importance: one [`Layer`] for each way of saying it.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::field::Pixels;
use super::stack::{OnSurface, Surface};
use super::{attribute, image, regions, sphere, values};
use crate::Result;
use crate::format::{Kind, Use};

/// Least importance that `--clamp` lets through: a twentieth of the length is 1/8000 of the volume, about what a
/// lattice of 256 cells can still hold without a cell shrinking to nothing.
pub const CLAMP_MIN: f32 = 0.05;

/// Greatest importance that `--clamp` lets through, and beyond which a warning is given: twenty times the length is
/// 8000 times the volume; one cell of the lattice is then seen as a block.
pub const CLAMP_MAX: f32 = 20.0;

/// What an image's black and white mean where no range is given: half and twice the length.
pub const IMAGE_RANGE: Range = (0.5, 2.0);

/// Importance at the least and at the greatest value of what is mapped; the other way round is fine.
pub type Range = (f32, f32);

/// One statement about importance. Layers apply in the order given, each over what is below it.
///
/// Paths are relative to the scene file they stand in, or to the working directory on the command line.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Layer {
    /// A dab: `value` at the centre, smoothly (C²) nothing at the radius, blended in the logarithm of importance.
    Sphere {
        /// Centre, in source units; of a picture pixels from the upper left, the third coordinate meaning nothing.
        centre: [f64; 3],
        /// Radius in source units, > 0.
        radius: f64,
        /// Importance at the centre, > 0.
        value: f32,
    },
    /// A vertex attribute of the file.
    Attribute {
        /// Its name, as `inspect` lists it.
        name: String,
        /// Importance at the attribute's least and greatest value; without it the attribute is importance itself.
        #[serde(default)]
        range: Option<Range>,
    },
    /// A CSV table `vertex,importance`; the vertices listed are set, the others keep what is below.
    Values {
        /// The table.
        path: PathBuf,
    },
    /// Two CSV tables, `vertex,region` and `region,importance`; the vertices listed are set. Of a picture the regions are a
    /// picture of the same size whose grey value (8 or 16 bits) is a region's id, and the table has the columns `region`
    /// (the id), `importance` or `value`, and if wanted `name`; the id 0 is no region unless the table has it.
    Regions {
        /// Which vertex or pixel belongs to which region.
        regions: PathBuf,
        /// What each region is worth.
        values: PathBuf,
        /// Of a picture: whether the table's column `value` shall become area.
        #[serde(default)]
        per_area: bool,
    },
    /// A picture through the texture coordinates: luminance 0..1 becomes `range`, transparency lets through what is below.
    /// Over a picture of the same size: grey by luminance, a known colour map by its values.
    Image {
        /// PNG, JPEG or WebP.
        path: PathBuf,
        /// Importance of black and of white; [`IMAGE_RANGE`] where absent.
        #[serde(default)]
        range: Option<Range>,
    },
}

impl Layer {
    /// The files this layer reads.
    pub fn files(&self) -> Vec<&Path> {
        match self {
            Self::Sphere { .. } | Self::Attribute { .. } => Vec::new(),
            Self::Values { path } | Self::Image { path, .. } => vec![path],
            Self::Regions { regions, values, .. } => vec![regions, values],
        }
    }

    /// The same layer with each path passed through `f`.
    #[must_use]
    pub fn map_files(mut self, f: impl Fn(&Path) -> PathBuf) -> Self {
        match &mut self {
            Self::Sphere { .. } | Self::Attribute { .. } => {}
            Self::Values { path } | Self::Image { path, .. } => *path = f(path),
            Self::Regions { regions, values, .. } => {
                *regions = f(regions);
                *values = f(values);
            }
        }
        self
    }

    /// The same layer with relative paths taken from a folder.
    pub(super) fn within(&self, folder: &Path) -> Self {
        self.clone().map_files(|file| folder.join(file))
    }

    /// Reads what it needs to be evaluated on a surface.
    pub(super) fn on_surface(&self, surface: &mut Surface) -> Result<Arc<dyn OnSurface>> {
        Ok(match self {
            Self::Sphere { centre, radius, value } => Arc::new(sphere::on_surface(*centre, *radius, *value, surface)?),
            Self::Attribute { name, range } => Arc::new(attribute::on_surface(name, *range, surface)?),
            Self::Values { path } => Arc::new(values::on_surface(path, surface)?),
            Self::Regions { regions, values, per_area } => {
                Arc::new(regions::on_surface(regions, values, *per_area, surface)?)
            }
            Self::Image { path, range } => Arc::new(image::on_surface(path, *range, surface)?),
        })
    }

    /// Lays it over the pixels of a picture.
    pub(super) fn on_pixels(&self, pixels: &mut Pixels) -> Result<()> {
        match self {
            Self::Sphere { centre, radius, value } => sphere::on_pixels(*centre, *radius, *value, pixels),
            Self::Attribute { .. } => attribute::on_pixels(),
            Self::Values { .. } => values::on_pixels(),
            Self::Regions { regions, values, per_area } => regions::on_pixels(regions, values, *per_area, pixels),
            Self::Image { path, range } => image::on_pixels(path, *range, pixels),
        }
    }

    /// What it is, short and long.
    pub fn describe(&self) -> (String, String) {
        let file = |path: &Path| {
            path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
        };
        match self {
            Self::Sphere { centre: [x, y, z], radius, value } => {
                (format!("sphere ×{value}"), format!("at {x:.4}, {y:.4}, {z:.4}, radius {radius:.4}"))
            }
            Self::Attribute { name, range } => {
                let range = range.map_or_else(|| "as it is".into(), |(low, high)| format!("×{low} to ×{high}"));
                (format!("attribute {name}"), range)
            }
            Self::Values { path } => (format!("values {}", file(path)), path.display().to_string()),
            Self::Regions { regions, values, .. } => {
                (format!("regions {}", file(values)), format!("{}\n{}", regions.display(), values.display()))
            }
            Self::Image { path, .. } => (format!("picture {}", file(path)), path.display().to_string()),
        }
    }
}

/// Layers that are made of files which a user chooses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Offered {
    /// [`Layer::Values`]
    Values,
    /// [`Layer::Regions`]
    Regions,
    /// [`Layer::Image`]
    Image,
}

/// How such a layer is offered.
#[derive(Debug, Clone, Copy)]
pub struct Offer {
    /// In a menu.
    pub name: &'static str,
    /// What is wanted, in a line.
    pub hint: &'static str,
    /// Over the fields for its files.
    pub title: &'static str,
    /// Its files, in the order they are asked for.
    pub files: &'static [Ask],
}

/// A file that is asked for.
#[derive(Debug, Clone, Copy)]
pub struct Ask {
    /// Beside the field.
    pub name: &'static str,
    /// Over the dialog.
    pub title: &'static str,
    /// What it is.
    pub of: Use,
}

impl Offered {
    /// All of them, in the order of a menu.
    pub const ALL: [Self; 3] = [Self::Values, Self::Regions, Self::Image];

    /// The words for it where it makes no difference of which kind the subject is: title, and names of the files.
    pub fn words(self) -> &'static Offer {
        match self {
            Self::Values => &values::OFFER,
            Self::Regions => &regions::OF_BODY,
            Self::Image => &image::OF_BODY,
        }
    }

    /// How it is offered for such a subject; `None` where it says nothing.
    pub fn offer(self, kind: Kind) -> Option<&'static Offer> {
        match (self, kind) {
            (Self::Values, Kind::Body) => Some(&values::OFFER),
            (Self::Values, Kind::Picture) => None,
            (Self::Regions, Kind::Body) => Some(&regions::OF_BODY),
            (Self::Regions, Kind::Picture) => Some(&regions::OF_PICTURE),
            (Self::Image, Kind::Body) => Some(&image::OF_BODY),
            (Self::Image, Kind::Picture) => Some(&image::OF_PICTURE),
        }
    }

    /// The layer of files that were chosen; `None` where one is missing.
    ///
    /// # Errors
    /// A table that cannot be read.
    pub fn layer(self, kind: Kind, files: &[PathBuf]) -> Result<Option<Layer>> {
        Ok(match (self, files) {
            (Self::Values, [path, ..]) => Some(Layer::Values { path: path.clone() }),
            (Self::Image, [path, ..]) => Some(Layer::Image { path: path.clone(), range: None }),
            (Self::Regions, [regions, values, ..]) => Some(regions::chosen(kind, regions.clone(), values.clone())?),
            (_, []) | (Self::Regions, [_]) => None,
        })
    }
}
