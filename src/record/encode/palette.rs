//! 255 colours for a whole film, and which of them each pixel gets.
//!
//! One palette for all frames and a dither that stays where it is: what does not move does not change, so nothing flickers,
//! and unchanged pixels need not be written again.

use color_quant::NeuQuant;
use image::{Rgba, RgbaImage};
use rayon::prelude::*;

/// Colours; one more index is kept for "nothing here".
const COLOURS: usize = 255;

/// The index that shows nothing.
pub(super) const CLEAR: u8 = 255;

/// One in so many pixels teaches the palette. More teach it little; fewer lose small things such as a title's letters.
const TEACHING: i32 = 3;

/// Pixels the palette is taught by, at most: more take minutes.
const LESSONS: usize = 400_000;

/// Bits per channel of the table of nearest colours: finer than colours of a palette are apart.
const BITS: u32 = 6;

/// Bayer's matrix of 8 by 8: each threshold once, neighbours far apart.
const BAYER: [[u8; 8]; 8] = [
    [0, 32, 8, 40, 2, 34, 10, 42],
    [48, 16, 56, 24, 50, 18, 58, 26],
    [12, 44, 4, 36, 14, 46, 6, 38],
    [60, 28, 52, 20, 62, 30, 54, 22],
    [3, 35, 11, 43, 1, 33, 9, 41],
    [51, 19, 59, 27, 49, 17, 57, 25],
    [15, 47, 7, 39, 13, 45, 5, 37],
    [63, 31, 55, 23, 61, 29, 53, 21],
];

/// Colours and the table that finds them.
pub(super) struct Palette {
    colours: Vec<[u8; 3]>,
    /// `[2^(3 BITS)]` nearest colour.
    nearest: Vec<u8>,
    /// How far the dither moves a channel up or down, in levels.
    spread: i32,
}

impl Palette {
    /// The palette of a film, by some of its frames. Deterministic (NeuQuant, Dekker 1994).
    pub fn of(samples: &[RgbaImage]) -> Self {
        let opaque = |image: &'_ RgbaImage| image.pixels().filter(|p| p.0[3] >= OPAQUE).count();
        let step = samples.iter().map(opaque).sum::<usize>().div_ceil(LESSONS).max(1);
        let pixels = samples.iter().flat_map(|image| image.pixels()).filter(|p| p.0[3] >= OPAQUE).step_by(step);
        let lessons: Vec<u8> = pixels.flat_map(|&Rgba([r, g, b, _])| [r, g, b, 255]).collect();
        // With fewer it would divide by zero; a blank film is a fault that others find.
        let lessons = if lessons.len() < 4 * COLOURS { [0, 0, 0, 255].repeat(COLOURS) } else { lessons };
        let quantizer = NeuQuant::new(TEACHING, COLOURS, &lessons);
        let colours: Vec<[u8; 3]> =
            quantizer.color_map_rgba().chunks_exact(4).map(|c| [c[0], c[1], c[2]]).take(COLOURS).collect();
        let nearest = (0..1u32 << (3 * BITS)).into_par_iter().map(|key| nearest(&colours, colour_of(key))).collect();
        let spread = spread(&colours);
        Self { colours, nearest, spread }
    }

    /// `[3 × 256]` RGB; the last is [`CLEAR`].
    pub fn bytes(&self) -> Vec<u8> {
        let mut bytes: Vec<u8> = self.colours.iter().flatten().copied().collect();
        bytes.resize(3 * 256, 0);
        bytes
    }

    /// `[pixels]` index of each.
    pub fn indices(&self, frame: &RgbaImage) -> Vec<u8> {
        let width = frame.width() as usize;
        let mut indices = vec![CLEAR; width * frame.height() as usize];
        indices.par_chunks_exact_mut(width).zip(frame.as_raw().par_chunks_exact(4 * width)).enumerate().for_each(
            |(y, (indices, rgba))| {
                for (x, (index, rgba)) in indices.iter_mut().zip(rgba.chunks_exact(4)).enumerate() {
                    if rgba[3] >= OPAQUE {
                        let threshold = 2 * i32::from(BAYER[y % 8][x % 8]) - 63;
                        let shift = threshold * self.spread / 64;
                        *index = self.nearest[key_of([rgba[0], rgba[1], rgba[2]], shift)];
                    }
                }
            },
        );
        indices
    }
}

/// GIF knows no half transparency: from here on a pixel is there.
const OPAQUE: u8 = 128;

fn key_of(rgb: [u8; 3], shift: i32) -> usize {
    rgb.iter().fold(0, |key, &c| {
        let level = (i32::from(c) + shift).clamp(0, 255) as usize;
        (key << BITS) | (level >> (8 - BITS))
    })
}

