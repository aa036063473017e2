//! A palette for all frames and the nearest of its colours for each pixel.

use std::collections::{BTreeMap, HashMap};

use image::RgbaImage;

/// Index of the transparent entry.
pub(super) const TRANSPARENT: u8 = 255;

/// Most colours beside the transparent one.
const COLOURS: usize = 255;

/// Rounds in which each colour moves to the mean of what it stands for (Lloyd 1982): more change nothing that is seen.
const ROUNDS: usize = 6;

/// Colours that look alike are told apart by their distance with green counting most and blue least (Rec. 601's order).
const WEIGHTS: [f32; 3] = [2.0, 4.0, 1.5];

/// Steps of the pattern that mixes two colours (Bayer 1973).
const BAYER: [[f32; 4]; 4] =
    [[0.0, 8.0, 2.0, 10.0], [12.0, 4.0, 14.0, 6.0], [3.0, 11.0, 1.0, 9.0], [15.0, 7.0, 13.0, 5.0]];

/// Up to 255 colours that stand for those of pictures.
#[derive(Debug)]
pub struct Palette {
    colours: Vec<[f32; 3]>,
    /// For each colour met: its nearest entry, the entry on its other side, and how much of that is in it, 0..=1/2.
    known: HashMap<[u8; 3], (u8, u8, f32)>,
}

impl Palette {
    /// The samples' colours if they are at most `count` (at most 255), else a good choice for them: median cut by
    /// variance, refined. Pixels less than half opaque count for nothing.
    pub fn of(samples: &[&RgbaImage], count: usize) -> Self {
        let count = count.min(COLOURS);
        let mut counts: BTreeMap<[u8; 3], f32> = BTreeMap::new();
        for pixel in samples.iter().flat_map(|image| image.pixels()).filter(|p| p.0[3] >= 128) {
            *counts.entry([pixel.0[0], pixel.0[1], pixel.0[2]]).or_default() += 1.0;
        }
        let mut colours: Vec<([f32; 3], f32)> = counts.into_iter().map(|(c, n)| (c.map(f32::from), n)).collect();
        if colours.len() > count {
            colours = coarse(&colours);
        }
        let colours = if colours.len() <= count {
            colours.into_iter().map(|(colour, _)| colour).collect()
        } else {
            refine(&colours, median_cut(&colours, count))
        };
        Self { colours, known: HashMap::new() }
    }

    /// Red, green and blue of 256 entries, those beyond the colours black.
    pub fn rgb(&self) -> Vec<u8> {
        let mut table: Vec<u8> = self.colours.iter().flatten().map(|c| c.round() as u8).collect();
        table.resize(256 * 3, 0);
        table
    }

    /// The entry nearest to a colour.
    pub fn nearest(&self, rgb: [u8; 3]) -> u8 {
        nearest(&self.colours, rgb.map(f32::from)) as u8
    }

    /// `[height × width]` entries for a rectangle (left, top, width, height) of a frame.
    ///
    /// A colour between two entries is mixed of them in a pattern that stands still, so that nothing swarms.
    pub(super) fn indices(&mut self, frame: &RgbaImage, (left, top, width, height): (u32, u32, u32, u32)) -> Vec<u8> {
        let mut indices = Vec::with_capacity((width * height) as usize);
        for (x, y) in (top..top + height).flat_map(|y| (left..left + width).map(move |x| (x, y))) {
            let [r, g, b, alpha] = frame.get_pixel(x, y).0;
            if alpha < 128 || self.colours.is_empty() {
                indices.push(TRANSPARENT);
                continue;
            }
            let (nearest, other, share) = match self.known.get(&[r, g, b]) {
                Some(known) => *known,
                None => {
                    let found = self.between([r, g, b].map(f32::from));
                    self.known.insert([r, g, b], found);
                    found
                }
            };
            let threshold = (BAYER[(y % 4) as usize][(x % 4) as usize] + 0.5) / 16.0;
            indices.push(if share > threshold { other } else { nearest });
        }
        indices
    }

