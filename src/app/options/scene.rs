//! What to warp and how, in the command line's words: shared by every command that warps.

use std::path::PathBuf;

use clap::error::{Error as Refusal, ErrorKind};
use clap::{ArgMatches, Args, ValueEnum};

use crate::format::Use;
use crate::importance::{Layer, Range};
use crate::settings::{MAX_KEYS, Reference};
use crate::{Error, Result};
use crate::{
    scene::{Draft, Scene, Source},
    voxel::{MAX_RESOLUTION, MIN_RESOLUTION},
};

/// The options that say what to warp and how.
#[derive(Debug, Args)]
pub struct SceneOptions {
    /// Mesh (glTF, GLB, OBJ, PLY, STL, OFF), picture (PNG, JPEG, WebP), a scene file (RON) or a built-in model as gallery:NAME
    #[arg(value_name = "FILE|SCENE.ron|gallery:NAME", required_unless_present = "scene", value_parser = source)]
    pub source: Option<Source>,

    /// Cells along the longest axis, 8 to 256, of a picture 8 to 512 [default: 64, of a picture 128]
    #[arg(long, value_name = "N", help_heading = "Method", allow_negative_numbers = true)]
    pub resolution: Option<u32>,
    /// 0 keeps shape, 1 reaches the size asked for [default: 0.5, of a picture 1]
    #[arg(long, value_name = "MU", help_heading = "Method", allow_negative_numbers = true)]
    pub fidelity: Option<f32>,
    /// Use the paper's own solver, for comparison only
    #[arg(long, help_heading = "Method")]
    pub reference: Option<ReferenceName>,
    /// Threads to use [default: all]
    #[arg(long, value_name = "N", help_heading = "Method", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,

    /// Importance where nothing else is said [default: 1]
    #[arg(long, value_name = "F", help_heading = "Importance", allow_negative_numbers = true)]
    pub base: Option<f32>,
    /// A dab: importance F at X,Y,Z (units of the file), fading smoothly to nothing at RADIUS; of a picture X,Y,RADIUS,F
    /// in pixels from the upper left
    #[arg(long, value_name = "X,Y,[Z,]RADIUS,F", help_heading = "Importance", allow_hyphen_values = true, value_parser = sphere)]
    pub sphere: Vec<Layer>,
    /// A vertex attribute of the file (see inspect), its least..greatest value mapped to LO..HI
    #[arg(long, value_name = "NAME[:LO..HI]", help_heading = "Importance", value_parser = attribute)]
    pub attribute: Vec<Layer>,
    /// CSV with the columns vertex,importance (vertices counted from 0); after --regions: region,importance
    #[arg(long, value_name = "V.csv", help_heading = "Importance")]
    pub values: Vec<PathBuf>,
    /// CSV with the columns vertex,region, or a picture's ids as grey values; the next --values says what each is worth
    #[arg(long, value_name = "R.csv", help_heading = "Importance")]
    pub regions: Vec<PathBuf>,
    /// A map through the texture coordinates, or as large as the picture: black is LO, white is HI [default: 0.5..2]
    #[arg(long, value_name = "MAP.png[:LO..HI]", help_heading = "Importance", value_parser = image)]
    pub image: Vec<Layer>,
    /// Of a picture with --regions: the column `value` (population, say) shall become area, all together keeping theirs
    #[arg(long, help_heading = "Importance")]
    pub per_area: bool,
    /// Of a picture: what is this colour and reaches the rim is no part of it, as in white,0.1
    #[arg(long, value_name = "COLOUR,TOLERANCE", help_heading = "Method")]
    pub background: Option<String>,
    /// Bring importance outside 0.05..20 into that range, rather than refuse what is not > 0
    #[arg(long, help_heading = "Importance")]
    pub clamp: bool,

    /// Keyframes of the growth, 1 to 64 [default: 8]
    #[arg(long, value_name = "N", help_heading = "Growth")]
    pub keys: Option<usize>,

    /// Start from a scene file; other options override it, importance is added on top
    #[arg(long, value_name = "S.ron", help_heading = "Scene")]
    pub scene: Option<PathBuf>,
    /// Write what was warped and how as a scene file
    #[arg(long, value_name = "S.ron", help_heading = "Scene")]
    pub save_scene: Option<PathBuf>,

    /// Say nothing but errors
    #[arg(short, long)]
    pub quiet: bool,
}

/// `--reference`
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ReferenceName {
    /// Collision optimization as in the paper's Fig. 5
    Fig5,
    /// Edge optimization (Eq. 1) alone
    Eq1,
}

impl From<ReferenceName> for Reference {
    fn from(name: ReferenceName) -> Self {
        match name {
            ReferenceName::Fig5 => Self::Fig5,
            ReferenceName::Eq1 => Self::Eq1,
        }
    }
}

