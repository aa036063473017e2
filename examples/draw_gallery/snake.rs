//! A coiled snake from above, with what it has swallowed.

use std::f32::consts::TAU;

use tiny_skia::{Mask, Path};

use crate::pen::{Place, Sheet, circle, colour, faint, mix, polygon, smooth};

const WIDTH: u32 = 880;
const HEIGHT: u32 = 1000;
const INK: u32 = 0x2A2416;

/// Points along the body.
const STEPS: usize = 720;

/// How far around the coil goes, in turns, from the tail inside to the neck outside.
const TURNS: f32 = 2.35;

/// About the body's length in pixels.
const LENGTH: f32 = 3600.0;

/// Where the prey is, along the body.
const PREY: f32 = 0.575;

/// The middle line of the coil at `s` in 0..=1 from tail to neck; the neck leaves the coil in a straight line.
fn middle(s: f32) -> Place {
    let angle = TAU * TURNS * s + 2.2;
    let radius = 92.0 + 300.0 * s.powf(0.92);
    (456.0 + radius * angle.cos() * 1.04, 604.0 + radius * angle.sin() * 0.98)
}

/// Half the body's width.
fn half(s: f32) -> f32 {
    let tail = (s / 0.30).min(1.0);
    let neck = ((1.0 - s) / 0.10).min(1.0);
    let body = 42.0 * (1.0 - (1.0 - tail).powi(2)) * (0.66 + 0.34 * neck);
    let from_prey = (s - PREY) / 0.032;
    body.max(1.0) + 22.0 * (-from_prey * from_prey).exp()
}

/// The place at `s` along and `v` in −1..=1 across the body (1 is outside).
fn place(s: f32, v: f32) -> Place {
    let (a, b) = (middle((s - 1e-3).max(0.0)), middle(s + 1e-3));
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let length = dx.hypot(dy);
    let (x, y) = middle(s);
    (x + dy / length * half(s) * v, y - dx / length * half(s) * v)
}

/// The part of the body between `from` and `to` across, between `low` and `high` along.
fn ribbon(low: f32, high: f32, from: f32, to: f32) -> Path {
    let steps = ((high - low) * STEPS as f32).ceil() as usize + 2;
    let along = |k: usize| low + (high - low) * k as f32 / (steps - 1) as f32;
    let mut points: Vec<Place> = (0..steps).map(|k| place(along(k), from)).collect();
    points.extend((0..steps).rev().map(|k| place(along(k), to)));
    polygon(&points, true)
}

/// The picture.
pub fn draw() -> Sheet {
    let mut sheet = Sheet::new(WIDTH, HEIGHT);
    tongue(&mut sheet);
    let body = ribbon(0.0, 1.0, -1.0, 1.0);
    sheet.stroke(&body, colour(INK), 9.0);
    // Rounded: lighter from the edges to a line outside of the middle, seen from above.
    for step in 0..32 {
        let t = step as f32 / 31.0;
        let tone = if t < 0.5 { mix(0x7A5A1E, 0xC79A3A, t * 2.0) } else { mix(0xC79A3A, 0xE9CC79, (t - 0.5) * 2.0) };
        sheet.fill(&ribbon(0.0, 1.0, -1.0 + 1.15 * t, 1.0 - 0.75 * t), tone);
    }
    let mask = sheet.mask(&body);
    pattern(&mut sheet, &mask);
    scales(&mut sheet, &mask);
    // Darker towards both edges.
    for edge in [-1.0, 1.0] {
        let points: Vec<Place> = (0..=STEPS).map(|k| place(k as f32 / STEPS as f32, edge)).collect();
        for width in 1..=12 {
            sheet.stroke_within(&polygon(&points, false), faint(0x2E1F08, 0.045), 4.0 * width as f32, Some(&mask));
        }
    }
    head(&mut sheet);
    sheet
}

/// Dark saddles with light rims along the back, smaller spots on the sides.
fn pattern(sheet: &mut Sheet, mask: &Mask) {
    let mut s = 0.02;
    while s < 0.975 {
        let (long, wide) = (half(s) * 0.92 / LENGTH + 0.0005, 0.60);
        let diamond = |grow: f32| {
            let corner = |k: usize| {
                let angle = TAU * k as f32 / 16.0;
                let (c, d) = (angle.cos(), angle.sin());
                // Between a circle and a diamond.
                let r = 1.0 / (c.abs().powf(1.5) + d.abs().powf(1.5)).powf(1.0 / 1.5);
                place(s + long * grow * r * c, 0.12 + wide * grow * r * d)
            };
            smooth(&(0..16).map(corner).collect::<Vec<_>>(), true)
        };
        let fill =
            |path: &Path, tone, sheet: &mut Sheet| sheet.shade(path, tiny_skia::Shader::SolidColor(tone), Some(mask));
        fill(&diamond(1.14), faint(0xF4E3A8, 0.9), sheet);
        fill(&diamond(1.0), colour(0x4E3416), sheet);
        fill(&diamond(0.66), colour(0x8A5A22), sheet);
        let next = s + long * 2.7;
        let between = (s + next) / 2.0;
        for v in [-0.66, 0.88] {
            let (x, y) = place(between, v);
            fill(&circle((x, y), half(between) * 0.13), faint(0x4E3416, 0.8), sheet);
        }
        s = next;
    }
}

