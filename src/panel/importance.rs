//! Importance: the brush, fills, and the layers below them.

use bevy_egui::egui::{self, Ui};

use super::{Asked, Choice, Facts, Tool, Wish, theme};
use crate::{
    format::Kind,
    importance::{CLAMP_MAX, CLAMP_MIN, Layer, Offered},
    paint::{Action, Axis, Falloff, Fill},
    subject::Painting,
};

/// A slider for a size factor: even in ratio.
fn factor(ui: &mut Ui, value: &mut f32) -> egui::Response {
    ui.add(egui::Slider::new(value, CLAMP_MIN..=CLAMP_MAX).logarithmic(true).max_decimals(2).prefix("×"))
}

pub(super) fn show(ui: &mut Ui, facts: &Facts, choice: &mut Choice, wishes: &mut Vec<Wish>) {
    theme::section(ui, "Importance", |ui| {
        brush(ui, facts, choice);
        ui.add_space(4.0);
        theme::folded(ui, "Fill", choice.tool == Tool::Fill, |ui| fill(ui, facts, choice, wishes));
        theme::folded(ui, "Layers", true, |ui| layers(ui, facts, wishes));
    });
}

fn brush(ui: &mut Ui, facts: &Facts, choice: &mut Choice) {
    let before = choice.brush;
    let brush = &mut choice.brush;
    theme::choices(
        ui,
        &mut brush.action,
        &[
            (Action::Set, "Set", "Towards a size"),
            (Action::Add, "Add", "Times a factor"),
            (Action::Subtract, "Subtract", "Divided by a factor"),
            (Action::Smooth, "Smooth", "Evens out"),
            (Action::Erase, "Erase", "Back to what the layers say"),
        ],
    );
    ui.add_space(2.0);
    let needs_value = matches!(brush.action, Action::Set | Action::Add | Action::Subtract);
    theme::row(ui, "Value", "Importance: the linear size factor asked for; 2 means twice as long, 1 keeps", |ui| {
        ui.add_enabled_ui(needs_value, |ui| factor(ui, &mut brush.value));
    });
    theme::row(ui, "Strength", "How much of it one stroke does, 0 to 1", |ui| {
        ui.add(egui::Slider::new(&mut brush.strength, 0.0..=1.0).max_decimals(2));
    });
    theme::row(ui, "Size", "Radius as a part of the longest side  ([ and ])", |ui| {
        let percent = egui::Slider::new(&mut choice.brush_size, 0.005..=0.5).logarithmic(true);
        ui.add(percent.custom_formatter(|v, _| format!("{:.1} %", v * 100.0)).custom_parser(parse_percent));
    });
    theme::row(ui, "Falloff", "How the brush fades from its middle to its rim", |ui| {
        let all = [(Falloff::Smooth, "smooth", ""), (Falloff::Linear, "linear", ""), (Falloff::Constant, "hard", "")];
        theme::choices(ui, &mut brush.falloff, &all);
    });
    theme::row(ui, "Mirror", "Paints the other side of the middle as well", |ui| {
        let axes = if facts.is_flat() { 2 } else { 3 };
        for (axis, name) in ["X", "Y", "Z"].into_iter().enumerate().take(axes) {
            ui.toggle_value(&mut brush.mirror[axis], name);
        }
    });
    // Who changes the brush wants to paint.
    if *brush != before && choice.tool == Tool::Orbit {
        choice.tool = Tool::Paint;
    }
}

fn parse_percent(text: &str) -> Option<f64> {
    text.trim().trim_end_matches('%').trim().parse::<f64>().ok().map(|percent| percent / 100.0)
}

