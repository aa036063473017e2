//! Bodies: meshes, in space.

use std::path::Path;
use std::sync::Arc;

use super::{Found, Grown, Inspected, Look, Stopped, Subject};
use crate::boundary::{self, Attribute, Boundary};
use crate::export;
use crate::format::Kind;
use crate::gallery::{self, human::read_values};
use crate::importance::{Layer, Stack};
use crate::run::{self, Content};
use crate::scene::{Scene, Source};
use crate::voxel::check_resolution;
use crate::{Error, Result};

/// A body with its importance.
#[derive(Debug, Clone)]
pub struct Body {
    /// B.
    pub boundary: Arc<Boundary>,
    /// F, with what was painted.
    pub importance: Arc<Stack>,
}

/// What is no other kind is a body.
pub(super) fn find(source: &Source) -> Box<dyn Found> {
    Box::new(Unread(source.clone()))
}

struct Unread(Source);

impl Found for Unread {
    fn kind(&self) -> Kind {
        Kind::Body
    }

    fn open(self: Box<Self>, scene: &Scene) -> Result<Arc<dyn Subject>> {
        let (boundary, stack) = with_layers(scene, read(&self.0)?)?;
        Ok(Arc::new(Body { boundary: Arc::new(boundary), importance: Arc::new(stack) }))
    }

    fn inspect(self: Box<Self>, _: Option<&str>, resolution: u32) -> Result<Inspected> {
        check_resolution(resolution)?;
        let boundary = read(&self.0)?;
        let (input, domain) = run::inspect(&boundary, resolution)?;
        let warnings = boundary.warnings.clone();
        Ok(Inspected { boundary, input, domain, picture: None, warnings })
    }
}

impl Subject for Body {
    fn kind(&self) -> Kind {
        Kind::Body
    }

    fn warnings(&self) -> Vec<String> {
        [&self.boundary.warnings, self.importance.warnings()].concat()
    }

    fn clamped(&self) -> usize {
        self.importance.clamped()
    }

    fn unchanged(&self) -> &'static str {
        "no importance was given, so the shape stays as it is; see --sphere in homunculus warp --help"
    }

    fn content(&self) -> Content {
        Content::Body(self.boundary.clone(), self.importance.clone())
    }

    fn surface(&self) -> &Arc<Boundary> {
        &self.boundary
    }

    fn stack(&self) -> Arc<Stack> {
        self.importance.clone()
    }

    fn painted(&self, differences: Vec<f64>) -> Arc<dyn Subject> {
        let importance = Arc::new(Stack::clone(&self.importance).painted(differences));
        Arc::new(Self { boundary: self.boundary.clone(), importance })
    }

    fn with_layers(&self, scene: &Scene) -> Result<Arc<dyn Subject>> {
        let (boundary, stack) = with_layers(scene, Boundary::clone(&self.boundary))?;
        let names = |boundary: &Boundary| boundary.regions.as_ref().map(|r| (r.names.clone(), r.of_vertex.clone()));
        // The same boundary stays the same `Arc`, by which the solver and the view know that nothing else changed.
        let is_same = names(&self.boundary) == names(&boundary);
        let boundary = if is_same { self.boundary.clone() } else { Arc::new(boundary) };
        Ok(Arc::new(Self { boundary, importance: Arc::new(stack) }))
    }

    fn write_result(&self, grown: &Grown, look: &Look, path: &Path) -> Result<()> {
        let last = grown.outcome.frames.last().ok_or_else(|| Error::Fault("the film is empty".into()))?;
        let colours = grown.colours(look.coloured.unwrap_or(false));
        export::mesh(grown.boundary, &last.positions, colours.as_deref(), path)
    }

    fn write_growth(&self, grown: &Grown, look: &Look, path: &Path, stopped: Stopped) -> Result<()> {
        let colours = grown.colours(look.coloured.unwrap_or(true));
        export::growth(grown.boundary, &grown.frames(), colours.as_deref(), look.seconds, path, stopped)
    }
}

/// The boundary a source names. A built-in scene brings its importance as the vertex attribute [`OWN`].
fn read(source: &Source) -> Result<Boundary> {
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

/// A boundary with what a scene's layers know of it, and their importance: all but the strokes.
fn with_layers(scene: &Scene, mut boundary: Boundary) -> Result<(Boundary, Stack)> {
    let layers = layers(scene, &mut boundary)?;
    let stack = Stack::load(&layers, scene.base, scene.clamp, &boundary, Path::new(""))?;
    if let Some(regions) = stack.regions() {
        boundary.regions = Some(regions.clone());
    }
    Ok((boundary, stack))
}

/// The scene's layers. A built-in scene's own importance lies below them, unless a table of its regions
/// (`region,importance`) replaces it.
fn layers(scene: &Scene, boundary: &mut Boundary) -> Result<Vec<Layer>> {
    let Source::Gallery(name) = &scene.source else { return Ok(scene.shown_layers()) };
    let mut layers = vec![Layer::Attribute { name: OWN.into(), range: None }];
    for layer in scene.shown_layers() {
        let Some(path) = layer.table_of_regions()? else {
            layers.push(layer);
            continue;
        };
        let text = std::fs::read_to_string(path).map_err(|e| Error::reading(path, e))?;
        let values = read_values(&path.display().to_string(), &text)?;
        let model = gallery::open(name)?.model;
        let importance = gallery::with_values(&model, &values).map_err(|error| Error::in_file(path, error))?;
        *boundary = with_own(std::mem::take(boundary), importance);
    }
    Ok(layers)
}
