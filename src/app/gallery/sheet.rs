//! All scenes on one picture: the contact sheet, and the strip that the README shows.

use bevy_egui::egui::{Align2, Color32, Context, FontId, LayerId, Painter, Pos2};
use image::imageops::{self, FilterType};
use image::{DynamicImage, RgbImage};

use super::exhibit::{Exhibit, Found, NAMES};
use crate::Result;
use crate::view::headless::Renderer;
use crate::view::{self, Backdrop, Quality, Studio};

const PAPER: [u8; 3] = [255; 3];
const INK: Color32 = Color32::from_rgb(0x24, 0x29, 0x30);
const QUIET: Color32 = Color32::from_rgb(0x68, 0x70, 0x7b);
const GOOD: Color32 = Color32::from_rgb(0x1a, 0x7f, 0x45);
const BAD: Color32 = Color32::from_rgb(0xc2, 0x30, 0x30);

/// A line of text; places and sizes are pixels.
struct Text {
    at: [f32; 2],
    anchor: Align2,
    text: String,
    size: f32,
    ink: Color32,
    /// Widest; text that is longer is shrunk.
    width: f32,
}

/// A sheet: text first, then pictures over it.
struct Sheet {
    size: [u32; 2],
    texts: Vec<Text>,
    pictures: Vec<(i64, i64, RgbImage)>,
}

impl Sheet {
    fn text(&mut self, at: [f32; 2], anchor: Align2, text: impl Into<String>, size: f32, ink: Color32, width: f32) {
        self.texts.push(Text { at, anchor, text: text.into(), size, ink, width });
    }

    /// A picture in a square.
    fn picture(&mut self, x: u32, y: u32, side: u32, picture: &RgbImage) {
        let small = imageops::resize(picture, side, side, FilterType::Lanczos3);
        self.pictures.push((x.into(), y.into(), small));
    }

    /// Letters are the window's, so the window's painter sets them.
    fn print(self) -> Result<RgbImage> {
        let quality = Quality { supersampling: 1, samples: 1, ..Quality::for_adapter(&view::adapter()?) };
        let mut renderer = Renderer::new(self.size, quality)?;
        renderer.world_mut().insert_resource(Studio { backdrop: Backdrop::Plain(PAPER), floor: false });
        let texts = self.texts;
        renderer.overlay(move |context| write(context, &texts));
        let mut sheet = DynamicImage::from(renderer.frame()?).into_rgb8();
        for (x, y, picture) in &self.pictures {
            imageops::replace(&mut sheet, picture, *x, *y);
        }
        Ok(sheet)
    }
}

fn write(context: &Context, texts: &[Text]) {
    let painter: Painter = context.layer_painter(LayerId::background());
    for text in texts {
        let layout = |size: f32| painter.layout_no_wrap(text.text.clone(), FontId::proportional(size), text.ink);
        let natural = layout(text.size);
        let galley =
            if natural.size().x > text.width { layout(text.size * text.width / natural.size().x) } else { natural };
        let place = text.anchor.anchor_size(Pos2::from(text.at), galley.size());
        painter.galley(place.min, galley, text.ink);
    }
}

/// Side of a picture on the contact sheet.
const SMALL: u32 = 240;
const GAP: u32 = 8;
const RIM: u32 = 40;
const HEAD: u32 = 54;
const FOOT: u32 = 56;
const TITLE: u32 = 84;

