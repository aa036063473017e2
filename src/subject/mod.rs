//! What is warped, from its source to the files that come of it: one road for all kinds.
//!
//! ```text
//! find → open (layers) → paint → content → solve → report, result, growth, film
//! ```
//!
//! A [`Subject`] is something that has been read, with its importance: a body or a picture. Whoever loads, paints, solves,
//! reports and writes asks it, and not of which kind it is. Another kind is a file here, a line in [`find`], and a
//! [`Kind`] of its own.

mod body;
mod picture;

use std::fmt::Debug;
use std::path::Path;
use std::sync::Arc;

use glam::{DVec3, Vec3A};
use image::RgbImage;

pub use body::Body;

use crate::Result;
use crate::boundary::Boundary;
use crate::export::GrowthFrame;
use crate::export::report::{AreaReport, PictureReport, Report};
use crate::format::Kind;
use crate::importance::{self, Stack};
use crate::paint::{self, Edit, Under};
use crate::run::{Content, DomainSummary, InputSummary, Outcome, Solved};
use crate::scene::{Draft, Scene, Source};
use crate::settings::Settings;
use crate::voxel::Complex;

/// Importance that is being painted on a subject.
pub type Painting = paint::Painting<Arc<dyn Subject>>;

/// Something to be warped, read and with its importance.
pub trait Subject: Debug + Send + Sync {
    /// Of which kind it is.
    fn kind(&self) -> Kind;

    /// Sentences about what was read.
    fn warnings(&self) -> Vec<String>;

    /// How many values of importance were moved or left out.
    fn clamped(&self) -> usize;

    /// A sentence for who asks for nothing.
    fn unchanged(&self) -> &'static str;

    /// What the engine takes.
    fn content(&self) -> Content;

    /// What is painted on: strokes are kept at its vertices.
    fn surface(&self) -> &Arc<Boundary>;

    /// What the layers say there.
    fn stack(&self) -> Arc<Stack>;

    /// The same with `[vertices]` of the surface added to ln f by hand.
    fn painted(&self, differences: Vec<f64>) -> Arc<dyn Subject>;

    /// The same, unpainted, with the layers of another scene; its source is not read again.
    ///
    /// # Errors
    /// What the layers refuse.
    fn with_layers(&self, scene: &Scene) -> Result<Arc<dyn Subject>>;

    /// `[vertices]` of what is drawn: values of the surface's vertices. `None` where the surface itself is drawn.
    fn carried(&self, _values: &[f64], _to: &Boundary) -> Option<Vec<f64>> {
        None
    }

    /// The surface's vertex nearest to a place, source units. `None` where the surface itself is drawn.
    fn vertex_at(&self, _place: DVec3) -> Option<u32> {
        None
    }

    /// The boundary that was solved as it is to be drawn.
    ///
    /// # Errors
    /// A fault where a texture cannot be encoded.
    fn drawn(&self, boundary: &Arc<Boundary>) -> Result<Arc<Boundary>> {
        Ok(boundary.clone())
    }

    /// `[values]` of importance that colours are to tell apart.
    fn asked(&self, outcome: &Outcome) -> Vec<f32> {
        outcome.importance.clone()
    }

    /// Areas of regions, where regions ask for area.
    fn areas(&self, _grown: &Grown) -> Option<AreaReport> {
        None
    }

    /// Writes the last state, in the format of the file's name.
    ///
    /// # Errors
    /// A name of no such format, or what the system refuses; nothing is left then.
    fn write_result(&self, grown: &Grown, look: &Look, path: &Path) -> Result<()>;

    /// Writes all states as an animation, in the format of the file's name.
    ///
    /// # Errors
    /// As [`write_result`](Self::write_result); [`Cancelled`](crate::Error::Cancelled) when `stopped` says so.
    fn write_growth(&self, grown: &Grown, look: &Look, path: &Path, stopped: Stopped) -> Result<()>;

    /// Pictures of `side` pixels, where it takes no renderer to draw it: at rest, its importance by the colours given, Eq. 1
    /// alone with its crossings, and the last state.
    fn portraits(&self, _solved: &Solved, _side: u32, _colour: Colouring) -> Option<Result<[RgbImage; 4]>> {
        None
    }
}

/// Asked now and then by what takes long: whether to stop.
pub type Stopped<'a> = &'a (dyn Fn() -> bool + Sync);

/// The colour of a value of importance, sRGB.
pub type Colouring<'a> = &'a dyn Fn(f32) -> [u8; 3];

/// How results are to look.
#[derive(Debug, Clone, Copy)]
pub struct Look {
    /// Of a picture: pixels of the result along one of the input, > 0.
    pub scale: f64,
    /// Length of the growth, > 0.
    pub seconds: f32,
    /// Whether vertices have the colours of importance; what is usual where nothing is said.
    pub coloured: Option<bool>,
}

/// What has come of a subject.
#[derive(Clone, Copy)]
pub struct Grown<'a> {
    /// B; of a picture the flat mesh it is drawn on.
    pub boundary: &'a Arc<Boundary>,
    /// States and what was found.
    pub outcome: &'a Outcome,
    /// C and C_t.
    pub complex: &'a Complex,
    /// `[nodes]` the last state, in cells; empty where there is none.
    pub last: &'a [Vec3A],
}

impl<'a> From<&'a Solved> for Grown<'a> {
    fn from(solved: &'a Solved) -> Self {
        let last = solved.film.keyframes().last().map_or(&[][..], |last| &last.positions);
        Self { boundary: &solved.boundary, outcome: &solved.outcome, complex: &solved.complex, last }
    }
}

