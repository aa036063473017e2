//! `homunculus warp`: from a scene to certified files.

use std::path::PathBuf;

use super::load::{self, Loaded};
use super::options::{Colour, WarpOrder};
use super::outputs::Outputs;
use super::{Verdict, cancel, flat, progress, say};
use crate::boundary::Boundary;
use crate::export::report::Report;
use crate::export::{self, GrowthFrame};
use crate::importance;
use crate::run::{self, Outcome};
use crate::scene::Scene;
use crate::{Error, Result};

/// Warps, writes and says how it went.
pub(super) fn run(order: WarpOrder) -> Result<Verdict> {
    let options = &order.options;
    let scene = order.scene()?;
    if let Some(source) = load::picture_source(&scene.source)? {
        let outputs = Outputs::of(options, &scene, true)?;
        let loaded = load::load_picture(&scene, &options.scene, source)?;
        return flat::run(options, &scene, &outputs, loaded);
    }
    if options.scale.is_some() || scene.background.is_some() {
        return Err(Error::input("--scale and --background are for pictures, and this is a mesh; leave them out"));
    }
    let outputs = Outputs::of(options, &scene, false)?;
    let Loaded { boundary, stack, settings, warnings } = load::load(&scene, &options.scene)?;

    let watcher = progress::watcher(options.scene.quiet);
    let outcome = run::warp(&boundary, &stack, &settings, &watcher);
    watcher.finish();
    let outcome = outcome?;
    if cancel::asked() {
        return Err(Error::Cancelled);
    }

    let report = Report::of(&scene, &settings, stack.clamped(), &outcome, warnings);
    let written = write(&outputs, options.colour, options.seconds, &scene, &boundary, &outcome, &report)?;
    if !options.scene.quiet {
        say(&summary(&report, &written));
    }
    Ok(if report.certified() { Verdict::Done } else { Verdict::NotCertified })
}

/// Writes what was ordered, each file whole or not at all. Returns where.
fn write(
    outputs: &Outputs,
    colour: Option<Colour>,
    seconds: f32,
    scene: &Scene,
    boundary: &Boundary,
    outcome: &Outcome,
    report: &Report,
) -> Result<Vec<PathBuf>> {
    let by_importance = importance::colours(&outcome.importance);
    let colours = |default| (colour.unwrap_or(default) == Colour::Importance).then_some(by_importance.as_slice());
    let mut written = Vec::new();
    if let Some(path) = &outputs.mesh {
        let last = outcome.frames.last().ok_or_else(|| Error::Fault("the film is empty".into()))?;
        export::mesh(boundary, &last.positions, colours(Colour::Original), path)?;
        written.push(path.clone());
    }
    if let Some(path) = &outputs.growth {
        let frames: Vec<_> =
            outcome.frames.iter().map(|f| GrowthFrame { lambda: f.lambda, positions: &f.positions }).collect();
        export::growth(boundary, &frames, colours(Colour::Importance), seconds, path, &cancel::asked)?;
        written.push(path.clone());
    }
    written.extend(outputs.write_accounts(scene, report)?);
    Ok(written)
}

/// One line for a person.
pub(super) fn summary(report: &Report, written: &[PathBuf]) -> String {
    let certificate = &report.certificate;
    let verdict = if certificate.certified { "certified" } else { "NOT CERTIFIED" };
    let files = written.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ");
    format!(
        "{verdict}: {} inverted, {} crossings in {} frames; size error p95 {:.1} %; written: {files}",
        certificate.inverted,
        certificate.crossings,
        certificate.frames.len(),
        report.fidelity.p95 * 100.0,
    )
}
