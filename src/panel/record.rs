//! The record dialog: how the film is to look, then how far it is.

use std::path::Path;
use std::time::Duration;

use bevy_egui::egui::{self, Context, RichText, Ui};

use super::{Asked, Choice, Compare, Easing, Facts, Repeat, Wish, theme};
use crate::format::Use;
use crate::record::encode::Format;
use crate::record::{Draft, Ease, MAX_SIDE, MAX_TITLE, MIN_SIDE, Settings, View};
use crate::view::Mode;

/// How films are recorded.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordChoice {
    /// Whether the dialog is shown.
    pub is_open: bool,
    /// Path of the film; its ending says the format.
    pub name: String,
    /// All else. The camera is the view's when recording begins.
    pub draft: Draft,
}

impl Default for RecordChoice {
    fn default() -> Self {
        let draft = Draft { width: 1280, height: 720, legend: true, ..Draft::default() };
        Self { is_open: false, name: String::new(), draft }
    }
}

/// A film that is being shot.
pub struct FilmFacts<'a> {
    /// Where it will lie.
    pub path: &'a Path,
    /// Frames that are drawn.
    pub drawn: usize,
    /// Frames it will have.
    pub frames: usize,
    /// How long it will take from here, as far as one can tell.
    pub left: Option<Duration>,
    /// The last frame, and its width and height in pixels.
    pub preview: Option<(egui::TextureId, egui::Vec2)>,
}

/// Sizes to choose from.
const SIZES: [[u32; 2]; 5] = [[1280, 720], [1920, 1080], [3840, 2160], [1080, 1080], [640, 360]];

/// Width of the dialog, points.
const WIDTH: f32 = 360.0;

/// Highest preview, points.
const PREVIEW_HEIGHT: f32 = 260.0;

/// Opens the dialog, set to what the window shows.
pub fn open(choice: &mut Choice, title: &str) {
    let record = &mut choice.record;
    record.is_open = true;
    if record.name.trim().is_empty() {
        let stem = Path::new(title).file_stem().map_or_else(|| "film".into(), |stem| stem.to_string_lossy());
        record.name = format!("{stem}.mp4");
    }
    record.draft.view = match (choice.compare, choice.mode) {
        (Compare::SideBySide | Compare::Wipe, _) => View::Compare,
        (_, Mode::Voxels(_)) => View::Voxels,
        (_, Mode::Plain) => View::Plain,
        _ => View::Importance,
    };
    record.draft.ease = if choice.player.easing == Easing::Linear { Ease::Linear } else { Ease::InOut };
    record.draft.ping_pong = choice.player.repeat == Repeat::PingPong;
    record.draft.turntable = if choice.turntable { 1.0 } else { 0.0 };
}

pub(super) fn show(ctx: &Context, facts: &Facts, choice: &mut Choice, wishes: &mut Vec<Wish>) {
    let mut is_open = choice.record.is_open;
    theme::dialog(ctx, "Record", &mut is_open).show(ctx, |ui| {
        ui.set_width(WIDTH);
        match &facts.filming {
            Some(film) => progress(ui, film, wishes),
            None => form(ui, facts, &mut choice.record, wishes),
        }
    });
    choice.record.is_open = is_open && choice.record.is_open;
}

fn progress(ui: &mut Ui, film: &FilmFacts, wishes: &mut Vec<Wish>) {
    ui.label(RichText::new(film.path.display().to_string()).strong());
    ui.add_space(6.0);
    let height = match film.preview {
        Some((texture, size)) => {
            let shown = size * (WIDTH / size.x.max(1.0)).min(PREVIEW_HEIGHT / size.y.max(1.0));
            ui.vertical_centered(|ui| ui.image((texture, shown)));
            shown.y
        }
        None => 0.0,
    };
    if height == 0.0 {
        ui.label(theme::weak("The first frame takes longest: shaders are compiled."));
    }
    ui.add_space(8.0);
    let share = film.drawn as f32 / film.frames.max(1) as f32;
    let left = film.left.map_or_else(String::new, |left| format!(", about {} left", duration(left)));
    let text = format!("frame {} of {}{left}", film.drawn, film.frames);
    ui.add(egui::ProgressBar::new(share).desired_height(10.0).fill(theme::ACCENT));
    ui.horizontal(|ui| {
        ui.label(theme::weak(text));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if ui.button("Cancel").on_hover_text("Stops after this frame; nothing is left of the film").clicked() {
                wishes.push(Wish::StopFilm);
            }
        });
    });
}

fn duration(left: Duration) -> String {
    let seconds = left.as_secs_f64().ceil() as u64;
    if seconds < 100 { format!("{seconds} s") } else { format!("{} min", seconds.div_ceil(60)) }
}

