//! `homunculus record`: from a scene to a film of its growth.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::load::{self, Loaded, only_of_pictures};
use super::options::{RecordOptions, RecordOrder};
use super::outputs::{check_extension, check_places};
use super::{Verdict, note, progress, say};
use crate::Result;
use crate::diagnostics::human_bytes;
use crate::export::report::Report;
use crate::format::Use;
use crate::record::{self, Account, Actor, Settings, sidecar};
use crate::scene::Scene;
use crate::subject::{self, Grown};

/// What lies beside a film.
#[derive(Serialize)]
struct Beside<'a> {
    film: &'a Path,
    version: &'static str,
    /// Nothing is drawn at random.
    seed: Option<u64>,
    scene: &'a crate::scene::Draft,
    recording: &'a Account,
    report: &'a Report,
}

/// Warps, films and says how it went.
pub(super) fn run(order: &RecordOrder) -> Result<Verdict> {
    let options = &order.options;
    let scene = options.scene.scene(&order.layers)?;
    load::begin(&options.scene)?;
    let found = subject::find(&scene.source)?;
    let settings = options.settings(found.kind().is_flat())?;
    only_of_pictures(found.kind(), "--background", scene.background.is_some())?;
    check_outputs(options, &settings, &scene)?;
    let adapter = record::check(&settings, &options.output)?;
    let quiet = options.scene.quiet;
    if adapter.is_software && !quiet {
        note(&format!("drawing with {} (no GPU): a few frames per second", adapter.name));
    }
    let loaded = Loaded::new(&scene, &options.scene, found)?;
    let solved = loaded.solve()?;
    let report = loaded.report(&scene, &Grown::from(&solved));
    let mut actor = Actor::new(loaded.subject.drawn(&solved.boundary)?, solved);
    let watcher = progress::watcher(quiet);
    let take = record::shoot(&mut actor, &settings, &options.output, &watcher, |_| {});
    watcher.finish();
    let take = take?;
    let account = take.account.clone();
    let beside = Beside {
        film: options.output.file_name().map_or(&options.output, Path::new),
        version: env!("CARGO_PKG_VERSION"),
        seed: None,
        scene: &scene,
        recording: &account,
        report: &report,
    };
    let written = take.keep(&beside)?;
    if let Some(path) = &options.scene.save_scene {
        scene.save(path)?;
    }
    if !quiet {
        say(&summary(&account, written.iter().chain(&options.scene.save_scene)));
    }
    Ok(if account.certified { Verdict::Done } else { Verdict::NotCertified })
}

/// Whether all files can come to lie where they are wanted.
fn check_outputs(options: &RecordOptions, settings: &Settings, scene: &Scene) -> Result<()> {
    let film = &options.output;
    check_extension(&options.scene.save_scene, "--save-scene", Use::Scene)?;
    let sidecar = sidecar(film);
    let files = [Some(&sidecar), options.scene.save_scene.as_ref()].into_iter().flatten().map(PathBuf::as_path);
    let is_folder = record::encode::Format::of(film, settings.still.is_some())? == record::encode::Format::PngFolder;
    // A folder is checked by its encoder.
    check_places(scene, files.chain((!is_folder).then_some(film.as_path())))
}

/// One line for a person.
fn summary<'a>(account: &Account, written: impl Iterator<Item = &'a PathBuf>) -> String {
    let verdict = if account.certified { "certified" } else { "NOT CERTIFIED" };
    let files = written.map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ");
    let bytes = human_bytes(account.bytes as f64);
    let (drawn, encoded) = (account.render_frames_per_second, account.encode_frames_per_second);
    match account.frames.len() {
        1 => {
            format!(
                "{verdict}; {bytes}; drawn in {:.1} s, encoded in {:.1} s; written: {files}",
                1.0 / drawn,
                1.0 / encoded
            )
        }
        frames => format!(
            "{verdict} in {frames} frames; {bytes}; drawn at {drawn:.1}, encoded at {encoded:.0} frames per second; \
             written: {files}"
        ),
    }
}
