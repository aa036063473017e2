//! A horseshoe magnet, its two steel tips facing down.

use tiny_skia::{Path, PathBuilder};

use crate::pen::{Place, Sheet, colour, faint, gradient, polygon};

const WIDTH: u32 = 760;
const HEIGHT: u32 = 900;

/// Middle of the bow.
const CENTRE: Place = (380.0, 340.0);
/// From the middle to the middle of the bar.
const RADIUS: f32 = 190.0;
/// Half the bar's width.
const HALF: f32 = 78.0;
/// Where the paint ends and the steel begins, and where that ends.
const PAINT_END: f32 = 660.0;
const STEEL_END: f32 = 838.0;

/// The picture.
pub fn draw() -> Sheet {
    let mut sheet = Sheet::new(WIDTH, HEIGHT);
    let whole = bar(HALF, STEEL_END, 0.0);
    sheet.stroke(&whole, colour(0x2B2D33), 12.0);

    // Two halves in two colours, rounded by light from the upper left.
    for (side, dark, base, light) in [(-1.0, 0x8E1420, 0xD3202F, 0xF4737A), (1.0, 0x123A7A, 0x1F5FC0, 0x74A6EE)] {
        let middle = CENTRE.0;
        let half = polygon(
            &[(middle, 0.0), (middle + side * 380.0, 0.0), (middle + side * 380.0, PAINT_END), (middle, PAINT_END)],
            true,
        );
        let clip = sheet.mask(&half);
        let steps = 26;
        for step in 0..steps {
            let t = step as f32 / (steps - 1) as f32;
            // From the rim inwards, the light line a little to the left of the middle.
            let tone = if t < 0.6 {
                crate::pen::mix(dark, base, (t / 0.6).powf(0.8))
            } else {
                crate::pen::mix(base, light, ((t - 0.6) / 0.4).powi(2) * 0.8)
            };
            let ring = bar(HALF * (1.0 - t).max(0.03), PAINT_END + 2.0, -14.0 * t);
            sheet.shade(&ring, tiny_skia::Shader::SolidColor(tone), Some(&clip));
        }
    }
    // Steel.
    for side in [-1.0_f32, 1.0] {
        let x = CENTRE.0 + side * RADIUS;
        let tip = rectangle(x - HALF, PAINT_END, x + HALF, STEEL_END);
        let stops = [
            (0.0, colour(0x6D747D)),
            (0.12, colour(0xAEB5BD)),
            (0.34, colour(0xF7F9FB)),
            (0.55, colour(0xC3C9D0)),
            (0.85, colour(0x8B929B)),
            (1.0, colour(0x5C626B)),
        ];
        sheet.shade(&tip, gradient((x - HALF, 0.0), (x + HALF, 0.0), &stops), None);
        let lip = rectangle(x - HALF, PAINT_END - 3.0, x + HALF, PAINT_END + 4.0);
        sheet.fill(&lip, faint(0x2B2D33, 0.75));
        // Ground lines in the steel: whether straight lines stay smooth is seen on them.
        for line in 1..6 {
            let y = PAINT_END + (STEEL_END - PAINT_END) * line as f32 / 6.0;
            sheet.stroke(&polygon(&[(x - HALF + 8.0, y), (x + HALF - 8.0, y)], false), faint(0x50565E, 0.35), 2.0);
        }
        letter(&mut sheet, (x, 575.0), side < 0.0);
    }
    sheet
}

/// The bar bent to a horseshoe: everything within `half` of its middle line, moved by `shift` to the side.
fn bar(half: f32, end: f32, shift: f32) -> Path {
    let (x, y) = (CENTRE.0 + shift, CENTRE.1 + shift * 0.6);
    let (outer, inner) = (RADIUS + half, RADIUS - half);
    let mut builder = PathBuilder::new();
    builder.move_to(x - outer, end);
    builder.line_to(x - outer, y);
    arc(&mut builder, (x, y), outer, true);
    builder.line_to(x + outer, end);
    builder.line_to(x + inner, end);
    builder.line_to(x + inner, y);
    arc(&mut builder, (x, y), inner, false);
    builder.line_to(x - inner, end);
    builder.close();
    builder.finish().expect("a bar")
}

/// Half a circle above its middle, by two cubic Béziers, from the left or from the right.
fn arc(builder: &mut PathBuilder, (x, y): Place, radius: f32, from_left: bool) {
    let handle = radius * 0.552_284_8;
    let side = if from_left { -1.0 } else { 1.0 };
    builder.cubic_to(x + side * radius, y - handle, x + side * handle, y - radius, x, y - radius);
    builder.cubic_to(x - side * handle, y - radius, x - side * radius, y - handle, x - side * radius, y);
}

fn rectangle(left: f32, top: f32, right: f32, bottom: f32) -> Path {
    polygon(&[(left, top), (right, top), (right, bottom), (left, bottom)], true)
}

/// N or S in white.
fn letter(sheet: &mut Sheet, (x, y): Place, is_north: bool) {
    let at = |dx: f32, dy: f32| (x + dx, y + dy);
    let path = if is_north {
        polygon(&[at(-24.0, 36.0), at(-24.0, -36.0), at(24.0, 36.0), at(24.0, -36.0)], false)
    } else {
        let points = [
            (23.0, -24.0),
            (8.0, -36.0),
            (-12.0, -35.0),
            (-24.0, -20.0),
            (-14.0, -5.0),
            (12.0, 5.0),
            (24.0, 20.0),
            (12.0, 35.0),
            (-8.0, 36.0),
            (-23.0, 24.0),
        ];
        crate::pen::smooth(&points.map(|(dx, dy)| at(dx, dy)), false)
    };
    sheet.stroke(&path, faint(0x000000, 0.25), 17.0);
    sheet.stroke(&path, colour(0xFFFFFF), 13.0);
}
