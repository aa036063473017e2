//! The bar at the top: what is open, undo, tools, the certificate's light; and the line for what went wrong.

use bevy_egui::egui::{self, Color32, Context, RichText, Ui};

use super::{Asked, Choice, Facts, Tool, Wish, theme};
use crate::session::{Phase, Snapshot};

pub(super) fn show(root: &mut Ui, facts: &Facts, choice: &mut Choice, wishes: &mut Vec<Wish>) {
    egui::Panel::top("top").frame(theme::bar_frame()).show(root, |ui| {
        ui.horizontal(|ui| {
            if ui
                .button("Open…")
                .on_hover_text("Mesh, picture or scene  (Ctrl+O)\nor drop a file on the window")
                .clicked()
            {
                wishes.push(Wish::Ask(Asked::Open));
            }
            let can_save = facts.draft.is_some();
            if ui
                .add_enabled(can_save, egui::Button::new("Save"))
                .on_hover_text("The scene with its strokes  (Ctrl+S)")
                .clicked()
            {
                wishes.push(Wish::Save);
            }
            if ui
                .add_enabled(can_save, egui::Button::new("Export…"))
                .on_hover_text("Warped mesh, growth, report: files")
                .clicked()
            {
                choice.export.is_open = true;
            }
            ui.separator();
            undo(ui, facts, wishes);
            ui.separator();
            tools(ui, choice);
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if ui.button(" ? ").on_hover_text("Keys and mouse").clicked() {
                    choice.help = !choice.help;
                }
                light(ui, facts.snapshot, wishes);
                ui.with_layout(egui::Layout::left_to_right(egui::Align::Center).with_main_justify(true), |ui| {
                    let mark = if facts.is_changed { " •" } else { "" };
                    let title = RichText::new(format!("{}{mark}", facts.title)).strong();
                    let hint = facts.file.map_or_else(|| "not saved yet".into(), |file| file.display().to_string());
                    ui.add(egui::Label::new(title).truncate()).on_hover_text(hint);
                });
            });
        });
    });
}

fn undo(ui: &mut Ui, facts: &Facts, wishes: &mut Vec<Wish>) {
    let (undo, redo) = facts.painting.map_or((0, 0), crate::paint::Painting::depth);
    if ui.add_enabled(undo > 0, egui::Button::new("⮪ Undo")).on_hover_text(format!("Ctrl+Z   {undo} steps")).clicked()
    {
        wishes.push(Wish::Undo);
    }
    if ui
        .add_enabled(redo > 0, egui::Button::new("⮫ Redo"))
        .on_hover_text(format!("Ctrl+Shift+Z   {redo} steps"))
        .clicked()
    {
        wishes.push(Wish::Redo);
    }
}

fn tools(ui: &mut Ui, choice: &mut Choice) {
    theme::choices(
        ui,
        &mut choice.tool,
        &[
            (Tool::Orbit, "View", "Drag turns the view  (V)"),
            (Tool::Paint, "Paint", "Drag on the surface paints importance  (B)"),
            (Tool::Fill, "Fill", "Click fills the piece of surface that hangs together  (G)"),
        ],
    );
}

/// Green when certified, amber while solving, red with "where".
fn light(ui: &mut Ui, snapshot: &Snapshot, wishes: &mut Vec<Wish>) {
    let Light { colour, text, hint, place } = Light::of(snapshot);
    if let Some(place) = place
        && ui.small_button("where").on_hover_text("Looks at the place").clicked()
    {
        wishes.push(Wish::LookAt(place));
    }
    if snapshot.phase.is_busy()
        && ui.small_button("stop").on_hover_text("Stops solving; what is reached stays  (Esc)").clicked()
    {
        wishes.push(Wish::Cancel);
    }
    if snapshot.phase == Phase::Stopped
        && ui.small_button("go on").on_hover_text("Solves on from the last valid state").clicked()
    {
        wishes.push(Wish::Resume);
    }
    ui.label(RichText::new(text).color(colour).strong()).on_hover_text(hint);
    let (rect, _) = ui.allocate_exact_size(egui::vec2(14.0, 14.0), egui::Sense::hover());
    ui.painter().circle_filled(rect.center(), 6.5, colour.gamma_multiply(0.25));
    ui.painter().circle_filled(rect.center(), 4.5, colour);
}

