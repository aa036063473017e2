//! The sandbox without its window: what is open, what is chosen, what is solved, and how wishes come true.

mod files;

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use bevy::prelude::Resource;
use glam::DVec3;

use super::document::{Document, Dropped, Wanted, recognise};
use super::marks::{Faulty, Marks};
use super::memory::{Memory, keep};
use super::tasks::{Done, Tasks};
use crate::boundary::Boundary;
use crate::format::Kind;
use crate::paint::Under;
use crate::panel::{Asked, Choice, Compare, Wish};
use crate::scene::{Draft, Source};
use crate::session::{Session, Snapshot};
use crate::subject::Subject;
use crate::view::{Axis, Mode, Orbit};
use crate::{Error, Result};

/// Everything the window is about.
#[derive(Resource)]
pub struct Sandbox {
    /// What is open.
    pub open: Option<Document>,
    /// What the user has chosen.
    pub choice: Choice,
    /// What the user wants and has not got yet.
    pub wishes: Vec<Wish>,
    /// One sentence about what went wrong last.
    pub problem: Option<String>,
    /// The solver's latest.
    pub snapshot: Arc<Snapshot>,
    /// What the camera is asked for; who moves it takes them.
    pub looks: Vec<Look>,
    /// Pictures of the window that are asked for.
    pub screenshots: Vec<PathBuf>,
    /// Files opened lately.
    pub memory: Memory,
    /// From where the view is seen.
    pub seen_from: Orbit,
    /// The film that is being recorded.
    #[cfg(feature = "record")]
    pub filming: Option<super::Filming>,
    /// One line about the film that was recorded last, and whether it is certified.
    pub filmed: Option<(String, bool)>,
    /// Set when what is being written is to stop.
    stop: Arc<AtomicBool>,
    session: Session,
    tasks: Tasks,
    marks: Marks,
    /// What the solver was told last.
    told: Option<Told>,
    kept: (u64, u64),
    failure_seen: u64,
    /// Number of the document that is open, from 1: what was begun for another one does not concern it.
    number: u64,
    /// Number of the last wish for something to be opened: what was wished for before it comes too late.
    asked: u64,
    /// Layers are being read; wishes for others wait, as they begin with what these will have made of the scene.
    waiting: Option<Vec<Wish>>,
}

/// A wish that only the camera can fulfil.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Look {
    /// At everything.
    Frame,
    /// From an axis.
    From(Axis),
    /// At a place, source units.
    At(DVec3),
}

/// What the solver was told.
struct Told {
    boundary: Arc<Boundary>,
    painting: u64,
}

impl Sandbox {
    /// Nothing is open yet. `memory` is where to remember; the user's own place if `None`.
    ///
    /// # Errors
    /// As [`Session::start`].
    pub fn new(memory: Option<PathBuf>) -> Result<Self> {
        Ok(Self {
            open: None,
            choice: Choice::default(),
            wishes: Vec::new(),
            problem: None,
            snapshot: Arc::default(),
            looks: Vec::new(),
            screenshots: Vec::new(),
            memory: Memory::open(memory),
            seen_from: Orbit::default(),
            #[cfg(feature = "record")]
            filming: None,
            filmed: None,
            stop: Arc::default(),
            session: Session::start()?,
            tasks: Tasks::default(),
            marks: Marks::default(),
            told: None,
            kept: (0, 0),
            failure_seen: 0,
            number: 0,
            asked: 0,
            waiting: None,
        })
    }

    /// What is being read or written.
    pub fn busy(&self) -> Option<&str> {
        self.tasks.busy()
    }

    /// Whether something is under way outside the window whose end it must notice.
    pub fn awaits(&self) -> bool {
        !self.tasks.is_idle()
            || self.snapshot.phase.is_busy()
            || self.told_is_old()
            || !self.session.is_answered(&self.snapshot)
    }

    fn told_is_old(&self) -> bool {
        let now = self.open.as_ref().map(|open| open.painting.version());
        now != self.told.as_ref().map(|told| told.painting)
    }

