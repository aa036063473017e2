//! The four portraits of a picture.

use glam::DVec2;
use image::{Rgb, RgbImage, RgbaImage};

use super::super::Colouring;
use super::drawn::{CROSSING, Drawn, crossings};
use crate::Result;
use crate::paint::PaintedPicture;
use crate::picture::render::{Canvas, Painter, mark};
use crate::picture::{FlatMesh, Picture, Pixels};
use crate::run::Solved;

/// Space around what is drawn, pixels.
const MARGIN: u32 = 20;

/// What pictures lie on: about the studio's backdrop.
const PAPER: [u8; 3] = [0xf3, 0xf3, 0xf2];

/// Thickness of the marks of crossings, pixels.
const MARK: f64 = 3.0;

/// Draws them.
///
/// # Errors
/// A canvas that is too large.
pub(super) fn all(painted: &PaintedPicture, solved: &Solved, side: u32, colour: Colouring) -> Result<[RgbImage; 4]> {
    let picture = &*painted.ground.picture;
    let drawn = Drawn::new(picture, &solved.into());
    let height = f64::from(picture.size.y);
    let linear = &solved.linear;
    let classic: Vec<DVec2> = solved.binding.apply(linear).iter().map(|p| DVec2::new(p.x, height - p.y)).collect();
    let coloured = coloured(picture, &painted.flat().importance, colour);

    let states = [&drawn.mesh.rest, classic.as_slice(), drawn.last()];
    let whole = Canvas::around(picture, &drawn.mesh, states, 1.0)?;
    let scale = f64::from(side - 2 * MARGIN) / f64::from(whole.size.max_element());
    let canvas = Canvas::around(picture, &drawn.mesh, states, scale)?;
    let (own, map) = (Painter::new(picture, &drawn.mesh), Painter::new(&coloured, &drawn.mesh));
    let mut faulty = own.render(&classic, &canvas).into_eight();
    redden_overlaps(&mut faulty, &canvas, &drawn.mesh, &classic);
    let mut faulty = Pixels::Eight(faulty);
    mark(&mut faulty, &canvas, &crossings(&solved.complex, linear, height), MARK, CROSSING);
    let pictures = [
        own.render(&drawn.mesh.rest, &canvas),
        map.render(&drawn.mesh.rest, &canvas),
        faulty,
        own.render(drawn.last(), &canvas),
    ];
    Ok(pictures.map(|pixels| on_paper(&pixels.into_eight(), side)))
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
fn coloured(picture: &Picture, importance: &[f32], colour: Colouring) -> Picture {
    let mut image = RgbaImage::new(picture.size.x, picture.size.y);
    for (index, (pixel, &value)) in image.pixels_mut().zip(importance).enumerate() {
        let [r, g, b, alpha] = picture.pixels.wide(index).map(|channel| (channel >> 8) as u8);
        // Luma of Rec. 709.
        let luma = (0.2126 * f32::from(r) + 0.7152 * f32::from(g) + 0.0722 * f32::from(b)) / 255.0;
        let [r, g, b] = colour(value).map(|c| (f32::from(c) * (0.5 + 0.5 * luma)) as u8);
        pixel.0 = [r, g, b, alpha];
    }
    Picture { pixels: Pixels::Eight(image), profile: None, ..picture.clone() }
}

/// In the middle of a square of paper.
fn on_paper(drawn: &RgbaImage, side: u32) -> RgbImage {
    let mut paper = RgbImage::from_pixel(side, side, Rgb(PAPER));
    let (left, top) = ((side.saturating_sub(drawn.width())) / 2, (side.saturating_sub(drawn.height())) / 2);
    for (x, y, pixel) in drawn.enumerate_pixels() {
        let (x, y) = (x + left, y + top);
        if x < side && y < side {
            let alpha = f32::from(pixel.0[3]) / 255.0;
            let below = paper.get_pixel_mut(x, y);
            for (under, over) in below.0.iter_mut().zip(pixel.0) {
                *under = (f32::from(over) * alpha + f32::from(*under) * (1.0 - alpha)).round() as u8;
            }
        }
    }
    paper
}
