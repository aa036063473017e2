//! A picture as light: linear and premultiplied by alpha, so that means of pixels are means of light.

use glam::{DVec2, UVec2};
use rayon::prelude::*;

use super::super::{Picture, Pixels};
use crate::boundary::source::{linear_from_srgb, srgb_from_linear};

/// How far beyond the domain a pixel is still seen: an outline's smoothed rim, as wide as a picture scaled up twice has it.
const RIM: usize = 2;

/// The picture's visible part.
#[derive(Debug, Clone)]
pub(super) struct Texels {
    pub size: UVec2,
    /// `[height × width]` linear red, green and blue times alpha, and alpha; zero where nothing of the body is.
    light: Vec<[f32; 4]>,
}

impl Texels {
    pub fn new(picture: &Picture) -> Self {
        let seen = dilated(&picture.domain, picture.size);
        let linear: Vec<f32> = match &picture.pixels {
            Pixels::Eight(_) => (0..=255).map(|c| linear_from_srgb(c as f32 / 255.0)).collect(),
            Pixels::Sixteen(_) => (0..=65535).map(|c| linear_from_srgb(c as f32 / 65535.0)).collect(),
        };
        let step = 65535 / (linear.len() - 1);
        let light = |index: usize| {
            if !seen[index] {
                return [0.0; 4];
            }
            let [r, g, b, a] = picture.pixels.wide(index);
            let alpha = f32::from(a) / 65535.0;
            let [r, g, b] = [r, g, b].map(|c| linear[usize::from(c) / step] * alpha);
            [r, g, b, alpha]
        };
        Self { size: picture.size, light: (0..seen.len()).into_par_iter().map(light).collect() }
    }

    /// Light at a place of the picture by the Catmull-Rom spline, which passes through the pixels' centres; kept within
    /// the four nearest pixels' range, so that edges do not ring. Beyond the picture its last pixels go on.
    pub fn at(&self, place: DVec2) -> [f32; 4] {
        let (columns, x) = taps(place.x, self.size.x);
        let (rows, y) = taps(place.y, self.size.y);
        let (wx, wy) = (catmull_rom(x), catmull_rom(y));
        let mut sum = [0.0; 4];
        let (mut least, mut greatest) = ([f32::INFINITY; 4], [f32::NEG_INFINITY; 4]);
        for (j, row) in rows.into_iter().enumerate() {
            let row = &self.light[row * self.size.x as usize..][..self.size.x as usize];
            for (i, column) in columns.into_iter().enumerate() {
                let texel = row[column];
                let weight = wx[i] * wy[j];
                let is_nearest = (1..3).contains(&i) && (1..3).contains(&j);
                for c in 0..4 {
                    sum[c] += weight * texel[c];
                    if is_nearest {
                        least[c] = least[c].min(texel[c]);
                        greatest[c] = greatest[c].max(texel[c]);
                    }
                }
            }
        }
        std::array::from_fn(|c| sum[c].clamp(least[c], greatest[c]))
    }
}

/// The four pixels around a coordinate, and how far it is from the second to the third, 0..1.
fn taps(coordinate: f64, size: u32) -> ([usize; 4], f32) {
    let position = coordinate - 0.5;
    let first = position.floor();
    let pixel = |k: f64| (first + k).clamp(0.0, f64::from(size - 1)) as usize;
    ([pixel(-1.0), pixel(0.0), pixel(1.0), pixel(2.0)], (position - first) as f32)
}

/// Weights of four samples in a row at `t` from the second to the third (Catmull & Rom 1974; Keys 1981 with a = −1/2).
fn catmull_rom(t: f32) -> [f32; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [-0.5 * t + t2 - 0.5 * t3, 1.0 - 2.5 * t2 + 1.5 * t3, 0.5 * t + 2.0 * t2 - 1.5 * t3, -0.5 * t2 + 0.5 * t3]
}

/// `[pixels]` which lie within [`RIM`] pixels of the domain, diagonals included.
pub(in crate::picture) fn dilated(domain: &[bool], size: UVec2) -> Vec<bool> {
    let (width, height) = (size.x as usize, size.y as usize);
    let along = |source: &[bool], count: usize, stride: usize, index: usize, at: usize| {
        let (from, to) = (at.saturating_sub(RIM), (at + RIM).min(count - 1));
        (from..=to).any(|k| source[index + k * stride - at * stride])
    };
    let wide: Vec<bool> =
        (0..domain.len()).into_par_iter().map(|index| along(domain, width, 1, index, index % width)).collect();
    (0..wide.len()).into_par_iter().map(|index| along(&wide, height, width, index, index / width)).collect()
}

/// sRGB with straight alpha, each 0..=1, of light.
pub(super) fn straight([r, g, b, alpha]: [f32; 4]) -> [f32; 4] {
    if alpha <= 0.0 {
        return [0.0; 4];
    }
    let [r, g, b] = [r, g, b].map(|c| srgb_from_linear((c / alpha).clamp(0.0, 1.0)));
    [r, g, b, alpha.min(1.0)]
}