    /// Once a frame: wishes, results, and what the solver must know. Never waits.
    pub fn update(&mut self) {
        for done in self.tasks.take() {
            self.receive(done);
        }
        for wish in std::mem::take(&mut self.wishes) {
            if let Err(error) = self.fulfil(wish) {
                self.problem = Some(error.to_string());
            }
        }
        self.tell();
        let snapshot = self.session.snapshot();
        if snapshot.version != self.snapshot.version {
            self.snapshot = snapshot;
        }
        self.mark();
        if let Some(error) = &self.snapshot.error
            && self.failure_seen != self.snapshot.version
        {
            self.problem = Some(error.clone());
            self.failure_seen = self.snapshot.version;
        }
    }

    /// Looks for what is to be marked in Eq. 1's solution, where it is shown.
    fn mark(&mut self) {
        let is_painting = self.open.as_ref().is_some_and(|open| open.painting.is_painting());
        let Some((lattice, linear)) = self.snapshot.lattice.as_ref().zip(self.snapshot.linear.as_ref()) else { return };
        if self.choice.compare == Compare::Off || is_painting {
            return;
        }
        if let Some(search) = self.marks.wanted(lattice, linear, self.choice.player.lambda()) {
            self.tasks.start_quietly("the search for crossings", Done::Marked, move || Ok(Box::new(search.run())));
        }
    }

    /// Triangles to be marked in Eq. 1's solution at the λ that is shown, as far as they are known.
    pub fn marked(&self) -> Option<Faulty> {
        self.marks.at(self.snapshot.linear.as_ref(), self.choice.player.lambda())
    }

    /// Tells the solver what has been painted since.
    fn tell(&mut self) {
        let Some(open) = &self.open else { return };
        let (boundary, painting) = (&open.painting.under().boundary, open.painting.version());
        match &mut self.told {
            Some(told) if Arc::ptr_eq(&told.boundary, boundary) => {
                if told.painting != painting {
                    told.painting = painting;
                    self.session.set_importance(open.subject());
                }
            }
            _ => {
                self.told = Some(Told { boundary: boundary.clone(), painting });
                self.session.open(open.subject(), open.settings());
            }
        }
    }

    fn receive(&mut self, done: Done) {
        let result = match done {
            Done::Opened(number, document) if number == self.asked => document.map(|document| self.show(*document)),
            Done::Opened(..) => Ok(()),
            Done::Layers(number, under) if number == self.number => {
                self.wishes.splice(0..0, self.waiting.take().unwrap_or_default());
                under.map(|under| self.layered(*under))
            }
            // Of something that is not open any more, or not wanted any more.
            Done::Layers(..) => Ok(()),
            Done::Chosen(asked, chosen) => chosen.and_then(|chosen| self.chosen(asked, chosen)),
            Done::Saved(number, saved) => saved.map(|(file, edition)| {
                self.memory.note(&file);
                if let Some(open) = self.open.as_mut().filter(|_| number == self.number) {
                    open.saved(file, edition);
                }
            }),
            // Whoever stopped it knows.
            Done::Written(Err(Error::Cancelled)) => Ok(()),
            Done::Written(path) => path.map(|_| ()),
            #[cfg(feature = "record")]
            Done::Filmed(film) => {
                self.filming = None;
                match film {
                    Ok((path, certified)) => {
                        self.filmed = Some((super::filming::told(&path, certified), certified));
                        Ok(())
                    }
                    // Whoever stopped it knows.
                    Err(Error::Cancelled) => Ok(()),
                    Err(error) => Err(error),
                }
            }
            Done::Kept(done) | Done::Pictured(done) => done,
            Done::Marked(Ok(found)) => {
                self.marks.take(*found);
                Ok(())
            }
            Done::Marked(Err(error)) => {
                self.marks.give_up();
                Err(error)
            }
        };
        if let Err(error) = result {
            self.problem = Some(error.to_string());
        }
    }

