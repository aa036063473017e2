//! The command line's words, and what they mean.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::{ArgMatches, Args, CommandFactory, FromArgMatches, Parser, Subcommand, ValueEnum};

use crate::gallery;
use crate::importance::{Layer, Range};
use crate::scene::{Draft, MAX_KEYS, MAX_RESOLUTION, MIN_RESOLUTION, Scene, Source};
use crate::schedule::Reference;
use crate::{Error, Result};

/// What the user ordered.
#[derive(Debug)]
pub enum Order {
    /// Warp a mesh.
    Warp(Box<WarpOrder>),
    /// Say what is in a file.
    Inspect(InspectOptions),
    /// Open the sandbox window.
    #[cfg(feature = "window")]
    Play(PlayOptions),
}

/// `warp`: the options, and the importance among them in the order given.
#[derive(Debug)]
pub struct WarpOrder {
    /// All options.
    pub options: WarpOptions,
    /// Importance, in the order given, paths relative to the working directory.
    pub layers: Vec<Layer>,
}

/// Warp a body until local size is proportional to importance, proven free of folds and self-intersections.
#[derive(Debug, Parser)]
#[command(
    name = "homunculus",
    version,
    arg_required_else_help = cfg!(not(feature = "window")),
    after_help = "\
Exit codes: 0 done and certified, 2 bad input or options, 3 finished but not certified, 1 anything else."
)]
struct CommandLine {
    #[command(subcommand)]
    command: Option<Face>,
}

#[derive(Debug, Subcommand)]
enum Face {
    Warp(Box<WarpOptions>),
    Inspect(InspectOptions),
    #[cfg(feature = "window")]
    Play(PlayOptions),
}

/// Warp a mesh until local size is proportional to importance
///
/// Writes exactly the files named by -o, --growth and --report; with none of them, NAME-warped.EXT in the working
/// directory, in the format of the input (GLB for glTF and the gallery). The input is never overwritten.
///
/// Importance is the linear size factor asked for: 2 means twice as long, 1 keeps. The options for it may be given
/// several times and mixed; they apply in the order given, after the layers of --scene.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  homunculus warp body.obj --sphere 0.7,1.4,0,0.2,2.5 --sphere -0.7,1.4,0,0.2,2.5
  homunculus warp body.ply --attribute pressure:0.5..3 -o big.ply --report big.json
  homunculus warp body.glb --regions region.csv --values worth.csv --growth growth.glb
  homunculus warp head.glb --image map.png:0.5..2 --base 0.8 --save-scene head.ron
  homunculus warp --scene head.ron --resolution 128 --fidelity 0.9
  homunculus warp gallery:hand --growth hand.glb")]
pub struct WarpOptions {
    /// Mesh (glTF, GLB, OBJ, PLY, STL, OFF) or a built-in model as gallery:NAME
    #[arg(value_name = "FILE|gallery:NAME", required_unless_present = "scene", value_parser = source)]
    pub source: Option<Source>,

    /// The warped mesh: .glb, .obj, .ply, .stl or .off
    #[arg(short, long, value_name = "OUT")]
    pub output: Option<PathBuf>,
    /// The growth as an animation that plays in any glTF viewer: .glb
    #[arg(long, value_name = "GROWTH.glb")]
    pub growth: Option<PathBuf>,
    /// What was asked, achieved and proven: .json
    #[arg(long, value_name = "R.json")]
    pub report: Option<PathBuf>,

    /// Cells along the longest axis, 8 to 256 [default: 64]
    #[arg(long, value_name = "N", help_heading = "Method", allow_negative_numbers = true)]
    pub resolution: Option<u32>,
    /// 0 keeps shape, 1 reaches the size asked for [default: 0.5]
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
    /// A dab: importance F at X,Y,Z (units of the file), fading smoothly to nothing at RADIUS
    #[arg(long, value_name = "X,Y,Z,RADIUS,F", help_heading = "Importance", allow_hyphen_values = true, value_parser = sphere)]
    pub sphere: Vec<Layer>,
    /// A vertex attribute of the file (see inspect), its least..greatest value mapped to LO..HI
    #[arg(long, value_name = "NAME[:LO..HI]", help_heading = "Importance", value_parser = attribute)]
    pub attribute: Vec<Layer>,
    /// CSV with the columns vertex,importance (vertices counted from 0); after --regions: region,importance
    #[arg(long, value_name = "V.csv", help_heading = "Importance")]
    pub values: Vec<PathBuf>,
    /// CSV with the columns vertex,region; the next --values says what each region is worth
    #[arg(long, value_name = "R.csv", help_heading = "Importance")]
    pub regions: Vec<PathBuf>,
    /// A picture through the texture coordinates: black is LO, white is HI [default: 0.5..2]
    #[arg(long, value_name = "MAP.png[:LO..HI]", help_heading = "Importance", value_parser = image)]
    pub image: Vec<Layer>,
    /// Bring importance outside 0.05..20 into that range, rather than refuse what is not > 0
    #[arg(long, help_heading = "Importance")]
    pub clamp: bool,