impl Grown<'_> {
    /// `[vertices]` the colours of importance, if they are wanted.
    fn colours(&self, wanted: bool) -> Option<Vec<[f32; 3]>> {
        wanted.then(|| importance::colours(&self.outcome.importance))
    }

    /// The states as a growth is written of them.
    fn frames(&self) -> Vec<GrowthFrame<'_>> {
        let frames = self.outcome.frames.iter();
        frames.map(|frame| GrowthFrame { lambda: frame.lambda, positions: &frame.positions }).collect()
    }
}

/// Something that has been found, and not read yet.
pub trait Found {
    /// Of which kind it is.
    fn kind(&self) -> Kind;

    /// Reads it, with the layers of its scene; strokes are left to [`painted`].
    ///
    /// # Errors
    /// What the readers and the layers refuse.
    fn open(self: Box<Self>, scene: &Scene) -> Result<Arc<dyn Subject>>;

    /// Reads it, to look at it alone. `background`: `COLOUR,TOLERANCE` of what is cut out of a picture.
    ///
    /// # Errors
    /// What the readers refuse, or a resolution out of range.
    fn inspect(self: Box<Self>, background: Option<&str>, resolution: u32) -> Result<Inspected>;
}

/// What is in a source, and what would be solved.
pub struct Inspected {
    /// B; of a picture the flat mesh it would be drawn on.
    pub boundary: Boundary,
    /// What was read.
    pub input: InputSummary,
    /// What would be voxelized.
    pub domain: DomainSummary,
    /// Of a picture.
    pub picture: Option<PictureReport>,
    /// Sentences about what was read.
    pub warnings: Vec<String>,
}

/// Finds what a source is; a file is told by its content.
///
/// # Errors
/// A file that is known and cannot be read, or a name that the gallery does not have.
pub fn find(source: &Source) -> Result<Box<dyn Found>> {
    // What nobody knows is a body: its readers say what is wrong with it.
    Ok(match picture::find(source)? {
        Some(found) => found,
        None => body::find(source),
    })
}

/// The subject with a scene's strokes over its layers.
///
/// # Errors
/// Names the stroke, the value and its range, or the region that is not there.
pub fn painted(subject: Arc<dyn Subject>, strokes: &[Edit]) -> Result<Arc<dyn Subject>> {
    if strokes.is_empty() {
        return Ok(subject);
    }
    paint::differences(subject.surface(), &subject.stack(), strokes).map(|differences| subject.painted(differences))
}

/// A subject with its layers, to be painted over: of a scene, or one that is known already with the layers of that scene.
///
/// # Errors
/// What the readers and the layers refuse.
pub fn under(scene: &Scene, known: Option<&Arc<dyn Subject>>) -> Result<Under<Arc<dyn Subject>>> {
    let subject = match known {
        Some(known) => known.with_layers(scene)?,
        None => find(&scene.source)?.open(scene)?,
    };
    let Draft { layers, hidden, base, clamp, .. } = Draft::clone(scene);
    Ok(Under { layers, hidden, base, clamp, boundary: subject.surface().clone(), stack: subject.stack(), subject })
}

/// Whether a scene asks for nothing, so that its subject stays as it is.
pub fn asks_for_nothing(scene: &Scene) -> bool {
    let has_own = matches!(scene.source, Source::Gallery(_));
    !has_own && scene.shown_layers().is_empty() && scene.strokes.is_empty() && scene.base == 1.0
}

/// What is told of a subject that has grown. `warnings`: what was told on the way.
pub fn report(
    subject: &dyn Subject,
    scene: &Scene,
    settings: &Settings,
    grown: &Grown,
    warnings: Vec<String>,
) -> Report {
    let mut report = Report::of(scene, settings, subject.clamped(), grown.outcome, warnings);
    report.take_areas(subject.areas(grown));
    report
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paint::Fill;

    fn open(name: &str) -> (Scene, Arc<dyn Subject>) {
        let scene = Scene::new(Draft::fresh(&Source::Gallery(name.into()))).unwrap();
        let subject = find(&scene.source).unwrap().open(&scene).unwrap();
        (scene, subject)
    }

    #[test]
    fn kinds_are_found_and_take_paint_and_other_layers_alike() {
        for (name, kind) in [("hand", Kind::Body), ("magnet", Kind::Picture)] {
            let (scene, subject) = open(name);
            assert_eq!((subject.kind(), scene.source.kind()), (kind, kind), "{name}");
            assert!(!asks_for_nothing(&scene), "{name} brings its own");
            let same = painted(subject.clone(), &[]).unwrap();
            assert!(Arc::ptr_eq(&same, &subject), "no stroke, no change");
            let fill = Edit::Fill(Fill::All { value: 2.0 });
            let filled = painted(subject.clone(), &[fill]).unwrap();
            let at = |subject: &dyn Subject| match subject.content() {
                Content::Body(boundary, stack) => stack.at_vertices(&boundary),
                Content::Picture(flat) => {
                    flat.importance.iter().zip(&flat.inside).filter(|(_, inside)| **inside).map(|(f, _)| *f).collect()
                }
            };
            let mean = |values: Vec<f32>| values.iter().map(|f| f.ln()).sum::<f32>() / values.len() as f32;
            assert!((mean(at(&*filled)) - 2.0_f32.ln()).abs() < 0.05, "{name} is filled with 2");
            assert!((mean(at(&*subject)) - 2.0_f32.ln()).abs() > 0.1, "sabotage: before it was something else");
            // The same layers again: nothing is read twice, and the surface stays the very same.
            let again = filled.with_layers(&scene).unwrap();
            assert_eq!(at(&*again), at(&*subject), "{name}");
            assert!(Arc::ptr_eq(again.surface(), subject.surface()), "{name}");
        }
    }
}