    fn layered(&mut self, under: Under<Arc<dyn Subject>>) {
        if let Some(open) = &mut self.open {
            open.warnings = under.subject.warnings();
            open.painting.set_under(under);
        }
    }

    /// A scene has been read: it takes the place of what was open.
    fn show(&mut self, document: Document) {
        self.number += 1;
        // They were wished for what was open before.
        self.waiting = None;
        match (&document.file, document.source()) {
            (Some(file), _) | (None, Source::File(file)) => self.memory.note(&file.clone()),
            (None, Source::Gallery(_)) => {}
        }
        self.kept = document.edition();
        self.told = None;
        self.problem = None;
        self.choice.player.scrub(1.0);
        #[cfg(feature = "record")]
        self.choice.record.name.clear();
        // A picture is shown as it is, a body in the colours of its importance, until the user chooses otherwise.
        let was_flat = self.open.as_ref().is_some_and(Document::is_flat);
        if document.is_flat() != was_flat {
            self.choice.mode = if was_flat { Mode::Importance } else { Mode::Plain };
        }
        self.open = Some(document);
        self.looks.push(Look::Frame);
    }

    fn kind(&self) -> Kind {
        self.open.as_ref().map_or(Kind::Body, |open| open.painting.under().subject.kind())
    }

    fn fulfil(&mut self, wish: Wish) -> Result<()> {
        let is_of_layers =
            matches!(wish, Wish::AddLayer(_) | Wish::RemoveLayer(_) | Wish::ShowLayer(..) | Wish::SetBase(_));
        if let Some(waiting) = self.waiting.as_mut().filter(|_| is_of_layers) {
            // Of a value that is dragged the last counts.
            if matches!((waiting.last(), &wish), (Some(Wish::SetBase(_)), Wish::SetBase(_))) {
                waiting.pop();
            }
            waiting.push(wish);
            return Ok(());
        }
        match wish {
            Wish::Open(source) => self.read(Wanted::Source(source)),
            Wish::OpenPath(path) => match recognise(&path, self.open.as_ref())? {
                Dropped::Scene(path) => self.read(Wanted::Scene(path)),
                Dropped::Source(path) => self.read(Wanted::Source(Source::File(path))),
                Dropped::Layer(layer) => return self.fulfil(Wish::AddLayer(layer)),
            },
            Wish::Ask(asked) => self.ask(asked),
            Wish::Choose(asked, files) => self.tasks.choose(asked, files, self.kind()),
            Wish::Save => match self.open.as_ref().map(|open| open.file.clone()) {
                Some(Some(file)) => return self.save(file),
                Some(None) => self.ask(Asked::SaveScene),
                None => {}
            },
            Wish::SaveTo(path) => return self.save(path),
            #[cfg(feature = "record")]
            Wish::Export(Asked::ExportFilm, path) => return self.record(path),
            Wish::Export(asked, path) => return self.export(asked, path),
            Wish::AddLayer(layer) => return self.layers("reading the layer", |draft| draft.layers.push(layer)),
            Wish::RemoveLayer(index) => return self.layers("reading the layers", |draft| remove(draft, index)),
            Wish::ShowLayer(index, shown) => {
                return self.layers("reading the layers", |draft| {
                    draft.hidden.retain(|hidden| *hidden != index);
                    if !shown {
                        draft.hidden.push(index);
                    }
                });
            }
            Wish::SetBase(base) => return self.layers("reading the layers", |draft| draft.base = base),
            Wish::Fill(fill) => {
                if let Some(open) = &mut self.open {
                    return open.painting.apply(crate::paint::Edit::Fill(fill));
                }
            }
            Wish::Undo => drop(self.open.as_mut().map(|open| open.painting.undo())),
            Wish::Redo => drop(self.open.as_mut().map(|open| open.painting.redo())),
            Wish::SetResolution(resolution) => return self.set(|draft| draft.resolution = resolution),
            Wish::SetFidelity(fidelity) => return self.set(|draft| draft.fidelity = fidelity),
            Wish::SetKeys(keys) => return self.set(|draft| draft.keys = keys),
            Wish::Cancel => {
                self.session.cancel();
                std::mem::take(&mut self.stop).store(true, Ordering::Relaxed);
            }
            Wish::StopFilm =>
            {
                #[cfg(feature = "record")]
                if let Some(filming) = &self.filming {
                    filming.stop();
                }
            }
            Wish::Resume => self.session.resume(),
            Wish::Frame => self.looks.push(Look::Frame),
            Wish::LookFrom(axis) => self.looks.push(Look::From(axis)),
            Wish::LookAt(place) => self.looks.push(Look::At(place)),
            Wish::Screenshot => self.screenshots.push(free_name("homunculus", "png")),
            Wish::Dismiss => self.problem = None,
            Wish::Restore => {
                self.memory.forget();
                if let Some(path) = self.memory.autosave() {
                    self.read(Wanted::Autosave(path));
                }
            }
            Wish::Forget => self.memory.forget(),
        }
        Ok(())
    }