/// Four pictures of each scene, two scenes side by side.
pub(super) fn contact_sheet(exhibits: &[Exhibit]) -> Result<RgbImage> {
    let columns = if exhibits.len() > 1 { 2 } else { 1 };
    let (wide, high) = (4 * SMALL + 3 * GAP, HEAD + SMALL + FOOT);
    let rows = exhibits.len().div_ceil(columns as usize) as u32;
    let size = [columns * wide + (columns + 1) * RIM, TITLE + rows * high + RIM / 2];
    let mut sheet = Sheet { size, texts: Vec::new(), pictures: Vec::new() };
    let whole = (size[0] - 2 * RIM) as f32;
    sheet.text([RIM as f32, 26.0], Align2::LEFT_TOP, "homunculus: gallery", 32.0, INK, whole);
    let legend = "at rest · importance · Eq. 1 alone, its crossings red · ours";
    sheet.text([RIM as f32 + whole, 36.0], Align2::RIGHT_TOP, legend, 20.0, QUIET, whole * 0.7);
    for (k, exhibit) in exhibits.iter().enumerate() {
        let (column, row) = (k as u32 % columns, k as u32 / columns);
        let (x, y) = (RIM + column * (wide + RIM), TITLE + row * high);
        let (left, right) = (x as f32, (x + wide) as f32);
        sheet.text([left, y as f32], Align2::LEFT_TOP, exhibit.entry.name, 22.0, INK, 0.4 * wide as f32);
        sheet.text([left, y as f32 + 27.0], Align2::LEFT_TOP, exhibit.entry.one_line, 16.0, QUIET, wide as f32);
        let below = (y + HEAD + SMALL) as f32 + 5.0;
        match &exhibit.found {
            Ok(found) => {
                for (n, picture) in found.pictures.iter().enumerate() {
                    let at = x + n as u32 * (SMALL + GAP);
                    sheet.picture(at, y + HEAD, SMALL, picture);
                    let (text, ink) = caption(found, n);
                    let middle = at as f32 + 0.5 * SMALL as f32;
                    sheet.text([middle, below], Align2::CENTER_TOP, text, 16.0, ink, SMALL as f32);
                }
                let good = found.report.certified();
                let verdict = if good { "certified" } else { "not certified" };
                sheet.text(
                    [right, y as f32 + 3.0],
                    Align2::RIGHT_TOP,
                    format!("{verdict} · {}", numbers(found)),
                    16.0,
                    if good { GOOD } else { BAD },
                    0.75 * wide as f32,
                );
            }
            Err(why) => {
                sheet.text([right, y as f32 + 3.0], Align2::RIGHT_TOP, "failed", 16.0, BAD, 0.3 * wide as f32);
                sheet.text([left, (y + HEAD) as f32 + 20.0], Align2::LEFT_TOP, why.clone(), 18.0, BAD, wide as f32);
            }
        }
    }
    sheet.print()
}

fn caption(found: &Found, k: usize) -> (String, Color32) {
    let name = NAMES[k].1;
    match k {
        2 => (format!("{name}: {} crossings", found.classic_crossings()), BAD),
        3 => (format!("{name}: {} crossings", found.faults()), if found.faults() == 0 { GOOD } else { BAD }),
        _ => (name.into(), QUIET),
    }
}

fn numbers(found: &Found) -> String {
    let worst =
        found.worst().map_or_else(String::new, |w| format!("worst region {:.1} % off, ", 100.0 * w.error().abs()));
    let report = &found.report;
    format!(
        "{worst}p95 {:.1} %, {} cells, {:.1} s",
        100.0 * report.fidelity.p95,
        report.settings.resolution,
        found.seconds
    )
}

/// What the strip shows, where it is there: bodies and pictures that tell at a glance.
const STRIP: [&str; 8] = ["homunculus", "hand", "elephant", "airplane", "goalkeeper", "comic", "crocodile", "snake"];

/// Side of a picture on the strip: eight are twice as wide as a page on the web.
const STRIP_SIDE: u32 = 208;

/// A few scenes side by side, Eq. 1 alone above, the certified growth below; nothing without any of them.
pub(super) fn strip(exhibits: &[Exhibit]) -> Result<Option<RgbImage>> {
    let found = |name: &str| exhibits.iter().find(|e| e.entry.name == name)?.found.as_ref().ok();
    let shown: Vec<&Found> = STRIP.into_iter().filter_map(found).collect();
    if shown.is_empty() {
        return Ok(None);
    }
    let (left, head, foot) = (GAP, 34, 34);
    let across = shown.len() as u32 * (STRIP_SIDE + GAP);
    let size = [left + across, head + 2 * STRIP_SIDE + GAP + foot];
    let mut sheet = Sheet { size, texts: Vec::new(), pictures: Vec::new() };
    for (k, found) in shown.iter().enumerate() {
        let x = left + k as u32 * (STRIP_SIDE + GAP);
        let middle = x as f32 + 0.5 * STRIP_SIDE as f32;
        sheet.picture(x, head, STRIP_SIDE, &found.pictures[2]);
        sheet.picture(x, head + STRIP_SIDE + GAP, STRIP_SIDE, &found.pictures[3]);
        let count = format!("{} crossings", found.classic_crossings());
        sheet.text([middle, 5.0], Align2::CENTER_TOP, count, 20.0, BAD, STRIP_SIDE as f32);
        let count = format!("{} crossings", found.faults());
        let ink = if found.faults() == 0 { GOOD } else { BAD };
        sheet.text(
            [middle, (head + 2 * STRIP_SIDE + GAP) as f32 + 5.0],
            Align2::CENTER_TOP,
            count,
            20.0,
            ink,
            STRIP_SIDE as f32,
        );
    }
    sheet.print().map(Some)
}

/// Side of a thumbnail in the window.
const THUMBNAIL: u32 = 176;

/// What the window shows of a scene.
pub(super) fn thumbnail(found: &Found) -> RgbImage {
    imageops::resize(&found.pictures[3], THUMBNAIL, THUMBNAIL, FilterType::Lanczos3)
}
