//! `homunculus warp`: what to write, and how it is to look.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::scene::{SceneOptions, number};
use super::seconds;
use crate::Result;
use crate::importance::Layer;
use crate::scene::Scene;
use crate::subject::Look;

/// `warp`: the options, and the importance among them in the order given.
#[derive(Debug)]
pub struct WarpOrder {
    /// All options.
    pub options: WarpOptions,
    /// Importance, in the order given, paths relative to the working directory.
    pub layers: Vec<Layer>,
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

impl WarpOptions {
    /// How results are to look.
    pub fn look(&self) -> Look {
        let coloured = self.colour.map(|colour| colour == Colour::Importance);
        Look { scale: self.scale.unwrap_or(1.0), seconds: self.seconds, coloured }
    }
}

fn scale(text: &str) -> Result<f64, String> {
    let scale = number(text)?;
    if (0.01..=64.0).contains(&scale) { Ok(scale) } else { Err("0.01 to 64 can be had".into()) }
}
