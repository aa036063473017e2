//! `homunculus warp`: from a scene to certified files.

use std::path::PathBuf;

use super::load::{self, Loaded};
use super::options::{Colour, WarpOrder};
use super::outputs::Outputs;
use super::{Verdict, cancel, progress, say};
use crate::boundary::Boundary;
use crate::export::report::{self, Report};
use crate::export::{self, GrowthFrame};
use crate::importance;
use crate::scene::Scene;
use crate::schedule::{self, Outcome};
use crate::{Error, Result};

/// Warps, writes and says how it went.
pub(super) fn run(order: WarpOrder) -> Result<Verdict> {
    let options = &order.options;
    let scene = order.scene()?;
    let outputs = Outputs::of(options, &scene)?;
    let Loaded { boundary, stack, settings, warnings } = load::load(&scene, &options.scene)?;

    let watcher = progress::watcher(options.scene.quiet);
    let outcome = schedule::warp(&boundary, &stack, &settings, &watcher);
    watcher.finish();
    let outcome = outcome?;
    if cancel::asked() {
        return Err(Error::Cancelled);
    }

    let report = Report::of(&scene, &settings, &stack, &outcome, warnings);
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
        export::growth(boundary, &frames, colours(Colour::Importance), seconds, path)?;
        written.push(path.clone());
    }
    let report_path = if report.certified() { outputs.report.clone() } else { outputs.report_beside() };
    if let Some(path) = report_path {
        report::write(report, &path)?;
        written.push(path);
    }
    if let Some(path) = &outputs.scene {
        scene.save(path)?;
        written.push(path.clone());
    }
    Ok(written)
}

/// One line for a person.
fn summary(report: &Report, written: &[PathBuf]) -> String {
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
