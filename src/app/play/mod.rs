//! `homunculus play`: the sandbox window.
//!
//! [`Sandbox`] is everything but the window: what is open, chosen and solved. [`PlayPlugin`] lets pointer and keys act on
//! it and keeps the view's components; it needs neither a window nor a GPU, so that tests drive it with Bevy's own input
//! messages. The window plugin adds panels, the viewport and the rhythm of frames.

mod bench;
mod dialog;
mod display;
mod document;
mod drawn;
#[cfg(feature = "record")]
mod filming;
mod keys;
mod marks;
mod memory;
mod pointer;
mod present;
mod results;
mod sandbox;
mod script;
mod tasks;
mod window;

pub use document::{Document, Wanted};
#[cfg(feature = "record")]
pub use filming::Filming;
pub use memory::Memory;
pub use pointer::{PointerOnPanel, Viewport};
pub use present::{Classic, Shown};
pub use sandbox::{Look, Sandbox};

use std::path::{Path, PathBuf};
use std::time::Instant;

use bevy::prelude::*;

use super::Verdict;
use super::options::PlayOptions;
use crate::panel::Wish;
use crate::scene::Source;
use crate::view::{self, Quality};
use crate::{Error, Result};

/// What happens in a frame, in this order.
#[derive(SystemSet, Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PlaySystems {
    /// Keys and pointer become wishes, strokes and camera moves.
    Input,
    /// Wishes come true, results and states arrive.
    Update,
    /// Bodies, poses, colours and the camera follow.
    Present,
}

/// The sandbox, without window and panels. Insert a [`Sandbox`] too.
pub struct PlayPlugin;

impl Plugin for PlayPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Viewport>()
            .init_resource::<PointerOnPanel>()
            .configure_sets(Update, (PlaySystems::Input, PlaySystems::Update, PlaySystems::Present).chain())
            .add_systems(Startup, present::spawn_camera)
            .add_systems(
                Update,
                (
                    (keys::press, pointer::handle, pointer::drop_files).chain().in_set(PlaySystems::Input),
                    update.in_set(PlaySystems::Update),
                    (present::bodies, present::poses, present::looks, present::camera)
                        .chain()
                        .in_set(PlaySystems::Present),
                ),
            );
    }
}

fn update(mut sandbox: ResMut<Sandbox>, time: Res<Time>) {
    sandbox.update();
    sandbox.choice.player.advance(time.delta_secs());
}

/// Opens the window and stays until it is closed.
pub(super) fn run(options: &PlayOptions) -> Result<Verdict> {
    start(options, false)
}

/// The same with nothing open but the gallery, to choose from.
pub(super) fn choose() -> Result<Verdict> {
    start(&PlayOptions::default(), true)
}

/// The same with a scene of the gallery open.
pub(super) fn show(name: &str) -> Result<Verdict> {
    start(&PlayOptions { source: Some(Source::Gallery(name.into())), ..PlayOptions::default() }, false)
}

fn start(options: &PlayOptions, gallery: bool) -> Result<Verdict> {
    let started = Instant::now();
    let adapter = view::adapter()?;
    display::check()?;
    let mut sandbox = Sandbox::new(None)?;
    let measured = options.bench.map(|seconds| bench::Bench::new(seconds, options.json, started, adapter.name.clone()));
    if measured.is_some() || options.script.is_some() {
        sandbox.memory.forget();
    }
    sandbox.choice.gallery = gallery;
    if !gallery {
        sandbox.wishes.push(first(options.source.clone()));
    }
    let script = options.script.as_deref().map(script::Script::read).transpose()?;
    let size = match options.size[..] {
        [width, height] => [width, height],
        _ => [1440, 900],
    };

    let mut app = App::new();
    window::build(&mut app, size, Quality::for_adapter(&adapter), measured.is_some());
    app.insert_resource(sandbox).add_plugins(PlayPlugin);
    if let Some(bench) = measured {
        bench::build(&mut app, bench);
    }
    let has_script = script.is_some();
    if let Some(script) = script {
        script::build(&mut app, script);
    }
    match app.run() {
        AppExit::Success => Ok(Verdict::Done),
        AppExit::Error(_) if has_script => Err(Error::input("the script's expectation was not met")),
        AppExit::Error(_) => Err(Error::Fault("the window ended unexpectedly".into())),
    }
}

/// What to open at the start: the built-in homunculus if nothing is named.
fn first(source: Option<Source>) -> Wish {
    match source {
        None => Wish::Open(Source::Gallery("homunculus".into())),
        Some(Source::File(path)) => Wish::OpenPath(path),
        Some(source) => Wish::Open(source),
    }
}

/// Writes a picture where it is not seen half-written.
fn write_picture(picture: &image::DynamicImage, path: &Path) -> Result<PathBuf> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    picture
        .to_rgb8()
        .write_to(&mut bytes, image::ImageFormat::Png)
        .map_err(|e| Error::Fault(format!("a picture to PNG: {e}")))?;
    crate::file::write_atomically(path, |file| std::io::Write::write_all(file, bytes.get_ref()))?;
    Ok(path.into())
}
