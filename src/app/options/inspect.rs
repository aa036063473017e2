//! `homunculus inspect`: what to look at.

use clap::Args;

use super::scene::source;
use crate::scene::Source;

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