    fn read(&mut self, wanted: Wanted) {
        let what = match &wanted {
            Wanted::Source(source) => format!("reading {source}"),
            Wanted::Scene(path) => format!("reading {}", path.display()),
            Wanted::Autosave(_) => "restoring the last session".into(),
        };
        self.asked += 1;
        let number = self.asked;
        self.tasks.start(
            what,
            move |document| Done::Opened(number, document),
            move || {
                let mut document = Document::read(&wanted)?;
                if matches!(wanted, Wanted::Autosave(_)) {
                    document.unsaved();
                }
                Ok(Box::new(document))
            },
        );
    }

    fn set(&mut self, change: impl FnOnce(&mut Draft)) -> Result<()> {
        let Some(open) = &mut self.open else { return Ok(()) };
        let before = open.settings();
        open.set(change)?;
        if open.settings() != before {
            self.session.set_settings(open.settings());
        }
        Ok(())
    }

    /// Writes a picture of the window.
    pub(super) fn write_picture(&mut self, picture: image::DynamicImage, path: PathBuf) {
        let work = move || super::write_picture(&picture, &path).map(drop);
        self.tasks.start_quietly("the picture of the window", Done::Pictured, work);
    }

    /// The program is being closed: unsaved work stays to be restored, what is saved leaves nothing behind.
    pub(super) fn close(&self) {
        self.stop.store(true, Ordering::Relaxed);
        #[cfg(feature = "record")]
        if let Some(filming) = &self.filming {
            filming.stop_and_wait();
        }
        match (&self.open, self.memory.autosave()) {
            (Some(open), Some(path)) if open.is_changed() && !self.memory.can_restore() => {
                // Nobody is there any more to be told.
                let _ = keep(&open.scene(), &path);
            }
            _ => self.memory.close(),
        }
    }

    /// Keeps a copy of unsaved work, if there is any that has not been kept.
    pub fn autosave(&mut self) {
        let Some(open) = self.open.as_ref().filter(|open| open.is_changed() && !open.painting.is_painting()) else {
            return;
        };
        if self.kept == open.edition() || self.memory.can_restore() {
            return;
        }
        let Some(path) = self.memory.autosave() else { return };
        self.kept = open.edition();
        let scene = open.scene();
        self.tasks.start_quietly("the copy of unsaved work", Done::Kept, move || keep(&scene, &path));
    }
}

/// Takes a layer out; those above move down.
fn remove(draft: &mut Draft, index: usize) {
    if index < draft.layers.len() {
        draft.layers.remove(index);
        draft.hidden.retain(|hidden| *hidden != index);
        for hidden in &mut draft.hidden {
            *hidden -= usize::from(*hidden > index);
        }
    }
}

/// `NAME-1.EXT`, or with the first number that is free, in the working directory.
fn free_name(name: &str, extension: &str) -> PathBuf {
    (1..).map(|n| PathBuf::from(format!("{name}-{n}.{extension}"))).find(|path| !path.exists()).unwrap_or_default()
}