    /// Keyframes of the growth, 1 to 64 [default: 8]
    #[arg(long, value_name = "N", help_heading = "Growth")]
    pub keys: Option<usize>,
    /// Length of the growth animation in seconds
    #[arg(long, value_name = "S", help_heading = "Growth", default_value = "4", value_parser = seconds, allow_negative_numbers = true)]
    pub seconds: f32,
    /// Vertex colours to write [default: importance in the growth, original in the mesh]
    #[arg(long, help_heading = "Growth")]
    pub colour: Option<Colour>,

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

/// Say what is in a mesh file and what would be voxelized
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  homunculus inspect body.obj
  homunculus inspect scan.stl --resolution 128 --json")]
pub struct InspectOptions {
    /// Mesh (glTF, GLB, OBJ, PLY, STL, OFF) or a built-in model as gallery:NAME
    #[arg(value_name = "FILE|gallery:NAME", value_parser = source)]
    pub source: Source,
    /// Cells along the longest axis, 8 to 256
    #[arg(long, value_name = "N", default_value_t = 64, allow_negative_numbers = true)]
    pub resolution: u32,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
}

/// Open the sandbox window: paint importance and watch it grow
///
/// Without a command the window opens with the built-in homunculus.
#[cfg(feature = "window")]
#[derive(Debug, Args, Default)]
#[command(after_help = "\
Examples:
  homunculus play body.obj
  homunculus play head.ron
  homunculus play gallery:hand")]
pub struct PlayOptions {
    /// Mesh, picture, scene (.ron) or a built-in model as gallery:NAME [default: gallery:homunculus]
    #[arg(value_name = "FILE|SCENE.ron|gallery:NAME", value_parser = source)]
    pub source: Option<Source>,
    /// Measure for so many seconds each how long frames take at rest and during a solve, print it and end
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub bench: Option<f32>,
    /// Print what --bench measured as JSON
    #[arg(long, requires = "bench")]
    pub json: bool,
    /// Do what a file says, for tests
    #[arg(long, value_name = "FILE", hide = true)]
    pub script: Option<PathBuf>,
    /// Width and height of the window
    #[arg(long, value_name = "W,H", hide = true, value_delimiter = ',', num_args = 2)]
    pub size: Vec<u32>,
}

/// `--reference`
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ReferenceName {
    /// Collision optimization as in the paper's Fig. 5
    Fig5,
    /// Edge optimization (Eq. 1) alone
    Eq1,
}

/// `--colour`
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Colour {
    /// Importance, dark blue for the least to yellow for the most
    Importance,
    /// As in the input
    Original,
}

impl From<ReferenceName> for Reference {
    fn from(name: ReferenceName) -> Self {
        match name {
            ReferenceName::Fig5 => Self::Fig5,
            ReferenceName::Eq1 => Self::Eq1,
        }
    }
}

/// Reads the command line; the error prints itself, help and version included.
///
/// # Errors
/// As clap words it.
pub fn parse(arguments: impl IntoIterator<Item = OsString>) -> clap::error::Result<Order> {
    let matches = CommandLine::command().try_get_matches_from(arguments)?;
    Ok(match CommandLine::from_arg_matches(&matches)?.command {
        #[cfg(feature = "window")]
        None => Order::Play(PlayOptions::default()),
        #[cfg(not(feature = "window"))]
        None => return Err(CommandLine::command().error(clap::error::ErrorKind::MissingSubcommand, "a command is missing")),
        #[cfg(feature = "window")]
        Some(Face::Play(options)) => Order::Play(options),
        Some(Face::Inspect(options)) => Order::Inspect(options),
        Some(Face::Warp(options)) => {
            let layers = match matches.subcommand_matches("warp") {
                Some(matches) => layers(&options, matches)?,
                None => Vec::new(),
            };
            Order::Warp(Box::new(WarpOrder { options: *options, layers }))
        }
    })
}

impl WarpOrder {
    /// The scene ordered: a scene file's or a fresh one, with the options over it.
    ///
    /// # Errors
    /// If the scene file cannot be read or a value is out of range.
    pub fn scene(&self) -> Result<Scene> {
        let options = &self.options;
        let mut draft = match (&options.scene, &options.source) {
            (Some(path), _) => Scene::load(path)?.into_draft(),
            (None, Some(source)) => fresh(source),
            (None, None) => return Err(Error::input("nothing to warp; give a mesh file, gallery:NAME or --scene")),
        };
        if let Some(source) = &options.source {
            draft.source = source.clone();
        }
        draft.layers.extend(self.layers.iter().cloned());
        draft.base = options.base.unwrap_or(draft.base);
        draft.clamp |= options.clamp;
        draft.resolution = options.resolution.unwrap_or(draft.resolution);
        draft.fidelity = options.fidelity.unwrap_or(draft.fidelity);
        draft.keys = options.keys.unwrap_or(draft.keys);
        Scene::new(draft)
    }
}

/// A scene with nothing but a source; a built-in one comes with settings that suit it.
pub(super) fn fresh(source: &Source) -> Draft {
    let mut draft = Draft::of(source.clone());
    if let Source::Gallery(name) = source
        && let Some(entry) = gallery::list().iter().find(|entry| entry.name == name)
    {
        draft.resolution = entry.resolution;
        draft.fidelity = entry.fidelity;
    }
    draft
}

/// Importance in the order given. Each `--regions` takes the next `--values` after it.
fn layers(options: &WarpOptions, matches: &ArgMatches) -> clap::error::Result<Vec<Layer>> {
    let indices = |id: &str| matches.indices_of(id).into_iter().flatten().collect::<Vec<_>>();
    let mut values: Vec<_> = indices("values").into_iter().zip(&options.values).collect();
    let mut layers = Vec::new();
    for (at, regions) in indices("regions").into_iter().zip(&options.regions) {
        let Some(next) = values.iter().position(|(index, _)| *index > at) else {
            let sentence = format!(
                "--regions {0} has no --values after it; add --values with the columns region,importance",
                regions.display()
            );
            return Err(CommandLine::command().error(clap::error::ErrorKind::MissingRequiredArgument, sentence));
        };
        let (_, values) = values.remove(next);
        layers.push((at, Layer::Regions { regions: regions.clone(), values: values.clone() }));
    }
    layers.extend(values.into_iter().map(|(at, path)| (at, Layer::Values { path: path.clone() })));
    for (id, given) in [("sphere", &options.sphere), ("attribute", &options.attribute), ("image", &options.image)] {
        layers.extend(indices(id).into_iter().zip(given.iter().cloned()));
    }
    layers.sort_by_key(|(at, _)| *at);
    Ok(layers.into_iter().map(|(_, layer)| layer).collect())
}

fn source(text: &str) -> Result<Source, String> {
    match text {
        "" => Err("give a mesh file or gallery:NAME".into()),
        text => Ok(text.to_owned().into()),
    }
}

fn sphere(text: &str) -> Result<Layer, String> {
    let numbers: Vec<f64> = text.split(',').map(|n| number(n.trim())).collect::<Result<_, _>>()?;
    let &[x, y, z, radius, value] = numbers.as_slice() else {
        return Err(format!("five numbers X,Y,Z,RADIUS,F are needed, there are {}", numbers.len()));
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

fn number(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        Ok(_) => Err(format!("`{text}` is not finite")),
        Err(_) => Err(format!("`{text}` is not a number")),
    }
}

fn seconds(text: &str) -> Result<f32, String> {
    let seconds = number(text)? as f32;
    if (0.1..=3600.0).contains(&seconds) { Ok(seconds) } else { Err("0.1 to 3600 seconds can be had".into()) }
}

// The help says these numbers in words.
const _: () = assert!(MIN_RESOLUTION == 8 && MAX_RESOLUTION == 256 && MAX_KEYS == 64);
