//! What a user can say about importance: one [`Layer`] for each way of saying it.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

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
        /// Centre, in source units.
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
    /// picture of ids.
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
}
