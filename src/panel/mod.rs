//! The panels: one file each, named for what it is about.
//!
//! A panel reads [`Facts`], edits [`Choice`] (what belongs to the window alone) and says as [`Wish`]es what else the user
//! wants; it computes nothing and opens no file. So panels can be drawn anywhere, and everything they can do can be
//! done by a test or a script.

mod compare;
mod export;
mod film;
mod gallery;
mod help;
mod importance;
mod player;
mod prompt;
#[cfg(feature = "record")]
mod record;
mod scene;
mod solver;
mod statistics;
pub mod theme;
mod top;
mod view;

pub use export::ExportChoice;
pub use gallery::card_id;
pub use player::{Easing, Player, Repeat};
pub use prompt::Prompt;
#[cfg(feature = "record")]
pub use record::{FilmFacts, RecordChoice, open as open_record};
pub use solver::Pending;

use std::path::{Path, PathBuf};

use bevy_egui::egui::{self, Ui};
use glam::DVec3;

use crate::{
    format::Kind,
    importance::{Layer, Offered},
    paint::{Brush, Fill},
    scene::{Draft, Source},
    session::Snapshot,
    subject::Painting,
    view::{Axis, Legend, Mode},
};

/// What the panels show.
pub struct Facts<'a> {
    /// What to call what is open.
    pub title: &'a str,
    /// The scene file, if it has one.
    pub file: Option<&'a Path>,
    /// Whether there is something to save.
    pub is_changed: bool,
    /// The scene, without the strokes being made.
    pub draft: Option<&'a Draft>,
    /// Importance that is being painted.
    pub painting: Option<&'a Painting>,
    /// Where the solver is.
    pub snapshot: &'a Snapshot,
    /// What colours mean now.
    pub legend: Option<Legend>,
    /// Files opened lately, the last first.
    pub recent: &'a [PathBuf],
    /// What is being read or written.
    pub busy: Option<&'a str>,
    /// One sentence about what went wrong last.
    pub problem: Option<&'a str>,
    /// Sentences about what was read.
    pub warnings: &'a [String],
    /// Whether the session before ended without being closed, and what it had open can be had again.
    pub can_restore: bool,
    /// The film that is being recorded.
    #[cfg(feature = "record")]
    pub filming: Option<FilmFacts<'a>>,
    /// One line about the film that was recorded last, and whether it is certified.
    pub filmed: Option<(&'a str, bool)>,
    /// Where the names of the reference shapes go, window's points.
    pub sizes: Vec<(egui::Pos2, &'static str)>,
}

impl Facts<'_> {
    /// What is open is of this kind; a body where nothing is.
    pub fn kind(&self) -> Kind {
        self.painting.map_or(Kind::Body, |painting| painting.under().subject.kind())
    }

    /// Whether what is open lies in the plane.
    pub fn is_flat(&self) -> bool {
        self.kind().is_flat()
    }
}

/// What the left mouse button does on the surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Tool {
    /// Turns the view.
    #[default]
    Orbit,
    /// Paints.
    Paint,
    /// Fills what hangs together.
    Fill,
}

/// What Eq. 1 alone gives, beside the certified result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Compare {
    /// Not shown.
    #[default]
    Off,
    /// To the left of it.
    SideBySide,
    /// Left of a line that can be moved.
    Wipe,
}

/// What the user has chosen that is not part of the scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// What the left mouse button does.
    pub tool: Tool,
    /// With what it paints.
    pub brush: Brush,
    /// Radius of the brush as a part of the longest side, 0.005..=0.5.
    pub brush_size: f32,
    /// Which colours.
    pub mode: Mode,
    /// Whether the rest shape is shown.
    pub ghost: bool,
    /// Whether reference cubes are shown.
    pub size_legend: bool,
    /// Whether the view turns by itself.
    pub turntable: bool,
    /// Whether parallels stay parallel.
    pub orthographic: bool,
    /// Eq. 1 alone beside it.
    pub compare: Compare,
    /// Where the wipe's line is, 0 = left, 1 = right.
    pub wipe: f32,
    /// The film.
    pub player: Player,
    /// Whether the help is shown.
    pub help: bool,
    /// Whether the gallery is shown, to choose a scene from.
    pub gallery: bool,
    /// The export dialog, if it is open, and what it is set to.
    pub export: ExportChoice,
    /// The record dialog, and what it is set to.
    #[cfg(feature = "record")]
    pub record: RecordChoice,
    /// Value of the next fill.
    pub fill_value: f32,
    /// Ends of the next gradient.
    pub gradient: [f32; 2],
    /// A path being typed.
    pub typed_path: String,
    /// Paths asked for in the window, where the system shows no dialog.
    pub prompt: Option<Prompt>,
    /// Settings of the solver that are being dragged.
    pub pending: Pending,
}

