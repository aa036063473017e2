//! `homunculus warp`: from a scene to certified files.

use std::path::{Path, PathBuf};

use super::options::{Colour, WarpOrder};
use super::outputs::Outputs;
use super::{Verdict, cancel, note, progress, say};
use crate::boundary::{self, Attribute, Boundary};
use crate::export::report::{self, Report};
use crate::export::{self, GrowthFrame};
use crate::gallery::human::read_values;
use crate::importance::{self, Layer, Stack};
use crate::scene::{Scene, Source};
use crate::schedule::{self, Outcome, Settings};
use crate::{Error, Result, gallery, paint};

/// Warps, writes and says how it went.
pub(super) fn run(order: WarpOrder) -> Result<Verdict> {
    let options = &order.options;
    let scene = order.scene()?;
    let outputs = Outputs::of(options, &scene)?;
    if let Some(threads) = options.threads {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.into());
        pool.build_global().map_err(|e| Error::Fault(format!("starting {threads} threads: {e}")))?;
    }
    cancel::listen();

    let (boundary, stack) = prepare(&scene, open(&scene.source)?)?;
    let stack = paint::over(&boundary, stack, &scene.strokes)?;
    let warnings = warnings(&scene, &boundary, &stack);
    if !options.quiet {
        warnings.iter().for_each(|warning| note(&format!("warning: {warning}")));
    }

    let settings = Settings {
        resolution: scene.resolution,
        fidelity: scene.fidelity,
        keys: scene.keys,
        reference: options.reference.map(Into::into),
    };
    let watcher = progress::watcher(options.quiet);
    let outcome = schedule::warp(&boundary, &stack, &settings, &watcher);
    watcher.finish();
    let outcome = outcome?;
    if cancel::asked() {
        return Err(Error::Cancelled);
    }

    let report = Report::of(&scene, &settings, &stack, &outcome, warnings);
    let written = write(&outputs, options.colour, options.seconds, &scene, &boundary, &outcome, &report)?;
    if !options.quiet {
        say(&summary(&report, &written));
    }
    Ok(if report.certified() { Verdict::Done } else { Verdict::NotCertified })
}

/// A scene's boundary with what its layers know of it, and their importance: all but the strokes.
pub(super) fn prepare(scene: &Scene, mut boundary: Boundary) -> Result<(Boundary, Stack)> {
    let layers = layers(scene, &mut boundary)?;
    let stack = Stack::load(&layers, scene.base, scene.clamp, &boundary, Path::new(""))?;
    if let Some(regions) = stack.regions() {
        boundary.regions = Some(regions.clone());
    }
    Ok((boundary, stack))
}

/// The boundary a source names. A built-in scene brings its importance as the vertex attribute [`OWN`].
pub(super) fn open(source: &Source) -> Result<Boundary> {
    match source {
        Source::File(path) => boundary::read(path),
        Source::Gallery(name) => {
            let scene = gallery::open(name)?;
            Ok(with_own(scene.model.boundary, scene.importance))
        }
    }
}

/// The attribute that holds a built-in scene's own importance.
const OWN: &str = "importance";

fn with_own(mut boundary: Boundary, importance: Vec<f32>) -> Boundary {
    boundary.attributes.retain(|a| a.name != OWN);
    boundary.attributes.push(Attribute { name: OWN.into(), values: importance });
    boundary
}

/// The scene's layers. A built-in scene's own importance lies below them, unless a table of its regions
/// (`region,importance`) replaces it.
fn layers(scene: &Scene, boundary: &mut Boundary) -> Result<Vec<Layer>> {
    let Source::Gallery(name) = &scene.source else { return Ok(scene.shown_layers()) };
    let mut layers = vec![Layer::Attribute { name: OWN.into(), range: None }];
    for layer in &scene.shown_layers() {
        match layer {
            Layer::Values { path } if is_table_of_regions(path)? => {
                let text = std::fs::read_to_string(path).map_err(|e| Error::reading(path, e))?;
                let values = read_values(&path.display().to_string(), &text)?;
                let model = gallery::open(name)?.model;
                let importance = gallery::with_values(&model, &values).map_err(|error| Error::in_file(path, error))?;
                *boundary = with_own(std::mem::take(boundary), importance);
            }
            layer => layers.push(layer.clone()),
        }
    }
    Ok(layers)
}

/// Whether the first line that is no comment names a column `region`.
fn is_table_of_regions(path: &Path) -> Result<bool> {
    let text = std::fs::read(path).map_err(|e| Error::reading(path, e))?;
    let text = String::from_utf8_lossy(&text);
    let header = text.lines().find(|line| !line.starts_with('#')).unwrap_or_default();
    Ok(header.split(',').any(|column| column.trim().trim_start_matches('\u{feff}') == "region"))
}

fn warnings(scene: &Scene, boundary: &Boundary, stack: &Stack) -> Vec<String> {
    let mut warnings = boundary.warnings.clone();
    warnings.extend_from_slice(stack.warnings());
    if stack.is_uniform() && scene.base == 1.0 {
        warnings.push(
            "no importance was given, so the shape stays as it is; see --sphere in homunculus warp --help".into(),
        );
    }
    warnings
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
