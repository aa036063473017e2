//! From a scene to what the engine takes: files read, importance evaluated, warnings told.

use std::path::Path;

use super::scene_options::SceneOptions;
use super::{cancel, note};
use crate::boundary::{self, Attribute, Boundary};
use crate::gallery::human::read_values;
use crate::importance::{Layer, Stack};
use crate::scene::{Scene, Source};
use crate::schedule::Settings;
use crate::{Error, Result, gallery, paint};

/// What the engine takes.
pub(super) struct Loaded {
    pub boundary: Boundary,
    pub stack: Stack,
    pub settings: Settings,
    /// Told already, and for the report.
    pub warnings: Vec<String>,
}

/// Reads what a scene names. From here on Ctrl-C asks rather than kills, and as many threads work as were asked for.
pub(super) fn load(scene: &Scene, options: &SceneOptions) -> Result<Loaded> {
    if let Some(threads) = options.threads {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.into());
        pool.build_global().map_err(|e| Error::Fault(format!("starting {threads} threads: {e}")))?;
    }
    cancel::listen();

    let (boundary, stack) = prepare(scene, open(&scene.source)?)?;
    let stack = paint::over(&boundary, stack, &scene.strokes)?;
    let warnings = warnings(scene, &boundary, &stack);
    if !options.quiet {
        warnings.iter().for_each(|warning| note(&format!("warning: {warning}")));
    }
    let settings = Settings {
        resolution: scene.resolution,
        fidelity: scene.fidelity,
        keys: scene.keys,
        reference: options.reference.map(Into::into),
    };
    Ok(Loaded { boundary, stack, settings, warnings })
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