impl SceneOptions {
    /// The scene ordered: a scene file's or a fresh one, with the options and `layers` over it.
    ///
    /// # Errors
    /// If the scene file cannot be read or a value is out of range.
    pub fn scene(&self, layers: &[Layer]) -> Result<Scene> {
        let (file, source) = match (&self.scene, &self.source) {
            (None, Some(Source::File(path))) if Use::Scene.of(path).is_some() => (Some(path), None),
            (file, source) => (file.as_ref(), source.as_ref()),
        };
        let mut draft = match (file, source) {
            (Some(path), _) => Scene::load(path)?.into_draft(),
            (None, Some(source)) => Draft::fresh(source),
            (None, None) => return Err(Error::input("nothing to warp; give a mesh file, gallery:NAME or --scene")),
        };
        if let Some(source) = source {
            draft.source = source.clone();
        }
        draft.layers.extend(layers.iter().cloned());
        draft.base = self.base.unwrap_or(draft.base);
        draft.clamp |= self.clamp;
        draft.resolution = self.resolution.unwrap_or(draft.resolution);
        draft.fidelity = self.fidelity.unwrap_or(draft.fidelity);
        draft.keys = self.keys.unwrap_or(draft.keys);
        draft.background = self.background.clone().or(draft.background);
        Scene::new(draft)
    }
}

/// Importance in the order given. Each `--regions` takes the next `--values` after it.
///
/// # Errors
/// If one has none.
pub(super) fn layers(options: &SceneOptions, matches: &ArgMatches) -> Result<Vec<Layer>, Refusal> {
    let indices = |id: &str| matches.indices_of(id).into_iter().flatten().collect::<Vec<_>>();
    let mut values: Vec<_> = indices("values").into_iter().zip(&options.values).collect();
    let mut layers = Vec::new();
    for (at, regions) in indices("regions").into_iter().zip(&options.regions) {
        let Some(next) = values.iter().position(|(index, _)| *index > at) else {
            let sentence = format!(
                "--regions {0} has no --values after it; add --values with the columns region,importance",
                regions.display()
            );
            return Err(Refusal::raw(ErrorKind::MissingRequiredArgument, sentence));
        };
        let (_, values) = values.remove(next);
        layers.push((
            at,
            Layer::Regions { regions: regions.clone(), values: values.clone(), per_area: options.per_area },
        ));
    }
    layers.extend(values.into_iter().map(|(at, path)| (at, Layer::Values { path: path.clone() })));
    for (id, given) in [("sphere", &options.sphere), ("attribute", &options.attribute), ("image", &options.image)] {
        layers.extend(indices(id).into_iter().zip(given.iter().cloned()));
    }
    layers.sort_by_key(|(at, _)| *at);
    Ok(layers.into_iter().map(|(_, layer)| layer).collect())
}

pub(super) fn source(text: &str) -> Result<Source, String> {
    match text {
        "" => Err("give a mesh file or gallery:NAME".into()),
        text => Ok(text.to_owned().into()),
    }
}

fn sphere(text: &str) -> Result<Layer, String> {
    let numbers: Vec<f64> = text.split(',').map(|n| number(n.trim())).collect::<Result<_, _>>()?;
    let (x, y, z, radius, value) = match *numbers.as_slice() {
        [x, y, z, radius, value] => (x, y, z, radius, value),
        [x, y, radius, value] => (x, y, 0.0, radius, value),
        _ => {
            let sentence = "five numbers X,Y,Z,RADIUS,F are needed (for a picture four, X,Y,RADIUS,F)";
            return Err(format!("{sentence}, there are {}", numbers.len()));
        }
    };
    if radius <= 0.0 {
        return Err(format!("the radius {radius} is not greater than 0"));
    }
    Ok(Layer::Sphere { centre: [x, y, z], radius, value: value as f32 })
}

fn attribute(text: &str) -> Result<Layer, String> {
    let (name, range) = split_range(text)?;
    match name {
        "" => Err("the attribute's name is missing".into()),
        name => Ok(Layer::Attribute { name: name.into(), range }),
    }
}

fn image(text: &str) -> Result<Layer, String> {
    let (path, range) = split_range(text)?;
    match path {
        "" => Err("the picture's file is missing".into()),
        path => Ok(Layer::Image { path: path.into(), range }),
    }
}

/// `NAME:LO..HI` in its parts. What follows the last colon is a range if it has two dots and no path separator.
fn split_range(text: &str) -> Result<(&str, Option<Range>), String> {
    let Some((name, range)) = text.rsplit_once(':') else { return Ok((text, None)) };
    let Some((low, high)) = range.split_once("..") else { return Ok((text, None)) };
    if range.contains(['/', '\\']) {
        return Ok((text, None));
    }
    Ok((name, Some((number(low)? as f32, number(high)? as f32))))
}

pub(super) fn number(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        Ok(_) => Err(format!("`{text}` is not finite")),
        Err(_) => Err(format!("`{text}` is not a number")),
    }
}

// The help says these numbers in words.
const _: () = assert!(MIN_RESOLUTION == 8 && MAX_RESOLUTION == 256 && MAX_KEYS == 64);