impl Default for Choice {
    fn default() -> Self {
        Self {
            tool: Tool::Orbit,
            brush: Brush::default(),
            brush_size: 0.06,
            mode: Mode::Importance,
            ghost: false,
            size_legend: false,
            turntable: false,
            orthographic: false,
            compare: Compare::Off,
            wipe: 0.5,
            player: Player::default(),
            help: false,
            gallery: false,
            export: ExportChoice::default(),
            #[cfg(feature = "record")]
            record: RecordChoice::default(),
            fill_value: 2.0,
            gradient: [0.5, 2.0],
            typed_path: String::new(),
            prompt: None,
            pending: Pending::default(),
        }
    }
}

/// Which kind of file a dialog asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Asked {
    /// Mesh, picture or scene, to be opened.
    Open,
    /// The files of a layer.
    Layer(Offered),
    /// Where to save the scene.
    SaveScene,
    /// Where to write the warped mesh; the extension says the format.
    ExportMesh,
    /// Where to write the growth.
    ExportGrowth,
    /// Where to write the report.
    ExportReport,
    /// Where to write the film.
    ExportFilm,
}

/// What the user wants.
#[derive(Debug, Clone, PartialEq)]
pub enum Wish {
    /// Opens something.
    Open(Source),
    /// Opens a scene, mesh, picture or table by what it is.
    OpenPath(PathBuf),
    /// Asks for a file in the system's dialog.
    Ask(Asked),
    /// Takes files as if they had been chosen in that dialog.
    Choose(Asked, Vec<PathBuf>),
    /// Saves the scene where it came from; asks where, if from nowhere.
    Save,
    /// Saves the scene there.
    SaveTo(PathBuf),
    /// Writes a result there.
    Export(Asked, PathBuf),
    /// Adds a layer over the others.
    AddLayer(Layer),
    /// Removes a layer, by its index.
    RemoveLayer(usize),
    /// Shows or hides a layer, by its index.
    ShowLayer(usize, bool),
    /// Importance below all layers.
    SetBase(f32),
    /// Fills.
    Fill(Fill),
    /// Takes the last change back.
    Undo,
    /// Does again what was undone.
    Redo,
    /// Solves with so many cells along the longest axis.
    SetResolution(u32),
    /// Solves with this μ.
    SetFidelity(f32),
    /// Solves with so many keyframes.
    SetKeys(usize),
    /// Stops solving.
    Cancel,
    /// Stops the film that is being recorded.
    StopFilm,
    /// Solves what was stopped.
    Resume,
    /// Looks at all of it.
    Frame,
    /// Looks from an axis.
    LookFrom(Axis),
    /// Looks at a place, source units.
    LookAt(DVec3),
    /// Saves a picture of the window.
    Screenshot,
    /// The problem has been read.
    Dismiss,
    /// Opens what was open when the program last ended without being closed.
    Restore,
    /// Does not.
    Forget,
}

/// Draws everything; what is left in the middle is the view's. In egui's points.
pub fn draw(root: &mut Ui, facts: &Facts, choice: &mut Choice, wishes: &mut Vec<Wish>) -> egui::Rect {
    top::show(root, facts, choice, wishes);
    film::show(root, facts, choice);
    egui::Panel::left("left").resizable(false).exact_size(theme::SIDE).frame(theme::side_frame()).show(root, |ui| {
        theme::scroll(ui, "left", |ui| {
            scene::show(ui, facts, choice, wishes);
            importance::show(ui, facts, choice, wishes);
        });
    });
    egui::Panel::right("right").resizable(false).exact_size(theme::SIDE).frame(theme::side_frame()).show(root, |ui| {
        theme::scroll(ui, "right", |ui| {
            solver::show(ui, facts, &mut choice.pending, wishes);
            view::show(ui, facts, choice, wishes);
            statistics::show(ui, facts);
        });
    });
    let middle = root.available_rect_before_wrap();
    view::legend(root.ctx(), facts, middle);
    view::sizes(root.ctx(), facts, middle);
    compare::show(root.ctx(), facts, choice, middle);
    top::problem(root.ctx(), facts, middle, wishes);
    export::show(root.ctx(), facts, choice, wishes);
    gallery::show(root.ctx(), facts.draft.map(|draft| &draft.source), choice, wishes);
    #[cfg(feature = "record")]
    record::show(root.ctx(), facts, choice, wishes);
    help::show(root.ctx(), choice);
    prompt::show(root.ctx(), choice, wishes);
    middle
}
