//! The export dialog: everything the command line can write.

use bevy_egui::egui::{self, Context, Ui};

use super::{Asked, Choice, Facts, Wish, theme};
use crate::format::Use;

/// How results are written.
#[derive(Debug, Clone, PartialEq)]
pub struct ExportChoice {
    /// Whether the dialog is shown.
    pub is_open: bool,
    /// Extension of the mesh.
    pub format: &'static str,
    /// Whether the mesh gets the colours of importance, or those of the input.
    pub colour_mesh: bool,
    /// The same for the growth.
    pub colour_growth: bool,
    /// Of a picture: pixels of the result along one of the input, 0.01..=64.
    pub scale: f32,
    /// Of a picture: extension of its growth.
    pub picture_growth: &'static str,
    /// Length of the growth, seconds.
    pub seconds: f32,
}

impl Default for ExportChoice {
    fn default() -> Self {
        Self {
            is_open: false,
            format: "glb",
            colour_mesh: false,
            colour_growth: true,
            scale: 1.0,
            picture_growth: "gif",
            seconds: 4.0,
        }
    }
}

pub(super) fn show(ctx: &Context, facts: &Facts, choice: &mut Choice, wishes: &mut Vec<Wish>) {
    let mut is_open = choice.export.is_open;
    theme::dialog(ctx, "Export", &mut is_open).show(ctx, |ui| {
        ui.set_width(360.0);
        let is_done = facts.snapshot.outcome.is_some();
        if !is_done {
            ui.label(
                egui::RichText::new("There is something to export as soon as the solver is done.").color(theme::AMBER),
            );
            ui.add_space(6.0);
        }
        ui.add_enabled_ui(is_done, |ui| content(ui, facts, &mut choice.export, wishes));
    });
    choice.export.is_open = is_open;
}

fn content(ui: &mut Ui, facts: &Facts, export: &mut ExportChoice, wishes: &mut Vec<Wish>) {
    let (kind, is_flat) = (facts.kind(), facts.is_flat());
    let (of_result, of_growth) = match is_flat {
        true => {
            ("PNG with alpha, as deep as the input", "GIF or animated PNG; GLB is a textured mesh for any glTF viewer")
        }
        false => (
            "Same vertices, same order, same materials as the input",
            "GLB with morph targets: plays in any glTF viewer",
        ),
    };
    part(ui, &format!("Warped {}", kind.word()), of_result, Asked::ExportMesh, wishes, |ui| {
        formats(ui, "format", Use::Result(kind), &mut export.format);
        if is_flat {
            ui.add(egui::DragValue::new(&mut export.scale).range(0.01..=64.0).speed(0.01).prefix("×"))
                .on_hover_text("Pixels of the result along one of the input, of the growth too");
        } else {
            ui.checkbox(&mut export.colour_mesh, "colours of importance");
        }
    });
    part(ui, "Growth animation", of_growth, Asked::ExportGrowth, wishes, |ui| {
        ui.add(egui::DragValue::new(&mut export.seconds).range(0.1..=3600.0).speed(0.05).suffix(" s"))
            .on_hover_text("How long it grows");
        formats(ui, "growth", Use::Growth(kind), &mut export.picture_growth);
        if !is_flat {
            ui.checkbox(&mut export.colour_growth, "colours of importance");
        }
    });
    part(ui, "Report", "JSON: what was asked, achieved and proven", Asked::ExportReport, wishes, |_| {});
}

/// The formats there are, where there is a choice.
fn formats(ui: &mut Ui, id: &str, what: Use, chosen: &mut &'static str) {
    let known = what.extensions();
    if known.len() > 1 {
        egui::ComboBox::from_id_salt(id).width(60.0).selected_text(*chosen).show_ui(ui, |ui| {
            for format in known {
                ui.selectable_value(chosen, format, format);
            }
        });
    }
}

fn part(ui: &mut Ui, name: &str, hint: &str, asked: Asked, wishes: &mut Vec<Wish>, settings: impl FnOnce(&mut Ui)) {
    ui.horizontal(|ui| {
        ui.label(egui::RichText::new(name).strong());
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if theme::primary(ui, "Save…").clicked() {
                wishes.push(Wish::Ask(asked));
            }
        });
    });
    ui.label(theme::weak(hint).small());
    ui.horizontal(settings);
    ui.add_space(8.0);
}