fn form(ui: &mut Ui, facts: &Facts, record: &mut RecordChoice, wishes: &mut Vec<Wish>) {
    let draft = &mut record.draft;
    theme::row(
        ui,
        "File",
        &format!("The name says the format: {}, or FOLDER/ for numbered PNGs", Use::Film.listed()),
        |ui| {
            ui.add(egui::TextEdit::singleline(&mut record.name).desired_width(196.0));
            if ui.button("Choose…").clicked() {
                wishes.push(Wish::Ask(Asked::ExportFilm));
            }
        },
    );
    time(ui, draft, facts.is_flat());
    picture(ui, draft);
    ui.add_space(8.0);
    let checked = Settings::new(draft.clone())
        .and_then(|settings| Format::of(Path::new(record.name.trim()), false).map(|_| settings));
    let is_done = facts.snapshot.outcome.is_some();
    ui.horizontal(|ui| {
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let can = is_done && checked.is_ok();
            ui.add_enabled_ui(can, |ui| {
                if theme::primary(ui, "⏺ Record").clicked() {
                    wishes.push(Wish::Export(Asked::ExportFilm, record.name.trim().into()));
                }
            });
            ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| match (&checked, is_done) {
                (Err(error), _) => drop(ui.label(RichText::new(error.to_string()).small().color(theme::RED))),
                (_, false) => {
                    let text = "There is something to record as soon as the solver is done.";
                    ui.label(RichText::new(text).small().color(theme::AMBER));
                }
                (Ok(settings), true) => {
                    let text = format!("{} frames, seen from where the view stands", settings.frames());
                    ui.label(theme::weak(text).small());
                }
            });
        });
    });
    if let Some((told, is_certified)) = facts.filmed {
        ui.label(RichText::new(told).small().color(if is_certified { theme::GREEN } else { theme::RED }));
    }
}

fn time(ui: &mut Ui, draft: &mut Draft, is_flat: bool) {
    theme::row(ui, "Length", "Seconds of the whole film, rests and the way back included; frames per second", |ui| {
        ui.add(egui::DragValue::new(&mut draft.seconds).range(0.1..=600.0).speed(0.05).max_decimals(2).suffix(" s"));
        ui.add(egui::DragValue::new(&mut draft.fps).range(1..=60).suffix(" fps"));
    });
    theme::row(ui, "Rest", "Seconds at rest at both ends of the growth", |ui| {
        ui.add(egui::DragValue::new(&mut draft.hold).range(0.0..=60.0).speed(0.02).max_decimals(2).suffix(" s"));
        ui.checkbox(&mut draft.ping_pong, "there and back").on_hover_text("Grows and shrinks, so that it can loop");
    });
    theme::row(ui, "Growth", "How growth follows time: evenly, slow at first, slow at last, slow at both ends", |ui| {
        let all =
            [(Ease::Linear, "even", ""), (Ease::In, "in", ""), (Ease::Out, "out", ""), (Ease::InOut, "in-out", "")];
        theme::choices(ui, &mut draft.ease, &all);
    });
    // A picture is looked at straight on.
    if is_flat {
        return;
    }
    theme::row(ui, "Turntable", "Turns about the vertical axis over the film; negative turns the other way", |ui| {
        let turns = egui::DragValue::new(&mut draft.turntable).range(-100.0..=100.0).speed(0.02).max_decimals(2);
        ui.add(turns.suffix(" turns"));
    });
}

fn picture(ui: &mut Ui, draft: &mut Draft) {
    theme::row(ui, "Size", "Pixels across and down, 16 to 8192; MP4 needs even numbers", |ui| {
        ui.add(egui::DragValue::new(&mut draft.width).range(MIN_SIDE..=MAX_SIDE));
        ui.label("×");
        ui.add(egui::DragValue::new(&mut draft.height).range(MIN_SIDE..=MAX_SIDE));
        egui::ComboBox::from_id_salt("film size").width(60.0).selected_text("sizes").show_ui(ui, |ui| {
            for [width, height] in SIZES {
                if ui
                    .selectable_label([draft.width, draft.height] == [width, height], format!("{width} × {height}"))
                    .clicked()
                {
                    [draft.width, draft.height] = [width, height];
                }
            }
        });
    });
    theme::row(ui, "Show", "What is seen", |ui| {
        let name = |view| match view {
            View::Importance => "importance",
            View::Plain => "plain",
            View::Classic => "Eq. 1 alone, crossings red",
            View::Compare => "Eq. 1 beside the growth",
            View::Voxels => "voxels",
        };
        egui::ComboBox::from_id_salt("film view").width(186.0).selected_text(name(draft.view)).show_ui(ui, |ui| {
            for view in [View::Importance, View::Plain, View::Voxels, View::Classic, View::Compare] {
                ui.selectable_value(&mut draft.view, view, name(view));
            }
        });
    });
    theme::row(ui, "Title", "A line at the top of the picture", |ui| {
        let mut title = draft.title.clone().unwrap_or_default();
        ui.add(egui::TextEdit::singleline(&mut title).char_limit(MAX_TITLE).hint_text("none").desired_width(262.0));
        draft.title = Some(title).filter(|title| !title.trim().is_empty());
    });
    theme::row(ui, "", "", |ui| {
        ui.checkbox(&mut draft.legend, "legend").on_hover_text("Explains the colours");
        ui.checkbox(&mut draft.transparent, "transparent")
            .on_hover_text("No background, in formats that can be without one");
    });
}