fn fill(ui: &mut Ui, facts: &Facts, choice: &mut Choice, wishes: &mut Vec<Wish>) {
    theme::row(ui, "Value", "Importance that is filled in", |ui| factor(ui, &mut choice.fill_value));
    let value = choice.fill_value;
    let is_open = facts.painting.is_some();
    ui.add_enabled_ui(is_open, |ui| {
        theme::row(ui, "Fill", "", |ui| {
            if ui.button("All").clicked() {
                wishes.push(Wish::Fill(Fill::All { value }));
            }
            let regions = facts.painting.map_or(&[][..], |painting| painting.canvas().region_names());
            ui.add_enabled_ui(!regions.is_empty(), |ui| {
                egui::ComboBox::from_id_salt("region").width(96.0).selected_text("a region").show_ui(ui, |ui| {
                    for name in regions {
                        if ui.selectable_label(false, name).clicked() {
                            wishes.push(Wish::Fill(Fill::Region { name: name.clone(), value }));
                        }
                    }
                });
            });
        });
        ui.label(theme::weak("Or click a piece of the surface with the Fill tool.").small());
        theme::row(ui, "Gradient", "Importance at the low and the high end of the box around everything", |ui| {
            for end in &mut choice.gradient {
                ui.add(egui::DragValue::new(end).range(CLAMP_MIN..=CLAMP_MAX).speed(0.02).prefix("×"));
            }
        });
        theme::row(ui, "Along", "Fills the gradient in along an axis", |ui| {
            let [from, to] = choice.gradient;
            let axes = if facts.is_flat() { 2 } else { 3 };
            for (axis, name) in [(Axis::X, "X"), (Axis::Y, "Y"), (Axis::Z, "Z")].into_iter().take(axes) {
                if ui.button(name).clicked() {
                    wishes.push(Wish::Fill(Fill::Gradient { axis, from, to }));
                }
            }
        });
    });
}

fn layers(ui: &mut Ui, facts: &Facts, wishes: &mut Vec<Wish>) {
    let Some((draft, painting)) = facts.draft.zip(facts.painting) else {
        ui.label(theme::weak("Open something first."));
        return;
    };
    let strokes = painting.edits().len();
    if strokes > 0 {
        ui.label(format!("✏ painted: {strokes} {}", if strokes == 1 { "stroke" } else { "strokes" }));
    }
    for (index, layer) in draft.layers.iter().enumerate().rev() {
        ui.horizontal(|ui| {
            let mut shown = !draft.hidden.contains(&index);
            if ui.checkbox(&mut shown, "").on_hover_text("Whether this layer counts").changed() {
                wishes.push(Wish::ShowLayer(index, shown));
            }
            let width = ui.available_width() - 32.0;
            ui.allocate_ui(egui::vec2(width, 20.0), |ui| {
                let (name, hint) = layer.describe();
                ui.add(egui::Label::new(name).truncate()).on_hover_text(hint);
            });
            if ui.small_button("✖").on_hover_text("Removes the layer").clicked() {
                wishes.push(Wish::RemoveLayer(index));
            }
        });
    }
    // What is said of a built-in picture takes the place of its own; a model's lies below.
    let has_own = matches!(draft.source, crate::scene::Source::Gallery(_));
    if has_own && (!facts.is_flat() || draft.layers.is_empty()) {
        ui.label(theme::weak("the model's own importance"));
    }
    theme::row(ui, "Base", "Importance where nothing else is said", |ui| {
        let mut base = draft.base;
        if ui.add(egui::DragValue::new(&mut base).range(CLAMP_MIN..=CLAMP_MAX).speed(0.01).prefix("×")).changed() {
            wishes.push(Wish::SetBase(base));
        }
        add(ui, painting, facts.kind(), wishes);
    });
}

fn add(ui: &mut Ui, painting: &Painting, kind: Kind, wishes: &mut Vec<Wish>) {
    ui.menu_button("Add layer…", |ui| {
        for offered in Offered::ALL {
            let Some(offer) = offered.offer(kind) else { continue };
            if ui.button(offer.name).on_hover_text(offer.hint).clicked() {
                wishes.push(Wish::Ask(Asked::Layer(offered)));
            }
        }
        let attributes = &painting.under().boundary.attributes;
        ui.add_enabled_ui(!attributes.is_empty(), |ui| {
            ui.menu_button("Attribute", |ui| {
                for attribute in attributes {
                    if ui
                        .button(&attribute.name)
                        .on_hover_text("Its least value becomes ×0.5, its greatest ×2")
                        .clicked()
                    {
                        let range = Some(crate::importance::IMAGE_RANGE);
                        wishes.push(Wish::AddLayer(Layer::Attribute { name: attribute.name.clone(), range }));
                    }
                }
            });
        });
    });
}
