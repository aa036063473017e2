//! `homunculus gallery`: what is built in, a line each, as a page of pictures, or as thumbnails in the window.

#[cfg(feature = "record")]
mod exhibit;
#[cfg(feature = "record")]
mod page;
#[cfg(feature = "record")]
mod photographer;
#[cfg(feature = "record")]
mod render;
#[cfg(feature = "record")]
mod sheet;

use clap::Args;

use super::{Verdict, say};
use crate::gallery::{self, Entry};
use crate::{Error, Result};

/// List the built-in scenes: warp, play or record them as gallery:NAME
#[derive(Debug, Args, Default)]
#[command(after_help = "\
Examples:
  homunculus gallery
  homunculus gallery --open
  homunculus gallery --open crocodile
  homunculus gallery --render pages homunculus crocodile")]
pub struct GalleryOptions {
    /// Which scenes [default: all]
    #[arg(value_name = "NAME")]
    pub names: Vec<String>,
    /// Show them in the window, to choose one; of a single NAME that scene
    #[cfg(feature = "window")]
    #[arg(long)]
    pub open: bool,
    /// Warp each at its own resolution and write FOLDER/index.html: what was asked, achieved and proven, beside Eq. 1
    /// alone, with pictures; and FOLDER/contact-sheet.png
    #[cfg(feature = "record")]
    #[arg(long, value_name = "FOLDER")]
    #[cfg_attr(feature = "window", arg(conflicts_with = "open"))]
    pub render: Option<std::path::PathBuf>,
}

/// Lists, renders or opens.
pub(super) fn run(options: &GalleryOptions) -> Result<Verdict> {
    let entries = chosen(&options.names)?;
    #[cfg(feature = "record")]
    if let Some(folder) = &options.render {
        return render::run(&entries, folder);
    }
    #[cfg(feature = "window")]
    if options.open {
        return match (&options.names[..], &entries[..]) {
            ([], _) => super::play::choose(),
            (_, [entry]) => super::play::show(entry.name),
            _ => {
                Err(Error::input("the window shows one scene at a time; give --open one NAME, or none to choose there"))
            }
        };
    }
    let width = entries.iter().map(|entry| entry.name.len()).max().unwrap_or(0);
    for entry in entries {
        say(&format!("gallery:{:<width$}  {}", entry.name, entry.one_line));
    }
    Ok(Verdict::Done)
}

/// The scenes of these names in the gallery's order, all if there are none.
fn chosen(names: &[String]) -> Result<Vec<Entry>> {
    let plain = |name: &String| name.strip_prefix("gallery:").unwrap_or(name).to_owned();
    let names: Vec<String> = names.iter().map(plain).collect();
    if let Some(unknown) = names.iter().find(|name| gallery::everything().all(|entry| entry.name != **name)) {
        let known: Vec<&str> = gallery::everything().map(|entry| entry.name).collect();
        return Err(Error::input(format!("the gallery has no scene `{unknown}`; it has {}", known.join(", "))));
    }
    let is_wanted = |entry: &Entry| names.is_empty() || names.iter().any(|name| name == entry.name);
    Ok(gallery::everything().filter(is_wanted).collect())
}
