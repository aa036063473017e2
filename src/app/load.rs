//! From a scene to what the engine takes: files read, importance evaluated, warnings told.

use std::io::Read as _;
use std::path::Path;

use super::scene_options::SceneOptions;
use super::{cancel, note};
use crate::boundary::{self, Attribute, Boundary, Regions};
use crate::gallery::human::read_values;
use crate::gallery::picture::PictureScene;
use crate::importance::{Layer, Stack};
use crate::picture::importance::Field;
use crate::picture::{self, Cut, Picture};
use crate::scene::{Scene, Source};
use crate::schedule::Settings;
use crate::voxel::Flat;
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
    begin(options)?;
    let (boundary, stack) = prepare(scene, open(&scene.source)?)?;
    let stack = paint::over(&boundary, stack, &scene.strokes)?;
    let warnings = warnings(scene, &boundary, &stack);
    tell(&warnings, options);
    Ok(Loaded { boundary, stack, settings: settings(scene, options), warnings })
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

/// A picture and what is asked of it.
pub(super) struct LoadedPicture {
    pub picture: Picture,
    pub field: Field,
    /// Both, as the engine takes them.
    pub flat: Flat,
    pub settings: Settings,
    /// Told already, and for the report.
    pub warnings: Vec<String>,
}

/// A picture that is not read yet.
pub(super) enum PictureSource {
    /// A file's bytes.
    Bytes(Vec<u8>),
    /// A built-in one.
    BuiltIn(Box<PictureScene>),
}

/// The picture a scene's source is, if it is one.
pub(super) fn picture_source(scene: &Scene) -> Result<Option<PictureSource>> {
    let path = match &scene.source {
        Source::File(path) => path,
        Source::Gallery(name) if scene.source.is_picture() => {
            return gallery::picture::open(name).map(|scene| Some(PictureSource::BuiltIn(Box::new(scene))));
        }
        Source::Gallery(_) => return Ok(None),
    };
    let mut start = Vec::new();
    let file = std::fs::File::open(path).and_then(|file| match file.metadata()?.is_file() {
        true => Ok(file),
        false => Err(std::io::ErrorKind::IsADirectory.into()),
    });
    // What cannot be read is told by the reader of meshes, which knows more about it.
    let Ok(file) = file else { return Ok(None) };
    if file.take(MAGIC_BYTES).read_to_end(&mut start).is_err() || !picture::is_picture(&start) {
        return Ok(None);
    }
    std::fs::read(path).map(|bytes| Some(PictureSource::Bytes(bytes))).map_err(|e| Error::reading(path, e))
}

/// By so many bytes a picture is recognised.
const MAGIC_BYTES: u64 = 64;

/// Reads what a scene of a picture names; as [`load`].
pub(super) fn load_picture(scene: &Scene, options: &SceneOptions, source: PictureSource) -> Result<LoadedPicture> {
    begin(options)?;
    let background = scene.background.as_deref().map(str::parse).transpose();
    let background = background.map_err(|sentence: String| Error::input(format!("--background: {sentence}")))?;
    let name = scene.source.to_string();
    let (picture, own) = match source {
        PictureSource::Bytes(bytes) => {
            (picture::read_bytes(&name, &bytes, &Cut { background, ..Cut::default() })?, None)
        }
        PictureSource::BuiltIn(built_in) => (built_in.picture, Some(built_in.field)),
    };
    let layers = scene.shown_layers().iter().map(picture_layer).collect::<Result<Vec<_>>>()?;
    // Importance that is given takes the place of a built-in picture's own.
    let (field, is_own) = match own.filter(|_| layers.is_empty()) {
        Some(field) => (field, true),
        None => (Field::load(&layers, scene.base, scene.clamp, &picture, Path::new(""))?, false),
    };
    let mut warnings = picture.warnings.clone();
    warnings.extend_from_slice(&field.warnings);
    if layers.is_empty() && !is_own {
        warnings.push("no importance was given, so the picture stays as it is; see --sphere and --regions".into());
    }
    tell(&warnings, options);
    let regions = field.regions.as_ref().map(|r| Regions { names: r.names.clone(), of_vertex: r.of_pixel.clone() });
    let flat =
        Flat { name, size: picture.size, inside: picture.domain.clone(), importance: field.values.clone(), regions };
    Ok(LoadedPicture { picture, field, flat, settings: settings(scene, options), warnings })
}

/// A layer as a picture takes it.
fn picture_layer(layer: &Layer) -> Result<picture::importance::Layer> {
    use picture::importance::Layer as Of;
    Ok(match layer.clone() {
        Layer::Sphere { centre: [x, y, _], radius, value } => Of::Disc { centre: [x, y], radius, value },
        Layer::Image { path, range } => Of::Image { path, range },
        Layer::Regions { regions, values, per_area } => Of::Regions { ids: regions, values, per_area },
        _ => {
            let sentence = "a picture has no vertices, so --attribute and --values without --regions say nothing about it; \
                            use --image, --sphere or --regions";
            return Err(Error::input(sentence));
        }
    })
}

/// From here on Ctrl-C asks rather than kills, and as many threads work as were asked for.
fn begin(options: &SceneOptions) -> Result<()> {
    if let Some(threads) = options.threads {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.into());
        pool.build_global().map_err(|e| Error::Fault(format!("starting {threads} threads: {e}")))?;
    }
    cancel::listen();
    Ok(())
}

fn tell(warnings: &[String], options: &SceneOptions) {
    if !options.quiet {
        warnings.iter().for_each(|warning| note(&format!("warning: {warning}")));
    }
}

fn settings(scene: &Scene, options: &SceneOptions) -> Settings {
    Settings {
        resolution: scene.resolution,
        fidelity: scene.fidelity,
        keys: scene.keys,
        reference: options.reference.map(Into::into),
    }
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
