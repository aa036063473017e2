//! The film at the bottom: play, scrub, keyframes.

use bevy_egui::egui::{self, Sense, Ui, pos2, vec2};

use super::{Choice, Easing, Facts, Repeat, theme};

pub(super) fn show(root: &mut Ui, facts: &Facts, choice: &mut Choice) {
    egui::Panel::bottom("film").frame(theme::bar_frame()).show(root, |ui| {
        let film = &facts.snapshot.film;
        ui.add_enabled_ui(film.len() > 1, |ui| {
            ui.horizontal(|ui| {
                let player = &mut choice.player;
                let keys: Vec<f32> = film.iter().map(|state| state.lambda).collect();
                if ui.button("⏮").on_hover_text("To the keyframe before  (left)").clicked() {
                    player.step(&keys, false);
                }
                let (sign, hint) = if player.is_playing { ("⏸", "Pause  (space)") } else { ("▶", "Play  (space)") };
                let play = egui::Button::new(egui::RichText::new(sign).size(15.0)).min_size(vec2(34.0, 24.0));
                if ui.add(play).on_hover_text(hint).clicked() {
                    player.toggle();
                }
                if ui.button("⏭").on_hover_text("To the next keyframe  (right)").clicked() {
                    player.step(&keys, true);
                }
                let readout = format!("λ {:.3}", player.lambda());
                ui.add_sized([58.0, 24.0], egui::Label::new(egui::RichText::new(readout).monospace()))
                    .on_hover_text("Growth: 0 is the rest shape, 1 all of what is asked for");
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                    #[cfg(feature = "record")]
                    record(ui, facts, choice);
                    settings(ui, choice);
                    track(ui, facts, choice);
                });
            });
        });
    });
}

/// Opens the record dialog; while a film is being recorded it says how far it is.
#[cfg(feature = "record")]
fn record(ui: &mut Ui, facts: &Facts, choice: &mut Choice) {
    let text = match &facts.filming {
        Some(film) => format!("⏺ {} %", 100 * film.drawn / film.frames.max(1)),
        None => "⏺ Record…".into(),
    };
    let text = egui::RichText::new(text).color(theme::RED);
    let hint = "A film of the growth: MP4, GIF, PNGs  (Ctrl+R)";
    if ui.add(egui::Button::new(text).min_size(vec2(84.0, 24.0))).on_hover_text(hint).clicked() {
        super::record::open(choice, facts.title);
    }
}

/// From right to left.
fn settings(ui: &mut Ui, choice: &mut Choice) {
    let player = &mut choice.player;
    let speed = egui::DragValue::new(&mut player.speed).range(0.1..=8.0).speed(0.02).prefix("×").max_decimals(2);
    ui.add(speed).on_hover_text("Speed: ×1 grows in four seconds");
    let mut easing = player.easing;
    egui::ComboBox::from_id_salt("easing")
        .width(70.0)
        .selected_text(if easing == Easing::Smooth { "smooth" } else { "linear" })
        .show_ui(ui, |ui| {
            ui.selectable_value(&mut easing, Easing::Smooth, "smooth").on_hover_text("Slowly at both ends");
            ui.selectable_value(&mut easing, Easing::Linear, "linear").on_hover_text("Evenly");
        });
    if easing != player.easing {
        player.set_easing(easing);
    }
    let name = |repeat| match repeat {
        Repeat::Once => "once",
        Repeat::Loop => "loop",
        Repeat::PingPong => "ping-pong",
    };
    egui::ComboBox::from_id_salt("repeat").width(84.0).selected_text(name(player.repeat)).show_ui(ui, |ui| {
        for repeat in [Repeat::Once, Repeat::Loop, Repeat::PingPong] {
            ui.selectable_value(&mut player.repeat, repeat, name(repeat));
        }
    });
}

/// The line that can be scrubbed, a tick for each keyframe: green when certified, red when not.
fn track(ui: &mut Ui, facts: &Facts, choice: &mut Choice) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 24.0), Sense::click_and_drag());
    let line = rect.shrink2(vec2(10.0, 0.0));
    let x = |lambda: f32| egui::lerp(line.left()..=line.right(), lambda);
    if let Some(pointer) = response.interact_pointer_pos()
        && line.width() > 0.0
    {
        choice.player.scrub((pointer.x - line.left()) / line.width());
    }
    let painter = ui.painter();
    let rail = |from: f32, to: f32, colour| {
        let rect = egui::Rect::from_x_y_ranges(x(from)..=x(to), line.center().y - 2.0..=line.center().y + 2.0);
        painter.rect_filled(rect, 2.0, colour);
    };
    rail(0.0, 1.0, ui.visuals().widgets.inactive.bg_fill);
    if !ui.is_enabled() {
        return;
    }
    let solved = facts.snapshot.film.last().map_or(0.0, |state| state.lambda);
    let lambda = choice.player.lambda();
    rail(0.0, solved, theme::ACCENT.gamma_multiply(0.25));
    rail(0.0, lambda.min(solved), theme::ACCENT);
    for state in &facts.snapshot.film {
        let colour = if state.certificate.certified() { theme::GREEN } else { theme::RED };
        let at = x(state.lambda);
        let ends = [pos2(at, line.center().y + 5.0), pos2(at, line.center().y + 10.0)];
        painter.line_segment(ends, egui::Stroke::new(1.5, colour));
    }
    let knob = pos2(x(lambda), line.center().y);
    painter.circle_filled(knob, if response.hovered() { 7.5 } else { 6.5 }, egui::Color32::WHITE);
    painter.circle_stroke(knob, if response.hovered() { 7.5 } else { 6.5 }, egui::Stroke::new(2.0, theme::ACCENT));
}
