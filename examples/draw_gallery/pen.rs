//! A sheet and what is drawn on it: filled and stroked outlines, smooth lines through points.

use tiny_skia::{
    Color, FillRule, GradientStop, LineCap, LineJoin, LinearGradient, Mask, Paint, Path, PathBuilder, Pixmap, Point,
    Shader, SpreadMode, Stroke, Transform,
};

/// A place on the sheet: pixels, y down.
pub type Place = (f32, f32);

/// What is drawn on.
pub struct Sheet {
    /// The pixels.
    pub pixmap: Pixmap,
}

/// An opaque colour as `0xRRGGBB`.
pub fn colour(hex: u32) -> Color {
    faint(hex, 1.0)
}

/// A colour of some opacity in 0..=1.
pub fn faint(hex: u32, opacity: f32) -> Color {
    let channel = |shift: u32| ((hex >> shift) & 0xFF) as f32 / 255.0;
    Color::from_rgba(channel(16), channel(8), channel(0), opacity).expect("channels in 0..=1")
}

/// Between two colours.
pub fn mix(a: u32, b: u32, t: f32) -> Color {
    let (a, b) = (colour(a), colour(b));
    let channel = |a: f32, b: f32| (a + (b - a) * t).clamp(0.0, 1.0);
    Color::from_rgba(channel(a.red(), b.red()), channel(a.green(), b.green()), channel(a.blue(), b.blue()), 1.0)
        .expect("channels in 0..=1")
}

/// A gradient along a line.
pub fn gradient(from: Place, to: Place, stops: &[(f32, Color)]) -> Shader<'static> {
    let stops = stops.iter().map(|(at, colour)| GradientStop::new(*at, *colour)).collect();
    LinearGradient::new(Point::from(from), Point::from(to), stops, SpreadMode::Pad, Transform::identity())
        .expect("two places and two stops")
}

/// A smooth line through points (Catmull-Rom as cubic Béziers), `closed` or with ends.
pub fn smooth(points: &[Place], closed: bool) -> Path {
    let mut builder = PathBuilder::new();
    smooth_into(&mut builder, points, closed);
    builder.finish().expect("two points")
}

/// Adds a smooth line to a path that is being built; without a current point it begins one.
pub fn smooth_into(builder: &mut PathBuilder, points: &[Place], closed: bool) {
    let count = points.len() as isize;
    let at = |i: isize| points[if closed { i.rem_euclid(count) } else { i.clamp(0, count - 1) } as usize];
    if builder.last_point().is_none() || closed {
        builder.move_to(points[0].0, points[0].1);
    }
    for i in 0..if closed { count } else { count - 1 } {
        let (before, from, to, after) = (at(i - 1), at(i), at(i + 1), at(i + 2));
        // Tangents no longer than a third of the piece, so that uneven spacing makes no loops.
        let length = |a: Place, b: Place| (b.0 - a.0).hypot(b.1 - a.1);
        let handle = |a: Place, b: Place| {
            let (chord, reach) = (length(a, b).max(1e-6), length(from, to) / 3.0);
            ((b.0 - a.0) / chord * reach, (b.1 - a.1) / chord * reach)
        };
        let (out, into) = (handle(before, to), handle(from, after));
        builder.cubic_to(from.0 + out.0, from.1 + out.1, to.0 - into.0, to.1 - into.1, to.0, to.1);
    }
    if closed {
        builder.close();
    }
}

/// Straight lines through points.
pub fn polygon(points: &[Place], closed: bool) -> Path {
    let mut builder = PathBuilder::new();
    builder.move_to(points[0].0, points[0].1);
    points[1..].iter().for_each(|p| builder.line_to(p.0, p.1));
    if closed {
        builder.close();
    }
    builder.finish().expect("two points")
}

/// A circle.
pub fn circle(centre: Place, radius: f32) -> Path {
    PathBuilder::from_circle(centre.0, centre.1, radius).expect("a radius > 0")
}

impl Sheet {
    /// A transparent sheet.
    pub fn new(width: u32, height: u32) -> Self {
        Self { pixmap: Pixmap::new(width, height).expect("a size > 0") }
    }

    /// The rows from `top` on.
    pub fn cut_out(self, top: u32, height: u32) -> Self {
        let rows =
            tiny_skia::IntRect::from_xywh(0, top as i32, self.pixmap.width(), height).expect("rows of the sheet");
        Self { pixmap: self.pixmap.clone_rect(rows).expect("rows of the sheet") }
    }

    /// Fills with a colour.
    pub fn fill(&mut self, path: &Path, colour: Color) {
        self.shade(path, Shader::SolidColor(colour), None);
    }

    /// Fills with a gradient, where the mask is if there is one.
    pub fn shade(&mut self, path: &Path, shader: Shader<'_>, mask: Option<&Mask>) {
        let paint = Paint { shader, ..Paint::default() };
        self.pixmap.fill_path(path, &paint, FillRule::Winding, Transform::identity(), mask);
    }

    /// A line with round ends.
    pub fn stroke(&mut self, path: &Path, colour: Color, width: f32) {
        self.stroke_within(path, colour, width, None);
    }

    /// A line with round ends, where the mask is if there is one.
    pub fn stroke_within(&mut self, path: &Path, colour: Color, width: f32, mask: Option<&Mask>) {
        let paint = Paint { shader: Shader::SolidColor(colour), ..Paint::default() };
        let stroke = Stroke { width, line_cap: LineCap::Round, line_join: LineJoin::Round, ..Stroke::default() };
        self.pixmap.stroke_path(path, &paint, &stroke, Transform::identity(), mask);
    }

    /// Fills and strokes with the grey value `id`, without smoothing: a picture of regions.
    pub fn label(&mut self, path: &Path, id: u8, width: f32) {
        let mut paint = Paint { anti_alias: false, ..Paint::default() };
        paint.set_color_rgba8(id, id, id, 255);
        self.pixmap.fill_path(path, &paint, FillRule::Winding, Transform::identity(), None);
        if width > 0.0 {
            let stroke = Stroke { width, line_join: LineJoin::Round, ..Stroke::default() };
            self.pixmap.stroke_path(path, &paint, &stroke, Transform::identity(), None);
        }
    }

    /// Where a path is.
    pub fn mask(&self, path: &Path) -> Mask {
        let mut mask = Mask::new(self.pixmap.width(), self.pixmap.height()).expect("a size > 0");
        mask.fill_path(path, FillRule::Winding, true, Transform::identity());
        mask
    }
}
