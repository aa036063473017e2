//! Africa, equal-area, each country in one of a few quiet colours.

use std::collections::BTreeSet;

use tiny_skia::{Color, Mask, Path, PathBuilder};

use crate::africa::{ARCS, COUNTRIES};
use crate::pen::{Place, Sheet, colour, faint, mix, smooth_into};

const WIDTH: u32 = 960;
const HEIGHT: u32 = 1024;

/// Pixels for one radius of the Earth.
const SCALE: f64 = 800.0;

/// Longitude and latitude in degrees of the map's middle.
const MIDDLE: (f64, f64) = (17.0, 1.8);

const PALETTE: [u32; 6] = [0xE6B565, 0xD98B5F, 0x9DB57E, 0x7FA9B8, 0xC7A0B5, 0xEAD9A6];
const NO_FIGURE: u32 = 0xC9C6BE;
const INK: u32 = 0x3E3A39;

/// Countries for which the statistic has no figure: they belong to no region.
const WITHOUT: [&str; 2] = ["Eritrea", "Western Sahara"];

/// The picture and the picture of regions: value = place in the list of countries, from 1.
pub fn draw() -> (Sheet, Sheet) {
    let mut sheet = Sheet::new(WIDTH, HEIGHT);
    let mut ids = Sheet::new(WIDTH, HEIGHT);
    let paths: Vec<Path> = COUNTRIES.iter().map(|(_, rings)| country(rings)).collect();
    let fills = colours();

    // Under the seams between smoothed outlines, and along the coast.
    for path in &paths {
        sheet.stroke(path, colour(INK), 5.0);
    }
    for (path, &fill) in paths.iter().zip(&fills) {
        sheet.fill(path, colour(fill));
    }
    let mut land = Mask::new(WIDTH, HEIGHT).expect("a size > 0");
    for path in &paths {
        land.fill_path(path, tiny_skia::FillRule::Winding, true, tiny_skia::Transform::identity());
    }
    graticule(&mut sheet, &land);
    for (path, &fill) in paths.iter().zip(&fills) {
        let mask = sheet.mask(path);
        for (width, opacity) in [(22.0, 0.10), (14.0, 0.14), (7.0, 0.20)] {
            let mut shade = mix(fill, 0x6B3F2A, 0.55);
            shade.set_alpha(opacity);
            sheet.stroke_within(path, shade, width, Some(&mask));
        }
    }
    for arc in 0..ARCS.len() {
        let users = COUNTRIES.iter().filter(|(_, rings)| uses(rings, arc)).count();
        let is_within = COUNTRIES
            .iter()
            .any(|(_, rings)| rings.iter().flat_map(|r| r.iter()).filter(|a| index(**a) == arc).count() > 1);
        if is_within {
            continue;
        }
        let mut builder = PathBuilder::new();
        smooth_into(&mut builder, &projected(arc, false), false);
        let path = builder.finish().expect("a line");
        if users > 1 {
            sheet.stroke(&path, faint(0xFFFBF0, 0.55), 3.4);
            sheet.stroke(&path, colour(0x6A5A50), 1.5);
        } else {
            sheet.stroke(&path, colour(INK), 2.6);
        }
    }

    // Strokes first: what of the coast's line lies in the sea belongs to the country behind it.
    for pass in [6.0, 0.0] {
        for (index, path) in paths.iter().enumerate() {
            let is_counted = !WITHOUT.contains(&COUNTRIES[index].0);
            ids.label(path, if is_counted { index as u8 + 1 } else { 0 }, pass);
        }
    }
    (sheet, ids)
}

/// Lines every ten degrees: whether straight lines stay smooth is seen on them.
fn graticule(sheet: &mut Sheet, land: &Mask) {
    let line = |points: Vec<Place>| {
        let mut builder = PathBuilder::new();
        smooth_into(&mut builder, &points, false);
        builder.finish().expect("a line")
    };
    let ink: Color = faint(0xFFFFFF, 0.5);
    for step in -4..=6 {
        let degrees = f64::from(step * 10);
        let meridian = line((-40..=40).map(|lat| project(degrees, f64::from(lat))).collect());
        sheet.stroke_within(&meridian, ink, 1.6, Some(land));
        let parallel = line((-30..=60).map(|lon| project(f64::from(lon), degrees)).collect());
        sheet.stroke_within(&parallel, ink, if step == 0 { 3.0 } else { 1.6 }, Some(land));
    }
}

/// `[countries]` such that neighbours differ.
fn colours() -> Vec<u32> {
    let arcs: Vec<BTreeSet<usize>> =
        COUNTRIES.iter().map(|(_, rings)| rings.iter().flat_map(|r| r.iter()).map(|a| index(*a)).collect()).collect();
    let mut taken: Vec<Option<usize>> = vec![None; COUNTRIES.len()];
    for country in 0..COUNTRIES.len() {
        let neighbours: Vec<usize> =
            (0..COUNTRIES.len()).filter(|&o| o != country && !arcs[o].is_disjoint(&arcs[country])).collect();
        let used = |k: usize| neighbours.iter().filter(|&&o| taken[o] == Some(k)).count();
        // Starts elsewhere for each country, so that the colours are evenly spread.
        taken[country] = (0..PALETTE.len()).map(|k| (k + country * 5) % PALETTE.len()).min_by_key(|&k| used(k));
    }
    let fill = |(index, taken): (usize, &Option<usize>)| {
        if WITHOUT.contains(&COUNTRIES[index].0) { NO_FIGURE } else { PALETTE[taken.unwrap_or(0)] }
    };
    taken.iter().enumerate().map(fill).collect()
}

fn index(arc: i16) -> usize {
    (if arc < 0 { -1 - arc } else { arc }) as usize
}

fn uses(rings: &[&[i16]], arc: usize) -> bool {
    rings.iter().flat_map(|r| r.iter()).any(|a| index(*a) == arc)
}

/// The outline of a country; a border is the same curve for both of its sides.
fn country(rings: &[&[i16]]) -> Path {
    let mut builder = PathBuilder::new();
    for ring in rings {
        let mut ring_builder = PathBuilder::new();
        for &arc in *ring {
            smooth_into(&mut ring_builder, &projected(index(arc), arc < 0), false);
        }
        ring_builder.close();
        builder.push_path(&ring_builder.finish().expect("a ring"));
    }
    builder.finish().expect("a country")
}

/// An arc on the sheet, backwards if asked.
fn projected(arc: usize, is_backwards: bool) -> Vec<Place> {
    let points = ARCS[arc].iter().map(|&(lon, lat)| project(f64::from(lon) / 10.0, f64::from(lat) / 10.0));
    if is_backwards { points.rev().collect() } else { points.collect() }
}

/// Lambert's azimuthal equal-area projection (Snyder 1987, eq. 24-2 to 24-4).
fn project(lon: f64, lat: f64) -> Place {
    let (middle_lon, middle_lat) = (MIDDLE.0.to_radians(), MIDDLE.1.to_radians());
    let (lon, lat) = (lon.to_radians() - middle_lon, lat.to_radians());
    let k = (2.0 / (1.0 + middle_lat.sin() * lat.sin() + middle_lat.cos() * lat.cos() * lon.cos())).sqrt();
    let x = k * lat.cos() * lon.sin();
    let y = k * (middle_lat.cos() * lat.sin() - middle_lat.sin() * lat.cos() * lon.cos());
    ((f64::from(WIDTH) / 2.0 + SCALE * x) as f32, (f64::from(HEIGHT) / 2.0 - SCALE * y) as f32)
}
