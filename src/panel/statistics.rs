//! How good it is, and what it cost.

use bevy_egui::egui::{self, Ui};
use egui_plot::{Bar, BarChart, Plot, VLine};

use super::{Facts, solver::group, theme};
use crate::session::Histogram;

pub(super) fn show(ui: &mut Ui, facts: &Facts) {
    theme::section(ui, "Statistics", |ui| {
        let snapshot = facts.snapshot;
        let percent = |value: f64| format!("{:.1} %", value * 100.0);
        if let Some(p95) = snapshot.size_error_p95 {
            theme::row(
                ui,
                "Size error",
                "95th percentile over the elements: how far size achieved is from size asked",
                |ui| {
                    ui.label(egui::RichText::new(percent(p95)).strong());
                    if let Some(outcome) = &snapshot.outcome {
                        ui.label(theme::weak(format!("median {}", percent(outcome.fidelity.median))));
                    }
                },
            );
        }
        if let Some(outcome) = &snapshot.outcome {
            theme::row(
                ui,
                "Distortion",
                "How far elements are from similar, longest over shortest axis: median and 99th percentile",
                |ui| {
                    ui.label(format!("{:.2}", outcome.distortion.median));
                    ui.label(theme::weak(format!("p99 {:.2}", outcome.distortion.p99)));
                },
            );
        }
        if let Some(counts) = snapshot.outcome.as_ref().and_then(|outcome| outcome.classic) {
            theme::row(ui, "Classic", "What the edge optimization alone (Eq. 1) would leave at full growth", |ui| {
                ui.label(format!("{} inverted, {} crossings", group(counts.inverted), group(counts.crossings)));
            });
        }
        if let Some(histogram) = &snapshot.histogram {
            ui.add_space(2.0);
            ui.label(theme::weak("size achieved ÷ asked").small());
            sizes(ui, histogram);
        }
        if !snapshot.seconds.is_empty() {
            ui.add_space(2.0);
            let total: f64 = snapshot.seconds.iter().map(|(_, s)| s).sum();
            ui.label(theme::weak(format!("seconds by stage, {total:.1} s in all")).small());
            ui.scope(|ui| stages(ui, &snapshot.seconds));
        }
        if let Some(milliseconds) = snapshot.dab_milliseconds {
            theme::row(ui, "Dab", "From the last stroke to its linear solution", |ui| {
                ui.label(format!("{milliseconds:.0} ms"))
            });
        }
        if snapshot.lattice.is_none() {
            ui.label(theme::weak("Nothing has been solved yet."));
        }
    });
}

fn plain<'a>(name: &'a str, height: f32) -> Plot<'a> {
    Plot::new(name)
        .height(height)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .allow_axis_zoom_drag(false)
        .show_grid(false)
        .show_background(false)
        .set_margin_fraction(egui::vec2(0.01, 0.06))
}

/// Octaves, ×½ to ×2.
fn sizes(ui: &mut Ui, histogram: &Histogram) {
    let greatest = f64::from(histogram.counts.iter().copied().max().unwrap_or(1).max(1));
    let bars = histogram.counts.iter().enumerate().map(|(bin, &count)| {
        Bar::new(Histogram::octaves(bin), f64::from(count) / greatest)
            .width(1.8 / Histogram::BINS as f64)
            .fill(theme::ACCENT)
    });
    let chart = BarChart::new("elements", bars.collect()).color(theme::ACCENT);
    plain("sizes", 66.0)
        .show_axes([true, false])
        // Room for the names of the ends.
        .include_x(-1.12)
        .include_x(1.12)
        .x_axis_formatter(|mark, _| {
            let close = |octaves: f64| (mark.value - octaves).abs() < 1.0e-6;
            if close(-1.0) {
                "×½".into()
            } else if close(0.0) {
                "×1".into()
            } else if close(1.0) {
                "×2".into()
            } else {
                String::new()
            }
        })
        .show(ui, |plot| {
            plot.vline(VLine::new("just right", 0.0).color(theme::GREEN).width(1.0));
            plot.bar_chart(chart);
        });
}

/// One bar for each stage, the longest first.
fn stages(ui: &mut Ui, seconds: &[(&'static str, f64)]) {
    let mut stages = seconds.to_vec();
    stages.sort_by(|a, b| b.1.total_cmp(&a.1));
    stages.truncate(6);
    let longest = stages.first().map_or(1.0, |(_, s)| s.max(1.0e-9));
    ui.spacing_mut().item_spacing.y = 1.0;
    ui.spacing_mut().interact_size.y = 15.0;
    for (name, s) in stages {
        ui.horizontal(|ui| {
            ui.allocate_ui(egui::vec2(72.0, 15.0), |ui| {
                ui.set_min_width(72.0);
                ui.label(theme::weak(name).small());
            });
            let (rect, _) = ui.allocate_exact_size(egui::vec2(130.0, 9.0), egui::Sense::hover());
            let bar = egui::Rect::from_min_size(rect.min, egui::vec2((130.0 * s / longest) as f32, 9.0));
            ui.painter().rect_filled(rect, 2.0, ui.visuals().faint_bg_color);
            ui.painter().rect_filled(bar, 2.0, theme::ACCENT.gamma_multiply(0.7));
            ui.label(egui::RichText::new(format!("{s:.2}")).small());
        });
    }
}
