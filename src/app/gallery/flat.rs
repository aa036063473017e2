//! The four pictures of a picture.

use std::sync::Arc;
use std::time::Instant;

use glam::DVec2;
use image::{Rgb, RgbImage, RgbaImage};

use super::exhibit::{Found, SIDE};
use crate::app::flat::{CROSSING, Drawn, crossings};
use crate::app::{load, progress, scene_options};
use crate::export::report::Report;
use crate::gallery::{self, Entry, picture::PictureScene};
use crate::picture::render::{Canvas, Painter, mark};
use crate::picture::{FlatMesh, Picture, Pixels};
use crate::run::{self, Domain};
use crate::scene::{Scene, Source};
use crate::view::{Legend, Looks, Mode};
use crate::{Error, Result};

/// Space around what is drawn, pixels.
const MARGIN: u32 = 20;

/// What pictures lie on: about the studio's backdrop.
const PAPER: [u8; 3] = [0xf3, 0xf3, 0xf2];

/// Thickness of the marks of crossings, pixels.
const MARK: f64 = 3.0;

/// Warps a scene and draws its pictures.
///
/// # Errors
/// What the engine refuses.
pub(super) fn exhibit(entry: &Entry) -> Result<Found> {
    let scene = Scene::new(scene_options::fresh(&Source::Gallery(entry.name.into())))?;
    let PictureScene { picture, field, .. } = gallery::picture::open(entry.name)?;
    let settings = load::settings_of(&scene);
    let flat = load::flat(scene.source.to_string(), &picture, &field);
    let start = Instant::now();
    let domain = Domain::picture(Arc::new(flat), settings.clone());
    let solved = run::solve(domain, &progress::watcher(true))?;
    let seconds = start.elapsed().as_secs_f64();

    let drawn = Drawn::new(&picture, &solved.boundary, &solved.outcome.frames);
    let height = f64::from(picture.size.y);
    let mut report = Report::of(&scene, &settings, field.clamped, &solved.outcome, Vec::new());
    report.take_areas(drawn.areas(&field, solved.complex.grid.cell_size));

    let linear = &solved.linear;
    let classic: Vec<DVec2> = solved.binding.apply(linear).iter().map(|p| DVec2::new(p.x, height - p.y)).collect();
    let inside = field.values.iter().zip(&picture.domain).filter(|(_, inside)| **inside).map(|(f, _)| *f);
    let looks = Looks { mode: Mode::Importance, importance: Some(Arc::new(inside.collect())), ..Looks::default() };
    let legend = looks.legend().ok_or_else(|| Error::Fault("importance has no legend".into()))?;
    let coloured = coloured(&picture, &field.values, &legend);

    let states = [&drawn.mesh.rest, classic.as_slice(), drawn.last()];
    let whole = Canvas::around(&picture, &drawn.mesh, states, 1.0)?;
    let scale = f64::from(SIDE - 2 * MARGIN) / f64::from(whole.size.max_element());
    let canvas = Canvas::around(&picture, &drawn.mesh, states, scale)?;
    let (own, map) = (Painter::new(&picture, &drawn.mesh), Painter::new(&coloured, &drawn.mesh));
    let mut faulty = own.render(&classic, &canvas).into_eight();
    redden_overlaps(&mut faulty, &canvas, &drawn.mesh, &classic);
    let mut faulty = Pixels::Eight(faulty);
    mark(&mut faulty, &canvas, &crossings(&solved.complex, linear, height), MARK, CROSSING);
    let pictures = [
        own.render(&drawn.mesh.rest, &canvas),
        map.render(&drawn.mesh.rest, &canvas),
        faulty,
        own.render(drawn.last(), &canvas),
    ]
    .map(|pixels| on_paper(&pixels.into_eight()));
    Ok(Found { pictures, legend: Some(legend), report, seconds })
}

/// Reddens what more than one triangle covers: crossings of outlines alone are too small to be seen.
fn redden_overlaps(picture: &mut RgbaImage, canvas: &Canvas, mesh: &FlatMesh, places: &[DVec2]) {
    let (width, height) = picture.dimensions();
    let mut covered = vec![0_u8; (width * height) as usize];
    for corners in &mesh.triangles {
        let [a, b, c] = corners.map(|v| canvas.from_plane(places[v as usize]));
        let low = a.min(b).min(c).max(DVec2::ZERO).as_uvec2();
        let high = a.max(b).max(c).max(DVec2::ZERO).ceil().as_uvec2();
        for (x, y) in (low.y..high.y.min(height)).flat_map(|y| (low.x..high.x.min(width)).map(move |x| (x, y))) {
            let p = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
            let sides = [(a, b), (b, c), (c, a)].map(|(from, to)| (to - from).perp_dot(p - from));
            // Those on an edge belong to neither side of it, so that neighbours never count twice.
            if sides.iter().all(|side| *side > 0.0) || sides.iter().all(|side| *side < 0.0) {
                let count = &mut covered[(y * width + x) as usize];
                *count = count.saturating_add(1);
            }
        }
    }
    for (pixel, count) in picture.pixels_mut().zip(covered) {
        if count > 1 && pixel.0[3] > 0 {
            let [r, g, b, _] = CROSSING.0;
            for (channel, red) in pixel.0.iter_mut().zip([r, g, b]) {
                *channel = ((u16::from(*channel) + 3 * u16::from(red)) / 4) as u8;
            }
        }
    }
}

/// The picture in the colours of its importance; its drawing shows through, so that it is still known.
fn coloured(picture: &Picture, importance: &[f32], legend: &Legend) -> Picture {
    let mut image = RgbaImage::new(picture.size.x, picture.size.y);
    for (index, (pixel, &value)) in image.pixels_mut().zip(importance).enumerate() {
        let [r, g, b, alpha] = picture.pixels.wide(index).map(|channel| (channel >> 8) as u8);
        // Luma of Rec. 709.
        let luma = (0.2126 * f32::from(r) + 0.7152 * f32::from(g) + 0.0722 * f32::from(b)) / 255.0;
        let [r, g, b] = colour(legend, value).map(|c| (f32::from(c) * (0.5 + 0.5 * luma)) as u8);
        pixel.0 = [r, g, b, alpha];
    }
    Picture { pixels: Pixels::Eight(image), profile: None, ..picture.clone() }
}

/// The colour that a legend gives a value; its stops are evenly spaced in the logarithm.
fn colour(legend: &Legend, value: f32) -> [u8; 3] {
    let at = legend.stops.partition_point(|(stop, _)| *stop < value);
    legend.stops.get(at).or(legend.stops.last()).map_or([0; 3], |(_, colour)| *colour)
}

/// In the middle of a square of paper.
fn on_paper(drawn: &RgbaImage) -> RgbImage {
    let mut paper = RgbImage::from_pixel(SIDE, SIDE, Rgb(PAPER));
    let (left, top) = ((SIDE.saturating_sub(drawn.width())) / 2, (SIDE.saturating_sub(drawn.height())) / 2);
    for (x, y, pixel) in drawn.enumerate_pixels() {
        let (x, y) = (x + left, y + top);
        if x < SIDE && y < SIDE {
            let alpha = f32::from(pixel.0[3]) / 255.0;
            let below = paper.get_pixel_mut(x, y);
            for (under, over) in below.0.iter_mut().zip(pixel.0) {
                *under = (f32::from(over) * alpha + f32::from(*under) * (1.0 - alpha)).round() as u8;
            }
        }
    }
    paper
}