/// What the certificate says, as a light.
pub(super) struct Light {
    pub colour: Color32,
    pub text: String,
    pub hint: String,
    pub place: Option<glam::DVec3>,
}

impl Light {
    pub(super) fn of(snapshot: &Snapshot) -> Self {
        let amber = |text: String, hint: &str| Self { colour: theme::AMBER, text, hint: hint.into(), place: None };
        let percent = (snapshot.fraction * 100.0).round();
        match snapshot.phase {
            Phase::Empty => {
                Self { colour: Color32::GRAY, text: "nothing open".into(), hint: String::new(), place: None }
            }
            Phase::Preparing => amber("voxelizing".into(), "Cells are being made of the inside."),
            Phase::Adapting => amber(
                format!("adapting {percent} %"),
                "From the last valid state to what is painted. Shown: the linear solution, then valid states.",
            ),
            Phase::Growing => amber(
                format!("growing {percent} %  λ {:.2}", snapshot.lambda),
                "The film is being solved; each keyframe is checked as it comes.",
            ),
            Phase::Checking => amber("checking".into(), "States between keyframes are being checked."),
            Phase::Stopped => amber("stopped".into(), "What is shown is valid, but not at rest."),
            Phase::Failed => Self {
                colour: theme::RED,
                text: "failed".into(),
                hint: snapshot.error.clone().unwrap_or_default(),
                place: None,
            },
            Phase::Done => Self::of_result(snapshot),
        }
    }

    fn of_result(snapshot: &Snapshot) -> Self {
        let states = || snapshot.film.iter().map(|state| &state.certificate);
        if let Some(bad) = states().find(|certificate| !certificate.certified()) {
            let text = format!(
                "not certified: {} inverted, {} crossings",
                bad.inverted(),
                bad.crossings() + bad.surface_crossings()
            );
            let hint = "Some of the film folds or passes through itself. A finer lattice or a lower fidelity may help.";
            return Self { colour: theme::RED, text, hint: hint.into(), place: bad.worst() };
        }
        let hint =
            format!("0 inverted elements, 0 crossings in all {} keyframes, decided exactly", snapshot.film.len());
        Self { colour: theme::GREEN, text: "certified".into(), hint, place: None }
    }
}

/// The line at the bottom of the view for what went wrong, and what can be had again.
pub(super) fn problem(ctx: &Context, facts: &Facts, middle: egui::Rect, wishes: &mut Vec<Wish>) {
    let line = |id: &str, colour: Color32, content: &mut dyn FnMut(&mut Ui)| {
        egui::Area::new(egui::Id::new(id))
            .order(egui::Order::Foreground)
            .pivot(egui::Align2::CENTER_BOTTOM)
            .fixed_pos(middle.center_bottom() - egui::vec2(0.0, 14.0))
            .show(ctx, |ui| {
                let frame = egui::Frame::popup(ui.style()).stroke(egui::Stroke::new(1.0, colour)).inner_margin(10.0);
                frame.show(ui, |ui| {
                    ui.set_max_width((middle.width() - 48.0).max(200.0));
                    content(ui);
                });
            });
    };
    if let Some(problem) = facts.problem {
        line("problem", theme::RED, &mut |ui| {
            ui.horizontal_wrapped(|ui| {
                ui.label(RichText::new("⚠").color(theme::RED));
                ui.label(problem);
                if ui.small_button("dismiss").clicked() {
                    wishes.push(Wish::Dismiss);
                }
            });
        });
    } else if facts.can_restore {
        line("restore", theme::ACCENT, &mut |ui| {
            ui.horizontal(|ui| {
                ui.label("There is unsaved work of the last session.");
                if theme::primary(ui, "Restore it").clicked() {
                    wishes.push(Wish::Restore);
                }
                if ui.button("No").clicked() {
                    wishes.push(Wish::Forget);
                }
            });
        });
    } else if let Some(busy) = facts.busy {
        line("busy", theme::ACCENT, &mut |ui| {
            ui.horizontal(|ui| {
                ui.add(egui::Spinner::new().size(14.0));
                ui.label(busy);
            });
        });
    }
}
