//! Textures of pictures: light premultiplied by alpha, so that filtering takes no colour from what is transparent.
//!
//! sRGB bytes hold linear light times alpha; the GPU decodes before it filters, so that every mean is one of light. Opaque
//! pixels keep their bytes.

use std::sync::LazyLock;

use image::{Rgba, RgbaImage};
use rayon::prelude::*;

use crate::boundary::source::{linear_from_srgb, srgb_from_linear};

/// Longest side of a texture, pixels: what every GPU of the last ten years takes. A larger picture is drawn from its half.
const LONGEST: u32 = 8192;

static LINEAR: LazyLock<Vec<f32>> = LazyLock::new(|| (0..=255).map(|c| linear_from_srgb(c as f32 / 255.0)).collect());

/// The picture, premultiplied, and its halves down to one pixel; `None` for one without pixels.
pub(super) fn levels(mut full: RgbaImage) -> Option<Vec<RgbaImage>> {
    if full.is_empty() {
        return None;
    }
    full.par_chunks_mut(4).with_min_len(4096).filter(|pixel| pixel[3] < 255).for_each(|pixel| {
        let alpha = f32::from(pixel[3]) / 255.0;
        (0..3).for_each(|c| pixel[c] = encoded(LINEAR[usize::from(pixel[c])] * alpha));
    });
    while full.width().max(full.height()) > LONGEST {
        full = half(&full);
    }
    let mut levels = vec![full];
    while let Some(last) = levels.last().filter(|last| last.width().max(last.height()) > 1) {
        levels.push(half(last));
    }
    Some(levels)
}

fn encoded(linear: f32) -> u8 {
    (srgb_from_linear(linear.clamp(0.0, 1.0)) * 255.0).round() as u8
}

/// Half the width and height, rounded down, at least 1: each pixel the mean of the light it covers.
fn half(image: &RgbaImage) -> RgbaImage {
    let (columns, rows) = (covered(image.width()), covered(image.height()));
    let width = columns.len();
    let mut pixels = vec![0; 4 * width * rows.len()];
    pixels.par_chunks_mut(4 * width).zip(&rows).for_each(|(line, row)| {
        for (pixel, column) in line.chunks_exact_mut(4).zip(&columns) {
            let (mut sum, mut weight) = ([0.0; 4], 0.0);
            for (&(y, height), &(x, width)) in row.iter().flat_map(|y| column.iter().map(move |x| (y, x))) {
                let Rgba(read) = *image.get_pixel(x, y);
                let part = height * width;
                (0..3).for_each(|c| sum[c] += part * LINEAR[usize::from(read[c])]);
                sum[3] += part * f32::from(read[3]);
                weight += part;
            }
            (0..3).for_each(|c| pixel[c] = encoded(sum[c] / weight));
            pixel[3] = (sum[3] / weight).round() as u8;
        }
    });
    RgbaImage::from_raw(width as u32, rows.len() as u32, pixels).unwrap_or_default()
}

/// `[half the pixels]` which pixels each covers, and how much of them.
fn covered(side: u32) -> Vec<Vec<(u32, f32)>> {
    let count = (side / 2).max(1);
    let step = f64::from(side) / f64::from(count);
    let of = |k: u32| {
        let (from, to) = (f64::from(k) * step, f64::from(k + 1) * step);
        let part = |pixel: u32| (to.min(f64::from(pixel + 1)) - from.max(f64::from(pixel))) as f32;
        let last = (to.ceil() as u32).min(side);
        (from as u32..last).map(|pixel| (pixel, part(pixel))).filter(|(_, part)| *part > 1.0e-6).collect()
    };
    (0..count).map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_are_means_of_light_and_transparent_pixels_lend_no_colour() {
        let image = RgbaImage::from_fn(5, 4, |x, _| Rgba(if x < 2 { [200, 100, 50, 255] } else { [0, 255, 0, 0] }));
        let levels = levels(image.clone()).expect("pixels");
        let sizes: Vec<(u32, u32)> = levels.iter().map(RgbaImage::dimensions).collect();
        assert_eq!(sizes, [(5, 4), (2, 2), (1, 1)]);
        assert_eq!(levels[0].get_pixel(1, 1).0, [200, 100, 50, 255], "opaque pixels keep their bytes");
        assert_eq!(levels[0].get_pixel(3, 1).0, [0; 4]);
        // Two of two and a half columns are there.
        let Rgba([r, g, b, a]) = *levels[1].get_pixel(0, 0);
        assert_eq!(a, 204);
        let straight = |c: u8| srgb_from_linear(LINEAR[usize::from(c)] / 0.8) * 255.0;
        for (c, wanted) in [(r, 200.0), (g, 100.0), (b, 50.0)] {
            assert!((straight(c) - wanted).abs() < 2.0, "{c} {wanted}");
        }
        // Sabotage: halving straight alpha takes the transparent green along.
        let naive = image::imageops::resize(&image, 2, 2, image::imageops::FilterType::Triangle);
        assert!(naive.get_pixel(0, 0).0[1] > 110);
    }

    #[test]
    fn large_pictures_are_taken_by_their_half() {
        let levels = levels(RgbaImage::from_pixel(LONGEST + 2, 3, Rgba([9, 8, 7, 255]))).expect("pixels");
        assert_eq!(levels[0].dimensions(), (LONGEST / 2 + 1, 1));
        assert_eq!(levels[0].get_pixel(70, 0).0, [9, 8, 7, 255]);
    }
}
