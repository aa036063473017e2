//! `homunculus play`: what to open.

use std::path::PathBuf;

use clap::Args;

use super::scene::source;
use super::seconds;
use crate::scene::Source;

/// Open the sandbox window: paint importance and watch it grow
///
/// Without a command the window opens with the built-in homunculus.
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
