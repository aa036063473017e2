//! How it is solved: resolution, fidelity, and what is folded away.

use bevy_egui::egui::{self, Response, Ui};

use super::{Facts, Wish, theme};
use crate::{
    diagnostics::human_bytes,
    settings::MAX_KEYS,
    voxel::{MAX_FLAT_RESOLUTION, MAX_RESOLUTION, MIN_RESOLUTION, memory_estimate},
};

/// What is being dragged: the solver is told when it is let go.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Pending {
    resolution: Option<u32>,
    fidelity: Option<f32>,
    keys: Option<usize>,
}

/// A widget whose value counts when it is let go.
fn settled<T: Copy>(
    ui: &mut Ui,
    pending: &mut Option<T>,
    current: T,
    add: impl FnOnce(&mut Ui, &mut T) -> Response,
) -> Option<T> {
    let mut value = pending.unwrap_or(current);
    let response = add(ui, &mut value);
    if response.changed() {
        *pending = Some(value);
    }
    let is_let_go = response.drag_stopped() || (response.changed() && !response.dragged());
    if is_let_go { pending.take() } else { None }
}

pub(super) fn show(ui: &mut Ui, facts: &Facts, pending: &mut Pending, wishes: &mut Vec<Wish>) {
    theme::section(ui, "Solver", |ui| {
        let Some(draft) = facts.draft else {
            ui.label(theme::weak("Nothing is open."));
            return;
        };
        let resolution = theme::row(
            ui,
            "Resolution",
            "Cells along the longest side, 8 to 256, of a picture 8 to 512: finer shows more and takes longer",
            |ui| {
                settled(ui, &mut pending.resolution, draft.resolution, |ui, value| {
                    let most = if facts.is_flat() { MAX_FLAT_RESOLUTION } else { MAX_RESOLUTION };
                    ui.add(egui::Slider::new(value, MIN_RESOLUTION..=most).logarithmic(true))
                })
            },
        );
        wishes.extend(resolution.map(Wish::SetResolution));
        let fidelity = theme::row(ui, "Fidelity", "μ, 0 to 1: 0 keeps shape, 1 reaches the size asked for", |ui| {
            settled(ui, &mut pending.fidelity, draft.fidelity, |ui, value| {
                ui.add(egui::Slider::new(value, 0.0..=1.0).max_decimals(2))
            })
        });
        wishes.extend(fidelity.map(Wish::SetFidelity));
        theme::folded(ui, "Advanced", false, |ui| {
            let keys = theme::row(
                ui,
                "Keyframes",
                "Of the growth, 1 to 64; more are put in where a blend would not be valid",
                |ui| {
                    settled(ui, &mut pending.keys, draft.keys, |ui, value| {
                        ui.add(egui::Slider::new(value, 1..=MAX_KEYS))
                    })
                },
            );
            wishes.extend(keys.map(Wish::SetKeys));
            if let Some(lattice) = &facts.snapshot.lattice {
                let domain = &lattice.summary;
                let memory = human_bytes(memory_estimate(domain.cells as f64));
                let is_flat = facts.is_flat();
                let cell_size = domain.cell_size;
                let rows = [
                    ("Surface", format!("{} triangles", group(lattice.boundary.triangles.len()))),
                    ("Cells", group(domain.cells)),
                    ("Nodes", group(domain.nodes)),
                    ("Elements", group(domain.elements)),
                    ("Cell size", if is_flat { format!("{cell_size:.2} pixels") } else { format!("{cell_size:.4}") }),
                    ("Welds", format!("{} suspected", domain.suspected_welds)),
                    ("Memory", format!("about {memory}")),
                ];
                // The cells of a picture glue nothing.
                for (name, value) in rows.into_iter().filter(|(name, _)| !(is_flat && *name == "Welds")) {
                    theme::row(ui, name, "", |ui| ui.label(value));
                }
            }
        });
    });
}

/// `12345` as `12 345`.
pub(super) fn group(number: usize) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) {
            text.push('\u{a0}');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    #[test]
    fn numbers_are_grouped() {
        assert_eq!(super::group(1_234_567), "1\u{a0}234\u{a0}567");
        assert_eq!(super::group(12), "12");
    }
}
