//! From a scene to what the engine takes: files read, importance evaluated, warnings told.

use std::io::Read as _;
use std::path::Path;

use super::scene_options::SceneOptions;
use super::{cancel, note};
use crate::boundary::{self, Attribute, Boundary, Regions};
use crate::gallery::human::read_values;
use crate::gallery::picture::PictureScene;
use crate::importance::field::Field;
use crate::importance::{Layer, Stack};
use crate::paint::Ground;
use crate::picture::{self, Cut, Picture};
use crate::scene::{Scene, Source};
use crate::settings::Settings;
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

/// The picture a source is, if it is one; a file is told by its content.
pub(super) fn picture_source(source: &Source) -> Result<Option<PictureSource>> {
    let path = match source {
        Source::File(path) => path,
        Source::Gallery(name) if source.is_picture() => {
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

impl PictureSource {
    /// The picture, cut out of its background (`COLOUR,TOLERANCE`), and the importance a built-in one brings.
    pub fn read(self, name: &str, background: Option<&str>) -> Result<(Picture, Option<Field>)> {
        let background = background.map(str::parse).transpose();
        let background = background.map_err(|sentence: String| Error::input(format!("--background: {sentence}")))?;
        Ok(match self {
            Self::Bytes(bytes) => (picture::read_bytes(name, &bytes, &Cut { background, ..Cut::default() })?, None),
            Self::BuiltIn(built_in) => (built_in.picture, Some(built_in.field)),
        })
    }
}

/// Reads what a scene of a picture names; as [`load`].
pub(super) fn load_picture(scene: &Scene, options: &SceneOptions, source: PictureSource) -> Result<LoadedPicture> {
    begin(options)?;
    let name = scene.source.to_string();
    let (picture, own) = source.read(&name, scene.background.as_deref())?;
    let is_said = own.is_some() || !scene.shown_layers().is_empty() || !scene.strokes.is_empty();
    let field = picture_field(scene, &picture, own.as_ref())?;
    let (picture, field) = if scene.strokes.is_empty() {
        (picture, field)
    } else {
        let painted = paint::over_picture(Ground::new(&name, picture, None, field)?, &scene.strokes)?;
        ((*painted.ground.picture).clone(), painted.field())
    };
    let mut warnings = picture.warnings.clone();
    warnings.extend_from_slice(&field.warnings);
    if !is_said {
        warnings.push("no importance was given, so the picture stays as it is; see --sphere and --regions".into());
    }
    tell(&warnings, options);
    let flat = flat(name, &picture, &field);
    Ok(LoadedPicture { picture, field, flat, settings: settings(scene, options), warnings })
}

/// A picture and its importance as the engine takes them.
pub(super) fn flat(name: String, picture: &Picture, field: &Field) -> Flat {
    let regions = field.regions.as_ref().map(|r| Regions { names: r.names.clone(), of_vertex: r.of_pixel.clone() });
    Flat { name, size: picture.size, inside: picture.domain.clone(), importance: field.values.clone(), regions }
}

/// What a scene's layers say of a picture. Importance that is given takes the place of a built-in picture's own.
pub(super) fn picture_field(scene: &Scene, picture: &Picture, own: Option<&Field>) -> Result<Field> {
    let layers = scene.shown_layers().iter().map(picture_layer).collect::<Result<Vec<_>>>()?;
    match own.filter(|_| layers.is_empty()) {
        Some(field) => Ok(field.clone()),
        None => Field::load(&layers, scene.base, scene.clamp, picture, Path::new("")),
    }
}

/// A layer as a picture takes it.
fn picture_layer(layer: &Layer) -> Result<crate::importance::field::Layer> {
    use crate::importance::field::Layer as Of;
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
    Settings { reference: options.reference.map(Into::into), ..settings_of(scene) }
}

/// How a scene is solved, by the method itself.
pub(super) fn settings_of(scene: &Scene) -> Settings {
    Settings { resolution: scene.resolution, fidelity: scene.fidelity, keys: scene.keys, reference: None }
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
    Ok(has_column(&text, "region"))
}

/// Whether the first line of a table that is no comment names a column.
pub(super) fn has_column(table: &str, name: &str) -> bool {
    let header = table.lines().find(|line| !line.starts_with('#')).unwrap_or_default();
    header.split(',').any(|column| column.trim().trim_start_matches('\u{feff}') == name)
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
