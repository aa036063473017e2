//! Keys and mouse, over everything.

use bevy_egui::egui::{self, Context};

use super::{Choice, theme};

/// What the hand can do, in groups.
const KEYS: [(&str, &[(&str, &str)]); 4] = [
    (
        "View",
        &[
            ("drag", "turn (right drag while painting); move a picture"),
            ("middle or Shift + drag", "move"),
            ("wheel", "nearer, farther, to the pointer"),
            ("F", "everything"),
            ("1  3  7", "front, side, top (Ctrl: other side)"),
            ("T", "turntable"),
        ],
    ),
    (
        "Paint",
        &[
            ("B  G  V", "paint, fill, view"),
            ("[  ]", "smaller, larger brush"),
            ("Ctrl + Z", "undo"),
            ("Ctrl + Shift + Z, Ctrl + Y", "redo"),
            ("Esc", "drop the stroke; stop"),
        ],
    ),
    ("Film", &[("space", "play, pause"), ("left  right", "keyframe before, next"), ("Home  End", "rest, grown")]),
    (
        "Files",
        &[
            ("Ctrl + O", "open"),
            ("Ctrl + S", "save the scene"),
            ("Ctrl + R", "record a film"),
            ("F12", "picture of the window"),
            ("drop", "mesh, picture, table, scene"),
            ("?  F1", "this help"),
        ],
    ),
];

pub(super) fn show(ctx: &Context, choice: &mut Choice) {
    theme::dialog(ctx, "Keys and mouse", &mut choice.help).show(ctx, |ui| {
        egui::Grid::new("help").num_columns(2).spacing([40.0, 18.0]).show(ui, |ui| {
            for pair in KEYS.chunks(2) {
                for (title, keys) in pair {
                    ui.vertical(|ui| {
                        ui.label(egui::RichText::new(*title).heading().strong());
                        egui::Grid::new(*title).num_columns(2).spacing([14.0, 5.0]).show(ui, |ui| {
                            for (key, does) in *keys {
                                ui.label(egui::RichText::new(*key).color(theme::ACCENT));
                                ui.label(*does);
                                ui.end_row();
                            }
                        });
                    });
                }
                ui.end_row();
            }
        });
    });
}