/// A fine net of crossing lines: whether the picture stays smooth is seen on it.
fn scales(sheet: &mut Sheet, mask: &Mask) {
    for direction in [-1.0_f32, 1.0] {
        let mut start = -0.04;
        while start < 1.0 {
            let points: Vec<Place> = (0..=12)
                .map(|k| {
                    let v = -1.0 + k as f32 / 6.0;
                    place((start + 0.016 * (1.0 + direction * v)).clamp(0.002, 0.998), v)
                })
                .collect();
            sheet.stroke_within(&polygon(&points, false), faint(0x3B2A0E, 0.22), 1.3, Some(mask));
            start += 0.0088;
        }
    }
}

/// The frame of the head: forwards and to the side, from the neck.
fn head_at(forwards: f32, aside: f32) -> Place {
    let (a, b) = (middle(0.992), middle(1.0));
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let length = dx.hypot(dy);
    // Turned outwards, away from the coil.
    let (sin, cos) = (-0.42_f32).sin_cos();
    let (fx, fy) = ((dx * cos - dy * sin) / length, (dx * sin + dy * cos) / length);
    (b.0 + fx * forwards + fy * aside, b.1 + fy * forwards - fx * aside)
}

fn head(sheet: &mut Sheet) {
    let right: [Place; 8] = [
        (-16.0, 26.0),
        (10.0, 38.0),
        (38.0, 50.0),
        (66.0, 50.0),
        (94.0, 38.0),
        (120.0, 26.0),
        (138.0, 14.0),
        (144.0, 0.0),
    ];
    let outline: Vec<Place> = right
        .iter()
        .map(|&(f, a)| head_at(f, a))
        .chain(right.iter().rev().skip(1).map(|&(f, a)| head_at(f, -a)))
        .collect();
    let path = smooth(&outline, true);
    sheet.stroke(&path, colour(INK), 9.0);
    let steps = 22;
    for step in 0..steps {
        let t = step as f32 / (steps - 1) as f32;
        let scaled: Vec<Place> =
            right.iter().map(|&(f, a)| (52.0 + (f - 52.0) * (1.0 - 0.8 * t), a * (1.0 - 0.85 * t))).collect();
        let ring: Vec<Place> = scaled
            .iter()
            .map(|&(f, a)| head_at(f, a))
            .chain(scaled.iter().rev().skip(1).map(|&(f, a)| head_at(f, -a)))
            .collect();
        let tone = if t < 0.5 { mix(0x7A5A1E, 0xC79A3A, t * 2.0) } else { mix(0xC79A3A, 0xE9CC79, (t - 0.5) * 2.0) };
        sheet.fill(&smooth(&ring, true), tone);
    }
    for side in [-1.0_f32, 1.0] {
        let band: Vec<Place> = [(-10.0, 30.0), (30.0, 44.0), (66.0, 42.0), (88.0, 32.0), (64.0, 30.0), (26.0, 28.0)]
            .iter()
            .map(|&(f, a)| head_at(f, a * side))
            .collect();
        sheet.fill(&smooth(&band, true), faint(0x4E3416, 0.92));
        let eye = head_at(80.0, 30.0 * side);
        sheet.fill(&circle(eye, 13.0), colour(INK));
        sheet.fill(&circle(eye, 10.5), colour(0xE9B52B));
        let pupil: Vec<Place> = [(70.5, 30.0), (80.0, 33.2), (89.5, 30.0), (80.0, 26.8)]
            .iter()
            .map(|&(f, a)| head_at(f, a * side))
            .collect();
        sheet.fill(&smooth(&pupil, true), colour(0x120E08));
        sheet.fill(&circle(head_at(84.0, 33.5 * side), 2.8), colour(0xFFFFFF));
        sheet.fill(&circle(head_at(126.0, 9.0 * side), 2.8), colour(INK));
    }
    let mark: Vec<Place> = [(-6.0, 0.0), (22.0, 12.0), (52.0, 9.0), (70.0, 0.0), (52.0, -9.0), (22.0, -12.0)]
        .iter()
        .map(|&(f, a)| head_at(f, a))
        .collect();
    sheet.fill(&smooth(&mark, true), colour(0x4E3416));
}

fn tongue(sheet: &mut Sheet) {
    let line = |points: &[Place]| smooth(&points.iter().map(|&(f, a)| head_at(f, a)).collect::<Vec<_>>(), false);
    for (ink, width) in [(0x5B1220, 9.0), (0xC22A3E, 5.5)] {
        sheet.stroke(&line(&[(130.0, 0.0), (160.0, 3.0), (184.0, -2.0)]), colour(ink), width);
        for side in [-1.0, 1.0] {
            sheet.stroke(&line(&[(182.0, -2.0), (200.0, -2.0 + 7.0 * side), (216.0, 14.0 * side)]), colour(ink), width);
        }
    }
}