/// The middle of a cell of the table.
fn colour_of(key: u32) -> [i32; 3] {
    let mask = (1 << BITS) - 1;
    [2, 1, 0].map(|c| ((((key >> (c * BITS)) & mask) << (8 - BITS)) + (1 << (7 - BITS))) as i32)
}

fn distance(colour: [u8; 3], rgb: [i32; 3]) -> i32 {
    colour.iter().zip(rgb).map(|(&a, b)| (i32::from(a) - b).pow(2)).sum()
}

fn nearest(colours: &[[u8; 3]], rgb: [i32; 3]) -> u8 {
    (0..colours.len()).min_by_key(|&k| distance(colours[k], rgb)).unwrap_or(0) as u8
}

/// Half the distance between neighbouring colours, in one channel: the median, so that outliers do not coarsen it.
fn spread(colours: &[[u8; 3]]) -> i32 {
    let mut apart: Vec<i32> = (0..colours.len())
        .map(|k| {
            let own = colours[k].map(i32::from);
            (0..colours.len()).filter(|&j| colours[j] != colours[k]).map(|j| distance(colours[j], own)).min()
        })
        .map(|squared| squared.map_or(0, |d| (f64::from(d) / 3.0).sqrt().round() as i32))
        .collect();
    apart.sort_unstable();
    apart.get(apart.len() / 2).map_or(0, |&median| (median / 2).clamp(1, 16))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp() -> RgbaImage {
        RgbaImage::from_fn(256, 64, |x, y| Rgba([x as u8, (x / 2) as u8, 4 * y as u8, 255]))
    }

    fn shown(palette: &Palette, frame: &RgbaImage) -> Vec<[u8; 3]> {
        palette.indices(frame).iter().map(|&index| palette.colours[index as usize]).collect()
    }

    /// Mean over all pixels and channels of the difference after averaging over blocks of 8 by 8.
    fn error(frame: &RgbaImage, shown: &[[u8; 3]]) -> f64 {
        let (blocks_x, blocks_y) = (frame.width() / 8, frame.height() / 8);
        let mut sum = 0.0;
        for (bx, by) in (0..blocks_x).flat_map(|bx| (0..blocks_y).map(move |by| (bx, by))) {
            let cells = (0..64).map(|k| (8 * bx + k % 8, 8 * by + k / 8));
            for channel in [0, 1, 2] {
                let wanted: f64 = cells.clone().map(|(x, y)| f64::from(frame.get_pixel(x, y).0[channel])).sum();
                let pixel = |(x, y): (u32, u32)| f64::from(shown[(y * frame.width() + x) as usize][channel]);
                let found: f64 = cells.clone().map(pixel).sum();
                sum += (wanted - found).abs() / 64.0;
            }
        }
        sum / f64::from(3 * blocks_x * blocks_y)
    }

    #[test]
    fn a_ramp_of_thousands_of_colours_keeps_its_look() {
        let palette = Palette::of(&[ramp()]);
        let found = error(&ramp(), &shown(&palette, &ramp()));
        assert!(found < 4.0, "{found}");
    }

    #[test]
    fn sabotage_a_palette_of_another_film_is_seen() {
        let grey = RgbaImage::from_fn(64, 64, |x, y| Rgba([(x + 2 * y) as u8; 4].map(|c| c | 1)));
        let grey = RgbaImage::from_fn(64, 64, |x, y| {
            let Rgba([c, ..]) = *grey.get_pixel(x, y);
            Rgba([c, c, c, 255])
        });
        let found = error(&ramp(), &shown(&Palette::of(&[grey]), &ramp()));
        assert!(found > 12.0, "{found}");
    }

    #[test]
    fn what_is_clear_stays_clear_and_what_stays_stays() {
        let mut frame = ramp();
        frame.put_pixel(3, 3, Rgba([9, 9, 9, 100]));
        let palette = Palette::of(&[ramp()]);
        let (before, after) = (palette.indices(&ramp()), palette.indices(&frame));
        assert_eq!(after[3 * 256 + 3], CLEAR);
        let others = |indices: &[u8]| indices.iter().enumerate().filter(|(i, _)| *i != 771).map(|(_, k)| *k).collect();
        let (before, after): (Vec<u8>, Vec<u8>) = (others(&before), others(&after));
        assert!(before == after && !before.contains(&CLEAR));
    }

    #[test]
    fn takes_nothing_at_all() {
        assert_eq!(Palette::of(&[]).bytes().len(), 768);
        assert_eq!(Palette::of(&[RgbaImage::new(4, 4)]).indices(&RgbaImage::new(4, 4)), [CLEAR; 16]);
    }
}
