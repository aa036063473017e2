//! What is open, what else there is to open.

use bevy_egui::egui::{self, Ui};

use super::{Asked, Choice, Facts, Wish, theme};
use crate::{gallery, scene::Source};

pub(super) fn show(ui: &mut Ui, facts: &Facts, choice: &mut Choice, wishes: &mut Vec<Wish>) {
    theme::section(ui, "Scene", |ui| {
        theme::row(ui, "Built in", "Models and pictures that come with the program", |ui| {
            let open = match facts.draft.map(|draft| &draft.source) {
                Some(Source::Gallery(name)) => name.as_str(),
                _ => "choose",
            };
            egui::ComboBox::from_id_salt("gallery").width(150.0).selected_text(open).show_ui(ui, |ui| {
                for entry in gallery::list().iter().copied().chain(gallery::picture::list()) {
                    let chosen = ui.selectable_label(open == entry.name, entry.name);
                    if chosen.on_hover_text(format!("{}\n{}", entry.one_line, entry.reference)).clicked() {
                        wishes.push(Wish::Open(Source::Gallery(entry.name.into())));
                    }
                }
            });
        });
        theme::row(ui, "Recent", "Opened lately", |ui| {
            ui.add_enabled_ui(!facts.recent.is_empty(), |ui| {
                let text = if facts.recent.is_empty() { "none yet" } else { "choose" };
                egui::ComboBox::from_id_salt("recent").width(150.0).selected_text(text).show_ui(ui, |ui| {
                    for path in facts.recent {
                        let name =
                            path.file_name().map_or_else(|| path.to_string_lossy(), |name| name.to_string_lossy());
                        if ui.selectable_label(false, name).on_hover_text(path.display().to_string()).clicked() {
                            wishes.push(Wish::OpenPath(path.clone()));
                        }
                    }
                });
            });
        });
        theme::row(ui, "Path", "Opens a mesh, picture, table or scene by its path", |ui| {
            let field = egui::TextEdit::singleline(&mut choice.typed_path)
                .hint_text("type, or drop a file")
                .desired_width(150.0);
            let entered = ui.add(field).lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter));
            if entered && !choice.typed_path.trim().is_empty() {
                wishes.push(Wish::OpenPath(choice.typed_path.trim().into()));
                choice.typed_path.clear();
            }
        });
        ui.horizontal(|ui| {
            if ui.button("Gallery…").on_hover_text("All that is built in, as pictures").clicked() {
                choice.gallery = true;
            }
            if ui.add_enabled(facts.draft.is_some(), egui::Button::new("Save as…")).clicked() {
                wishes.push(Wish::Ask(Asked::SaveScene));
            }
            if ui.button("Picture").on_hover_text("Saves a picture of the window  (F12)").clicked() {
                wishes.push(Wish::Screenshot);
            }
        });
        for warning in facts.warnings.iter().take(3) {
            ui.label(egui::RichText::new(warning).small().color(theme::AMBER));
        }
    });
}
