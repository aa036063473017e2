//! Title, legend and captions, drawn over the picture.

use std::sync::{Arc, Mutex, PoisonError};

use bevy_egui::egui::{self, Align2, Color32, FontId, Pos2, Rect, Vec2};

use crate::view::Legend;

/// Height of the picture all measures here are made for.
const REFERENCE_HEIGHT: f32 = 720.0;

/// Dark grey: softer than black, and 12:1 against the studio.
const INK: Color32 = Color32::from_rgb(40, 40, 44);

/// For what is secondary, 5:1.
const QUIET_INK: Color32 = Color32::from_rgb(96, 96, 102);

/// What is written over the picture.
#[derive(Debug, Clone, Default)]
pub(super) struct Writing {
    /// Top left.
    pub title: Option<String>,
    /// Bottom left.
    pub legend: Option<Legend>,
    /// Under the left and the right half; a single one is in the middle.
    pub captions: Vec<Caption>,
    /// Whether letters lie on paper, as they must where nobody knows what will be behind them.
    pub on_paper: bool,
}

/// A line under a body.
#[derive(Debug, Clone, Default)]
pub(super) struct Caption {
    /// What it is.
    pub name: String,
    /// What was found.
    pub finding: String,
    /// Whether the finding is a fault.
    pub is_fault: bool,
}

/// Writing that can be changed while it is shown.
#[derive(Debug, Clone, Default)]
pub(super) struct Slate(Arc<Mutex<Writing>>);

impl Slate {
    /// A slate with this on it.
    pub fn new(writing: Writing) -> Self {
        Self(Arc::new(Mutex::new(writing)))
    }

    /// Changes the captions.
    pub fn caption(&self, captions: Vec<Caption>) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).captions = captions;
    }

    /// Draws it.
    pub fn draw(&self, context: &egui::Context) {
        let writing = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let screen = context.viewport_rect();
        let painter = context.layer_painter(egui::LayerId::background());
        let page = Page { painter, screen, unit: unit(screen), on_paper: writing.on_paper };
        if let Some(title) = &writing.title {
            page.title(title);
        }
        if let Some(legend) = &writing.legend {
            page.legend(legend);
        }
        page.captions(&writing.captions);
    }
}

/// Size of one reference pixel: by the height, unless the picture is narrower than an upright phone's.
fn unit(screen: Rect) -> f32 {
    (screen.height() / REFERENCE_HEIGHT).min(screen.width() / (0.56 * REFERENCE_HEIGHT)).max(0.4)
}

/// What writing takes of a screen, from its left, top and bottom edge in pixels: a legend takes the left or the bottom.
pub(super) fn taken(screen: glam::Vec2, title: bool, legend: bool, captions: bool) -> Vec<[f32; 3]> {
    let unit = unit(Rect::from_min_size(Pos2::ZERO, Vec2::new(screen.x, screen.y)));
    let top = unit * if captions { 128.0 } else { f32::from(u8::from(title)) * 68.0 };
    let ways: &[[f32; 2]] = if legend { &[[328.0, 0.0], [0.0, 102.0]] } else { &[[0.0, 0.0]] };
    ways.iter().map(|[left, bottom]| [left * unit, top, bottom * unit]).collect()
}

struct Page {
    painter: egui::Painter,
    screen: Rect,
    unit: f32,
    on_paper: bool,
}

impl Page {
    /// A position in reference pixels from a corner of the picture.
    fn at(&self, corner: Align2, x: f32, y: f32) -> Pos2 {
        corner.pos_in_rect(&self.screen) + Vec2::new(x, y) * self.unit
    }

    fn font(&self, size: f32) -> FontId {
        FontId::proportional(size * self.unit)
    }

    fn paper(&self, rect: Rect) {
        if self.on_paper {
            self.painter.rect_filled(rect.expand(10.0 * self.unit), 6.0 * self.unit, Color32::from_white_alpha(225));
        }
    }