    /// The nearest entry, the one nearest to the colour mirrored at that, and where the colour lies between them.
    fn between(&self, colour: [f32; 3]) -> (u8, u8, f32) {
        let nearest = nearest(&self.colours, colour);
        let entry = self.colours[nearest];
        let mirrored = std::array::from_fn(|c| 2.0 * colour[c] - entry[c]);
        let other = self::nearest(&self.colours, mirrored);
        let step: [f32; 3] = std::array::from_fn(|c| self.colours[other][c] - entry[c]);
        let weigh = |c: usize| WEIGHTS[c] * step[c];
        let along: f32 = (0..3).map(|c| weigh(c) * (colour[c] - entry[c])).sum();
        let length: f32 = (0..3).map(|c| weigh(c) * step[c]).sum();
        let share = if length > 0.0 { (along / length).clamp(0.0, 0.5) } else { 0.0 };
        (nearest as u8, other as u8, share)
    }
}

fn distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    (0..3).map(|c| WEIGHTS[c] * (a[c] - b[c]).powi(2)).sum()
}

/// The first of the nearest.
fn nearest(colours: &[[f32; 3]], colour: [f32; 3]) -> usize {
    let mut best = (0, f32::INFINITY);
    for (index, entry) in colours.iter().enumerate() {
        let distance = distance(*entry, colour);
        if distance < best.1 {
            best = (index, distance);
        }
    }
    best.0
}

/// Means of the colours that share the upper five bits of each channel: at most 32768, however many a photograph has.
fn coarse(colours: &[([f32; 3], f32)]) -> Vec<([f32; 3], f32)> {
    if colours.len() <= 4096 {
        return colours.to_vec();
    }
    let mut cells: BTreeMap<[u8; 3], Vec<([f32; 3], f32)>> = BTreeMap::new();
    for &(colour, count) in colours {
        cells.entry(colour.map(|c| c as u8 >> 3)).or_default().push((colour, count));
    }
    cells.values().map(|members| mean(members)).collect()
}

/// Mean colour and total count.
fn mean(members: &[([f32; 3], f32)]) -> ([f32; 3], f32) {
    let total: f32 = members.iter().map(|m| m.1).sum();
    (std::array::from_fn(|c| members.iter().map(|m| m.0[c] * m.1).sum::<f32>() / total), total)
}

/// Boxes of colours, cut again and again where most is lost (Heckbert 1982, by variance): their means.
fn median_cut(colours: &[([f32; 3], f32)], count: usize) -> Vec<[f32; 3]> {
    let loss = |members: &[([f32; 3], f32)]| -> [f32; 3] {
        let (centre, _) = mean(members);
        std::array::from_fn(|c| members.iter().map(|m| WEIGHTS[c] * m.1 * (m.0[c] - centre[c]).powi(2)).sum())
    };
    let mut boxes = vec![(loss(colours), colours.to_vec())];
    while boxes.len() < count {
        let total = |loss: [f32; 3]| loss.iter().sum::<f32>();
        let Some(worst) = (0..boxes.len()).max_by(|&a, &b| total(boxes[a].0).total_cmp(&total(boxes[b].0))) else {
            break;
        };
        if boxes[worst].1.len() < 2 {
            break;
        }
        let (lost, mut members) = boxes.swap_remove(worst);
        let axis = (0..3).max_by(|&a, &b| lost[a].total_cmp(&lost[b])).unwrap_or(0);
        let (centre, _) = mean(&members);
        members.sort_by(|a, b| a.0[axis].total_cmp(&b.0[axis]));
        let cut = members.partition_point(|m| m.0[axis] < centre[axis]).clamp(1, members.len() - 1);
        let upper = members.split_off(cut);
        boxes.extend([members, upper].map(|part| (loss(&part), part)));
    }
    boxes.iter().map(|(_, members)| mean(members).0).collect()
}

/// Moves each entry to the mean of the colours nearest to it.
fn refine(colours: &[([f32; 3], f32)], mut entries: Vec<[f32; 3]>) -> Vec<[f32; 3]> {
    for _ in 0..ROUNDS {
        let mut members = vec![Vec::new(); entries.len()];
        for &colour in colours {
            members[nearest(&entries, colour.0)].push(colour);
        }
        for (entry, members) in entries.iter_mut().zip(&members).filter(|(_, members)| !members.is_empty()) {
            *entry = mean(members).0;
        }
    }
    entries
}
