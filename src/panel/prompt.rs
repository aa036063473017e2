//! Paths typed in the window, where the system shows no file dialog.

use std::path::PathBuf;

use bevy_egui::egui::{self, Context, Key, RichText};

use super::{Asked, Choice, Wish, theme};

/// Paths being typed.
#[derive(Debug, Clone, PartialEq)]
pub struct Prompt {
    /// What for.
    pub asked: Asked,
    /// One path, of tables of regions two.
    pub paths: Vec<String>,
}

impl Prompt {
    /// Asks for what a dialog would have asked for, beginning with a proposal.
    pub fn new(asked: Asked, proposed: String) -> Self {
        let paths = match asked {
            Asked::Layer(offered) => vec![String::new(); offered.words().files.len()],
            _ => vec![proposed],
        };
        Self { asked, paths }
    }

    /// What was typed, if all of it was.
    fn typed(&self) -> Option<Vec<PathBuf>> {
        let path = |path: &String| Some(path.trim()).filter(|path| !path.is_empty()).map(PathBuf::from);
        self.paths.iter().map(path).collect()
    }
}

/// Title, names of the paths, and what the button does.
fn words(asked: Asked) -> (&'static str, Vec<&'static str>, &'static str) {
    let (title, verb) = match asked {
        Asked::Layer(offered) => {
            let offer = offered.words();
            return (offer.title, offer.files.iter().map(|file| file.name).collect(), "Add");
        }
        Asked::Open => ("Open", "Open"),
        Asked::SaveScene => ("Save the scene", "Save"),
        Asked::ExportMesh | Asked::ExportGrowth | Asked::ExportReport => ("Export", "Save"),
        Asked::ExportFilm => ("Where to record the film", "Choose"),
    };
    (title, vec!["File"], verb)
}

pub(super) fn show(ctx: &Context, choice: &mut Choice, wishes: &mut Vec<Wish>) {
    let Some(prompt) = &mut choice.prompt else { return };
    let (title, names, verb) = words(prompt.asked);
    let (mut is_open, mut is_given) = (true, false);
    // Over the dialog it was asked from.
    let dialog = theme::dialog(ctx, title, &mut is_open).id("prompt".into());
    dialog.order(egui::Order::Foreground).show(ctx, |ui| {
        ui.set_width(380.0);
        let why = "This system shows no file dialog, which needs xdg-desktop-portal or zenity: type the path here.";
        ui.label(theme::weak(why));
        ui.add_space(6.0);
        for (k, (path, name)) in prompt.paths.iter_mut().zip(names).enumerate() {
            theme::row(ui, name, "", |ui| {
                let field = ui.add(egui::TextEdit::singleline(path).desired_width(280.0).hint_text("folder/name"));
                is_given |= field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
                // It takes the keyboard when it comes, and keeps it until it has what it asks for.
                if k == 0 && !is_given && ui.memory(|memory| memory.focused().is_none()) {
                    field.request_focus();
                }
            });
        }
        ui.add_space(4.0);
        ui.horizontal(|ui| {
            let folder = std::env::current_dir().map(|folder| folder.display().to_string()).unwrap_or_default();
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                ui.add_enabled_ui(prompt.typed().is_some(), |ui| is_given |= theme::primary(ui, verb).clicked());
                ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                    let from = RichText::new(format!("from {folder}")).small();
                    ui.add(egui::Label::new(from.weak()).truncate());
                });
            });
        });
    });
    if let Some(paths) = prompt.typed().filter(|_| is_given) {
        wishes.push(Wish::Choose(prompt.asked, paths));
        is_open = false;
    }
    if !is_open {
        choice.prompt = None;
    }
}