    /// A line of text, as small as it takes to fit into `width` pixels.
    fn line(&self, at: Pos2, anchor: Align2, text: &str, size: f32, width: f32, ink: Color32) -> Rect {
        let natural = self.painter.layout_no_wrap(text.to_owned(), self.font(size), ink);
        let shrunk = size * (width / natural.size().x.max(1.0)).min(1.0);
        let galley = self.painter.layout_no_wrap(text.to_owned(), self.font(shrunk), ink);
        let rect = anchor.anchor_size(at, galley.size());
        self.paper(rect);
        self.painter.galley(rect.min, galley, ink);
        rect
    }

    fn title(&self, title: &str) {
        let width = self.screen.width() - 72.0 * self.unit;
        self.line(self.at(Align2::LEFT_TOP, 36.0, 26.0), Align2::LEFT_TOP, title, 30.0, width, INK);
    }

    /// Name and unit above a bar of colours, ticks below it.
    fn legend(&self, legend: &Legend) {
        let (width, height) = (280.0, 14.0);
        let bar = Rect::from_min_size(self.at(Align2::LEFT_BOTTOM, 36.0, -62.0), Vec2::new(width, height) * self.unit);
        let above = self.at(Align2::LEFT_BOTTOM, 36.0, -70.0);
        let around = Rect::from_min_max(
            self.at(Align2::LEFT_BOTTOM, 36.0, -94.0),
            self.at(Align2::LEFT_BOTTOM, 36.0 + width, -22.0),
        );
        self.paper(around);
        let name = self.painter.text(above, Align2::LEFT_BOTTOM, legend.title, self.font(18.0), INK);
        let beside = name.right_bottom() + Vec2::new(9.0, -1.0) * self.unit;
        self.painter.text(beside, Align2::LEFT_BOTTOM, legend.unit, self.font(15.0), QUIET_INK);
        self.painter.add(gradient(bar, &legend.stops));
        for (place, text) in &legend.ticks {
            let x = bar.left() + place * bar.width();
            let foot = Pos2::new(x, bar.bottom() + 5.0 * self.unit);
            self.painter.line_segment([Pos2::new(x, bar.bottom()), foot], (1.2 * self.unit, INK));
            self.painter.text(foot, Align2::CENTER_TOP, text, self.font(16.0), INK);
        }
    }

    /// A name and a finding under each half.
    fn captions(&self, captions: &[Caption]) {
        let share = self.screen.width() / captions.len().max(1) as f32;
        for (k, caption) in captions.iter().enumerate() {
            let middle = self.screen.left() + (k as f32 + 0.5) * share;
            let at = |y: f32| Pos2::new(middle, self.screen.top() + y * self.unit);
            let ink = if caption.is_fault { Color32::from_rgb(176, 32, 38) } else { QUIET_INK };
            let width = 0.92 * share;
            let name = self.line(at(78.0), Align2::CENTER_TOP, &caption.name, 19.0, width, INK);
            let below = Pos2::new(middle, name.bottom() + 2.0 * self.unit);
            self.line(below, Align2::CENTER_TOP, &caption.finding, 16.0, width, ink);
        }
    }
}

/// A bar of colours, evenly spaced from left to right.
fn gradient(bar: Rect, stops: &[(f32, [u8; 3])]) -> egui::Mesh {
    let mut mesh = egui::Mesh::default();
    let last = stops.len().saturating_sub(1).max(1) as f32;
    for (k, &(_, [r, g, b])) in stops.iter().enumerate() {
        let x = bar.left() + bar.width() * k as f32 / last;
        let colour = Color32::from_rgb(r, g, b);
        mesh.colored_vertex(Pos2::new(x, bar.top()), colour);
        mesh.colored_vertex(Pos2::new(x, bar.bottom()), colour);
        if k > 0 {
            let at = 2 * k as u32;
            mesh.add_triangle(at - 2, at - 1, at);
            mesh.add_triangle(at - 1, at + 1, at);
        }
    }
    mesh
}
