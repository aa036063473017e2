//! What is open: a scene with the importance that is being painted on it.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::boundary::Boundary;
use crate::format::{Kind, Use};
use crate::importance::Layer;
use crate::paint::{Canvas, Under};
use crate::scene::{Draft, Scene, Source};
use crate::settings::Settings;
use crate::subject::{self, Painting, Subject};
use crate::view::{Picker, RestShape};
use crate::{Error, Result};

/// A scene that is open.
pub struct Document {
    /// Source and settings; layers and strokes are the painting's.
    draft: Draft,
    /// The scene file, if it has one.
    pub file: Option<PathBuf>,
    /// Importance.
    pub painting: Painting,
    /// Sentences about what was read.
    pub warnings: Vec<String>,
    /// The surface at rest, ready to be pointed at, and which surface it is.
    picking: (Arc<Boundary>, Arc<RestShape>),
    /// Rises with each change of the settings.
    settings_version: u64,
    saved: (u64, u64),
}

/// What can be opened.
#[derive(Debug, Clone)]
pub enum Wanted {
    /// A mesh or a built-in model, with settings that suit it.
    Source(Source),
    /// A scene file.
    Scene(PathBuf),
    /// What was kept of a session that was not closed; it has no file of its own.
    Autosave(PathBuf),
}

impl Document {
    /// Reads a scene, its surface and its importance. Takes as long as the files are large.
    ///
    /// # Errors
    /// As [`Scene::load`], the readers and [`Stack::load`](crate::importance::Stack::load).
    pub fn read(wanted: &Wanted) -> Result<Self> {
        let (scene, file) = match wanted {
            Wanted::Source(source) => (Scene::new(Draft::fresh(source))?, None),
            Wanted::Scene(path) => (Scene::load(path)?, Some(path.clone())),
            Wanted::Autosave(path) => (Scene::load(path)?, None),
        };
        let under = subject::under(&scene, None)?;
        let canvas = Canvas::new(&under.boundary);
        for (index, edit) in scene.strokes.iter().enumerate() {
            edit.check(index, &canvas)?;
        }
        let mut draft = scene.into_draft();
        let warnings = under.subject.warnings();
        let painting = Painting::new(Arc::new(canvas), under, std::mem::take(&mut draft.strokes));
        let boundary = painting.under().boundary.clone();
        let picking = (boundary.clone(), Arc::new(RestShape::new(&boundary)));
        let saved = (painting.version(), 0);
        Ok(Self { draft, file, painting, warnings, picking, settings_version: 0, saved })
    }

    /// The scene as it is now, without its strokes: cheap.
    pub fn draft(&self) -> Draft {
        let Under { layers, hidden, base, clamp, .. } = self.painting.under();
        Draft { layers: layers.clone(), hidden: hidden.clone(), base: *base, clamp: *clamp, ..self.draft.clone() }
    }

    /// The whole scene, to be saved.
    ///
    /// # Errors
    /// As [`Scene::new`].
    pub fn scene(&self) -> Result<Scene> {
        Scene::new(Draft { strokes: self.painting.edits().to_vec(), ..self.draft() })
    }

    /// What finds a place under the pointer, for a surface; what was made for it while reading, if it is the same.
    pub fn picker(&self, boundary: &Arc<Boundary>) -> Picker {
        let (known, rest) = &self.picking;
        if Arc::ptr_eq(known, boundary) { Picker::prepared(known, rest.clone()) } else { Picker::default() }
    }

    /// Whether it lies in the plane.
    pub fn is_flat(&self) -> bool {
        self.painting.under().subject.kind().is_flat()
    }

    /// What is to be solved: what is open, with what was painted on it.
    pub fn subject(&self) -> Arc<dyn Subject> {
        let subject = &self.painting.under().subject;
        self.painting.differences().map_or_else(|| subject.clone(), |differences| subject.painted(differences))
    }

    /// Where it comes from.
    pub fn source(&self) -> &Source {
        &self.draft.source
    }

    /// What to call it.
    pub fn title(&self) -> String {
        let name = |path: &Path| path.file_name().map_or_else(|| "scene".into(), |n| n.to_string_lossy().into_owned());
        match (&self.file, &self.draft.source) {
            (Some(file), _) | (None, Source::File(file)) => name(file),
            (None, Source::Gallery(model)) => model.clone(),
        }
    }

    /// How it is to be solved.
    pub fn settings(&self) -> Settings {
        self.draft.settings()
    }

    /// Changes a setting, if the scene stays valid with it.
    ///
    /// # Errors
    /// As [`Scene::new`]; nothing changes then.
    pub fn set(&mut self, change: impl FnOnce(&mut Draft)) -> Result<()> {
        let mut draft = self.draft();
        change(&mut draft);
        Scene::new(draft.clone())?;
        if draft != self.draft() {
            self.draft = draft;
            self.settings_version += 1;
        }
        Ok(())
    }

    /// Another layer list, base included, as a scene to be read by `under`.
    ///
    /// # Errors
    /// As [`Scene::new`].
    pub fn with_layers(&self, change: impl FnOnce(&mut Draft)) -> Result<Scene> {
        let mut draft = self.draft();
        change(&mut draft);
        Scene::new(draft)
    }

    /// Which state of editing this is.
    pub fn edition(&self) -> (u64, u64) {
        (self.painting.version(), self.settings_version)
    }

    /// Whether something has changed since it was opened or saved.
    pub fn is_changed(&self) -> bool {
        self.edition() != self.saved
    }

    /// It has been saved there in the state of an edition.
    pub fn saved(&mut self, file: PathBuf, edition: (u64, u64)) {
        self.file = Some(file);
        self.saved = edition;
    }

    /// It is as good as unsaved: what was kept of a crash has no file.
    pub fn unsaved(&mut self) {
        self.saved = (u64::MAX, 0);
    }
}

/// What a file on its own is taken for.
#[derive(Debug, Clone, PartialEq)]
pub enum Dropped {
    /// A scene.
    Scene(PathBuf),
    /// Something to warp.
    Source(PathBuf),
    /// A layer of importance for what is open.
    Layer(Layer),
}

/// Tells by its name, and by whether something is open that could take it as a layer, what a file is for.
///
/// # Errors
/// A table that means nothing while nothing is open.
pub fn recognise(path: &Path, open: Option<&Document>) -> Result<Dropped> {
    // On a picture another one is no layer: it opens.
    let has_uvs = open.is_some_and(|open| !open.is_flat() && open.painting.under().boundary.vertex_uvs().is_some());
    let is = |what: Use| what.of(path).is_some();
    Ok(if is(Use::Scene) {
        Dropped::Scene(path.into())
    } else if is(Use::Table) && open.is_none() {
        return Err(Error::in_file(path, "a table is importance for a surface; open the surface first"));
    } else if is(Use::Table) {
        Dropped::Layer(Layer::Values { path: path.into() })
    } else if is(Use::Source(Kind::Picture)) && has_uvs {
        Dropped::Layer(Layer::Image { path: path.into(), range: None })
    } else {
        Dropped::Source(path.into())
    })
}
