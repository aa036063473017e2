//! What is shown: colours, ghost, references, the classic solution beside; and the legend over the view.

use bevy_egui::egui::{self, Color32, Context, Ui};

use super::{Choice, Compare, Facts, Wish, theme};
use crate::view::{Axis, Legend, Mode, VoxelColour};

pub(super) fn show(ui: &mut Ui, facts: &Facts, choice: &mut Choice, wishes: &mut Vec<Wish>) {
    theme::section(ui, "View", |ui| {
        let voxels = match choice.mode {
            Mode::Voxels(_) => choice.mode,
            _ => Mode::Voxels(VoxelColour::Importance),
        };
        theme::choices(
            ui,
            &mut choice.mode,
            &[
                (Mode::Plain, "Plain", "The file's own colours, or grey; a picture as it is"),
                (Mode::Importance, "Importance", "Size asked for"),
                (Mode::Fidelity, "Fidelity", "Size achieved over size asked"),
                (voxels, "Voxels", "The cells the inside is made of"),
            ],
        );
        if matches!(choice.mode, Mode::Voxels(_)) {
            theme::row(ui, "Colour by", "What the cells are coloured by", |ui| {
                let by = |colour| Mode::Voxels(colour);
                let all = [
                    (by(VoxelColour::Importance), "importance", "Size asked for in the end"),
                    (by(VoxelColour::Growth), "λ", "Size asked for at λ"),
                ];
                theme::choices(ui, &mut choice.mode, &all);
            });
        }
        ui.add_space(2.0);
        let is_flat = facts.is_flat();
        egui::Grid::new("shown").num_columns(2).spacing(ui.spacing().item_spacing).show(ui, |ui| {
            ui.checkbox(&mut choice.ghost, "Rest shape").on_hover_text("The shape before warping, translucent");
            ui.checkbox(&mut choice.size_legend, "Sizes")
                .on_hover_text("Cubes or discs of ×½, ×1, ×2, ×4 to compare with");
            ui.end_row();
            if !is_flat {
                ui.checkbox(&mut choice.turntable, "Turntable").on_hover_text("Turns by itself  (T)");
                ui.checkbox(&mut choice.orthographic, "Parallel").on_hover_text("Parallels stay parallel");
                ui.end_row();
            }
        });
        theme::row(ui, "Classic", "What the edge optimization alone (Eq. 1) gives; crossings are red", |ui| {
            let all = [
                (Compare::Off, "off", "The certified growth alone"),
                (Compare::SideBySide, "beside", "Eq. 1 to the left of the certified growth"),
                (Compare::Wipe, "wipe", "Eq. 1 left of a line that can be dragged"),
            ];
            theme::choices(ui, &mut choice.compare, &all);
        });
        if is_flat {
            theme::row(ui, "Look at", "", |ui| {
                if ui.button("all").on_hover_text("Everything  (F)").clicked() {
                    wishes.push(Wish::Frame);
                }
            });
            return;
        }
        theme::row(ui, "Look from", "1, 3, 7; with Ctrl from the other side", |ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            for (axis, name) in [(Axis::Front, "front"), (Axis::Right, "side"), (Axis::Top, "top")] {
                if ui.button(name).clicked() {
                    wishes.push(Wish::LookFrom(axis));
                }
            }
            if ui.button("all").on_hover_text("Everything  (F)").clicked() {
                wishes.push(Wish::Frame);
            }
        });
    });
}

/// The names of the reference shapes, where they stand in the view.
pub(super) fn sizes(ctx: &Context, facts: &Facts, middle: egui::Rect) {
    let layer = egui::LayerId::new(egui::Order::Background, egui::Id::new("sizes"));
    let painter = ctx.layer_painter(layer).with_clip_rect(middle);
    let mut before = egui::Rect::NOTHING;
    for (at, name) in &facts.sizes {
        let galley = painter.layout_no_wrap((*name).into(), egui::FontId::proportional(13.0), Color32::from_gray(40));
        let rect = egui::Align2::CENTER_BOTTOM.anchor_size(*at - egui::vec2(0.0, 3.0), galley.size());
        let paper = rect.expand2(egui::vec2(3.0, 0.0));
        // Names of small shapes that stand close go one above the other.
        let above = if paper.intersects(before) { before.top() - paper.bottom() - 1.0 } else { 0.0 };
        let (rect, paper) = (rect.translate(egui::vec2(0.0, above)), paper.translate(egui::vec2(0.0, above)));
        before = paper;
        painter.rect_filled(paper, 3.0, Color32::from_white_alpha(170));
        painter.galley(rect.min, galley, Color32::BLACK);
    }
}

/// What colours mean, in the lower left corner of the view.
pub(super) fn legend(ctx: &Context, facts: &Facts, middle: egui::Rect) {
    let Some(legend) = &facts.legend else { return };
    // Above the line that says what went wrong or is being done.
    let has_line = facts.problem.is_some() || facts.can_restore || facts.busy.is_some();
    let at = middle.left_bottom() + egui::vec2(16.0, if has_line { -68.0 } else { -16.0 });
    egui::Area::new("legend".into())
        .order(egui::Order::Middle)
        .interactable(false)
        .pivot(egui::Align2::LEFT_BOTTOM)
        .fixed_pos(at)
        .show(ctx, |ui| {
            let fill = Color32::from_white_alpha(225);
            egui::Frame::new().fill(fill).corner_radius(6.0).inner_margin(10.0).show(ui, |ui| bar(ui, legend));
        });
}

const BAR: egui::Vec2 = egui::Vec2::new(200.0, 12.0);

fn bar(ui: &mut Ui, legend: &Legend) {
    ui.spacing_mut().item_spacing.y = 3.0;
    ui.horizontal(|ui| {
        ui.label(egui::RichText::new(legend.title).strong());
        ui.label(theme::weak(legend.unit).small());
    });
    let (rect, _) = ui.allocate_exact_size(BAR + egui::vec2(24.0, 18.0), egui::Sense::hover());
    let bar = egui::Rect::from_min_size(rect.min + egui::vec2(12.0, 0.0), BAR);
    let mut mesh = egui::Mesh::default();
    let last = (legend.stops.len().max(2) - 1) as f32;
    for (k, (_, [r, g, b])) in legend.stops.iter().enumerate() {
        let x = egui::lerp(bar.left()..=bar.right(), k as f32 / last);
        let colour = Color32::from_rgb(*r, *g, *b);
        mesh.colored_vertex(egui::pos2(x, bar.top()), colour);
        mesh.colored_vertex(egui::pos2(x, bar.bottom()), colour);
        if k > 0 {
            let first = 2 * (k as u32 - 1);
            mesh.add_triangle(first, first + 1, first + 2);
            mesh.add_triangle(first + 1, first + 2, first + 3);
        }
    }
    ui.painter().add(mesh);
    let (colour, font) = (Color32::from_gray(30), egui::FontId::proportional(12.0));
    for (t, text) in &legend.ticks {
        let x = egui::lerp(bar.left()..=bar.right(), *t);
        let tick = [egui::pos2(x, bar.bottom()), egui::pos2(x, bar.bottom() + 3.0)];
        ui.painter().line_segment(tick, egui::Stroke::new(1.0, colour));
        let at = egui::pos2(x, bar.bottom() + 3.0);
        ui.painter().text(at, egui::Align2::CENTER_TOP, text, font.clone(), colour);
    }
}
