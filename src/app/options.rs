//! The command line's words, and what they mean.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::{ArgMatches, Args, CommandFactory, FromArgMatches, Parser, Subcommand, ValueEnum};

pub use super::gallery::GalleryOptions;
#[cfg(feature = "record")]
use super::record::{RecordOptions, RecordOrder};
pub use super::scene_options::ReferenceName;
use super::scene_options::{SceneOptions, layers, number, source};
use crate::Result;
use crate::importance::Layer;
use crate::scene::{Scene, Source};

/// What the user ordered.
#[derive(Debug)]
pub enum Order {
    /// Warp a mesh.
    Warp(Box<WarpOrder>),
    /// Say what is in a file.
    Inspect(InspectOptions),
    /// List, render or open the built-in scenes.
    Gallery(GalleryOptions),
    /// Film the growth.
    #[cfg(feature = "record")]
    Record(Box<RecordOrder>),
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
    Gallery(GalleryOptions),
    #[cfg(feature = "record")]
    Record(Box<RecordOptions>),
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
  homunculus warp gallery:hand --growth hand.glb
  homunculus warp map.png --regions ids.png --values people.csv --per-area --resolution 256 --growth map.gif")]
pub struct WarpOptions {
    /// What to warp and how.
    #[command(flatten)]
    pub scene: SceneOptions,

    /// The warped mesh: .glb, .obj, .ply, .stl or .off; the warped picture: .png
    #[arg(short, long, value_name = "OUT")]
    pub output: Option<PathBuf>,
    /// The growth as an animation that plays in any glTF viewer: .glb; of a picture also .apng or .gif
    #[arg(long, value_name = "GROWTH.glb")]
    pub growth: Option<PathBuf>,
    /// What was asked, achieved and proven: .json
    #[arg(long, value_name = "R.json")]
    pub report: Option<PathBuf>,

    /// Length of the growth animation in seconds
    #[arg(long, value_name = "S", help_heading = "Growth", default_value = "4", value_parser = seconds, allow_negative_numbers = true)]
    pub seconds: f32,
    /// Of a picture: pixels of the result along one of the input [default: 1]
    #[arg(long, value_name = "S", help_heading = "Growth", value_parser = scale)]
    pub scale: Option<f64>,
    /// Vertex colours to write [default: importance in the growth, original in the mesh]
    #[arg(long, help_heading = "Growth")]
    pub colour: Option<Colour>,
}

/// Say what is in a mesh or picture and what would be voxelized
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  homunculus inspect body.obj
  homunculus inspect scan.stl --resolution 128 --json
  homunculus inspect photo.jpg --background white,0.1")]
pub struct InspectOptions {
    /// Mesh (glTF, GLB, OBJ, PLY, STL, OFF), picture (PNG, JPEG, WebP) or a built-in model as gallery:NAME
    #[arg(value_name = "FILE|gallery:NAME", value_parser = source)]
    pub source: Source,
    /// Cells along the longest axis, 8 to 256, of a picture 8 to 512 [default: 64, of a picture 128]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub resolution: Option<u32>,
    /// Of a picture: what is this colour and reaches the rim is no part of it, as in white,0.1
    #[arg(long, value_name = "COLOUR,TOLERANCE")]
    pub background: Option<String>,
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
    /// Mesh, picture, scene (.ron) or a built-in scene as gallery:NAME [default: gallery:homunculus]
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
    #[arg(long, value_name = "W,H", hide = true, value_delimiter = ',')]
    pub size: Vec<u32>,
}

/// `--colour`
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Colour {
    /// Importance, dark blue for the least to yellow for the most
    Importance,
    /// As in the input
    Original,
}

impl WarpOrder {
    /// The scene ordered.
    ///
    /// # Errors
    /// As [`SceneOptions::scene`].
    pub fn scene(&self) -> Result<Scene> {
        self.options.scene.scene(&self.layers)
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
        None => {
            let kind = clap::error::ErrorKind::MissingSubcommand;
            return Err(CommandLine::command().error(kind, "a command is missing"));
        }
        #[cfg(feature = "window")]
        Some(Face::Play(options)) => Order::Play(options),
        Some(Face::Inspect(options)) => Order::Inspect(options),
        Some(Face::Gallery(options)) => Order::Gallery(options),
        Some(Face::Warp(options)) => {
            let layers = layers_of(&options.scene, &matches)?;
            Order::Warp(Box::new(WarpOrder { options: *options, layers }))
        }
        #[cfg(feature = "record")]
        Some(Face::Record(options)) => {
            let layers = layers_of(&options.scene, &matches)?;
            Order::Record(Box::new(RecordOrder { options: *options, layers }))
        }
    })
}

/// Importance among the options of the command given; a refusal has the usage below it.
fn layers_of(options: &SceneOptions, matches: &ArgMatches) -> clap::error::Result<Vec<Layer>> {
    let Some((_, matches)) = matches.subcommand() else { return Ok(Vec::new()) };
    layers(options, matches).map_err(|refusal| refusal.with_cmd(&CommandLine::command()))
}

fn scale(text: &str) -> Result<f64, String> {
    let scale = number(text)?;
    if (0.01..=64.0).contains(&scale) { Ok(scale) } else { Err("0.01 to 64 can be had".into()) }
}

fn seconds(text: &str) -> Result<f32, String> {
    let seconds = number(text)? as f32;
    if (0.1..=3600.0).contains(&seconds) { Ok(seconds) } else { Err("0.1 to 3600 seconds can be had".into()) }
}
