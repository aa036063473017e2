//! What is compared: names over both sides, and the line between them that can be moved.

use bevy_egui::egui::{self, Align2, Color32, Context, CursorIcon, FontId, Pos2, Rect, Sense, vec2};

use super::{Choice, Compare, Facts, theme};
use crate::session::Phase;

/// Width of what can be taken hold of, points.
const GRIP: f32 = 18.0;

/// Radius of the handle, points.
const HANDLE: f32 = 13.0;

/// Ends of the line: further out there is nothing to take hold of.
const ENDS: std::ops::RangeInclusive<f32> = 0.03..=0.97;

pub(super) fn show(ctx: &Context, facts: &Facts, choice: &mut Choice, middle: Rect) {
    if facts.snapshot.lattice.is_none() || choice.compare == Compare::Off {
        return;
    }
    let parts = match choice.compare {
        Compare::Wipe => {
            let x = line(ctx, choice, middle);
            [(middle.left(), x), (x, middle.right())]
        }
        _ => [(middle.left(), middle.center().x), (middle.center().x, middle.right())],
    };
    let painter = ctx.layer_painter(egui::LayerId::new(egui::Order::Background, egui::Id::new("compared")));
    for ((left, right), name) in parts.into_iter().zip(names(facts)) {
        caption(&painter, Rect::from_x_y_ranges(left..=right, middle.y_range()), &name);
    }
}

/// What stands over a side.
struct Name {
    name: &'static str,
    finding: String,
    ink: Color32,
}

fn names(facts: &Facts) -> [Name; 2] {
    let outcome = facts.snapshot.outcome.as_ref().filter(|_| facts.snapshot.phase == Phase::Done);
    let count = |n: usize, one: &str| format!("{n} {one}{}", if n == 1 { "" } else { "s" });
    let told = |inverted: usize, crossings: usize| {
        let is_sound = inverted + crossings == 0;
        let text = format!("{}, {}", count(inverted, "inverted element"), count(crossings, "crossing"));
        (text, if is_sound { theme::GREEN } else { theme::RED })
    };
    let (classic, red) = match outcome.and_then(|outcome| outcome.classic) {
        Some(counts) => {
            let (text, ink) = told(counts.inverted, counts.crossings);
            (format!("at full growth: {text}"), ink)
        }
        None => (String::new(), theme::RED),
    };
    let film = &facts.snapshot.film;
    let (certified, green) = match film.iter().find(|state| !state.certificate.certified()) {
        _ if outcome.is_none() => (String::new(), theme::AMBER),
        None => (format!("{} in all {} keyframes", told(0, 0).0, film.len()), theme::GREEN),
        Some(state) => {
            let found = &state.certificate;
            let (text, _) = told(found.inverted(), found.crossings() + found.surface_crossings());
            (format!("at λ {:.2}: {text}", state.lambda), theme::RED)
        }
    };
    [
        Name { name: "linear solution alone (Eq. 1)", finding: classic, ink: red },
        Name { name: "certified growth", finding: certified, ink: green },
    ]
}

/// A name and what was found, at the top of a side; not where they would not fit.
fn caption(painter: &egui::Painter, side: Rect, name: &Name) {
    let lay = |text: &str, size: f32, ink| painter.layout_no_wrap(text.to_owned(), FontId::proportional(size), ink);
    let lines = [lay(name.name, 13.0, Color32::from_rgb(0x24, 0x29, 0x30)), lay(&name.finding, 12.0, name.ink)];
    let widest = lines.iter().map(|line| line.size().x).fold(0.0, f32::max);
    if widest + 24.0 > side.width() {
        return;
    }
    let mut at = Pos2::new(side.center().x, side.top() + 12.0);
    for line in lines {
        let rect = Align2::CENTER_TOP.anchor_size(at, line.size());
        at.y = rect.bottom() + 2.0;
        painter.galley(rect.min, line, Color32::BLACK);
    }
}

/// The line between both sides; where it is, points.
fn line(ctx: &Context, choice: &mut Choice, middle: Rect) -> f32 {
    let at = |wipe: f32| egui::lerp(middle.x_range(), wipe.clamp(*ENDS.start(), *ENDS.end()));
    let grip = Rect::from_center_size(Pos2::new(at(choice.wipe), middle.center().y), vec2(GRIP, middle.height()));
    let response = egui::Area::new("wipe".into())
        .order(egui::Order::Middle)
        .fixed_pos(grip.min)
        .constrain(false)
        .show(ctx, |ui| ui.allocate_response(grip.size(), Sense::drag()))
        .inner
        .on_hover_and_drag_cursor(CursorIcon::ResizeHorizontal);
    if response.dragged() && middle.width() > 0.0 {
        choice.wipe = (choice.wipe + response.drag_delta().x / middle.width()).clamp(*ENDS.start(), *ENDS.end());
    }
    let x = at(choice.wipe);
    let painter = ctx.layer_painter(egui::LayerId::new(egui::Order::Middle, egui::Id::new("wipe line")));
    let colour = if response.hovered() || response.dragged() { theme::ACCENT } else { Color32::from_gray(70) };
    painter.vline(x, middle.y_range(), (3.0, Color32::from_white_alpha(200)));
    painter.vline(x, middle.y_range(), (1.0, colour));
    let centre = Pos2::new(x, middle.center().y);
    painter.circle(centre, HANDLE, Color32::WHITE, (1.0, colour));
    for side in [-1.0, 1.0] {
        let tip = centre + vec2(side * 8.5, 0.0);
        let arrow = vec![tip, tip + vec2(-side * 5.0, -4.0), tip + vec2(-side * 5.0, 4.0)];
        painter.add(egui::Shape::convex_polygon(arrow, colour, egui::Stroke::NONE));
    }
    x
}
