//! The command line's words, and what they mean.

mod inspect;
#[cfg(feature = "window")]
mod play;
#[cfg(feature = "record")]
mod record;
mod scene;
mod warp;

use std::ffi::OsString;

use clap::{ArgMatches, CommandFactory, FromArgMatches, Parser, Subcommand};

pub use super::gallery::GalleryOptions;
pub use inspect::InspectOptions;
#[cfg(feature = "window")]
pub use play::PlayOptions;
#[cfg(feature = "record")]
pub use record::{EaseName, RecordOptions, RecordOrder, ViewName};
pub use scene::{ReferenceName, SceneOptions};
pub use warp::{Colour, WarpOptions, WarpOrder};

use crate::importance::Layer;
use scene::{layers, number};

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

fn seconds(text: &str) -> Result<f32, String> {
    let seconds = number(text)? as f32;
    if (0.1..=3600.0).contains(&seconds) { Ok(seconds) } else { Err("0.1 to 3600 seconds can be had".into()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::{Kind, Use};

    /// The formats a help names: words that begin with a dot.
    fn named(command: &str, option: &str) -> Vec<String> {
        let all = CommandLine::command();
        let command = all.find_subcommand(command).expect("a command");
        let argument = command.get_arguments().find(|argument| argument.get_id() == option).expect("an option");
        let help = argument.get_help().expect("a help").to_string();
        let words = help.split_whitespace().filter_map(|word| word.strip_prefix('.'));
        let mut named: Vec<String> = words.map(|word| word.trim_end_matches([',', ';', '.']).to_owned()).collect();
        named.sort_unstable();
        named.dedup();
        named
    }

    fn known(uses: &[Use]) -> Vec<&'static str> {
        let mut known: Vec<&str> = uses.iter().flat_map(|what| what.extensions()).collect();
        known.sort_unstable();
        known.dedup();
        known
    }

    #[test]
    fn help_names_the_formats_there_are() {
        let results = Kind::ALL.map(Use::Result);
        assert_eq!(named("warp", "output"), known(&results));
        assert_eq!(named("warp", "growth"), known(&Kind::ALL.map(Use::Growth)));
        assert_eq!(named("warp", "report"), known(&[Use::Report]));
        #[cfg(feature = "record")]
        assert_eq!(named("record", "output"), known(&[Use::Film]));
        assert_ne!(named("warp", "output"), known(&results[..1]), "sabotage: one that is not named is missed");
    }
}
