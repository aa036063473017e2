//! A picture read as a map of values: by luminance, or back along the colour map that it was painted with.

use std::sync::LazyLock;

use rayon::prelude::*;

use crate::picture::Pixels;

/// Largest distance (sRGB, 0..1 a channel) from a colour map at which nearly all of a picture must lie: about what 4:2:0
/// JPEG at quality 90 does to flat colours. Neighbouring maps are several times further apart over most of their length.
const NEAR: f32 = 0.04;

/// Part of the pixels that may lie further away: text, frames, smoothed edges.
const STRAY: f32 = 0.03;

/// Most pixels looked at to tell the map.
const SAMPLES: usize = 20_000;

/// A known colour map.
struct Map {
    name: &'static str,
    /// Colours at equal steps from least to greatest.
    colours: Vec<[f32; 3]>,
}

static MAPS: LazyLock<Vec<Map>> = LazyLock::new(|| {
    let sampled = |name, colour: &dyn Fn(f64) -> [f32; 3]| Map {
        name,
        colours: (0..=127).map(|i| colour(f64::from(i) / 127.0)).collect(),
    };
    let named = |name, gradient: colorous::Gradient| {
        sampled(name, &|t| {
            let colour = gradient.eval_continuous(t);
            [colour.r, colour.g, colour.b].map(|c| f32::from(c) / 255.0)
        })
    };
    let reversed = |name, gradient| {
        let mut map = named(name, gradient);
        map.colours.reverse();
        map
    };
    vec![
        named("viridis", colorous::VIRIDIS),
        named("magma", colorous::MAGMA),
        named("inferno", colorous::INFERNO),
        named("plasma", colorous::PLASMA),
        named("cividis", colorous::CIVIDIS),
        named("turbo", colorous::TURBO),
        sampled("jet", &jet),
        sampled("blue-white-red", &|t| {
            let (low, high) = ((2.0 * t).min(1.0) as f32, (2.0 - 2.0 * t).min(1.0) as f32);
            [low, low.min(high), high]
        }),
        sampled("cool-warm", &cool_warm),
        reversed("red-blue, blue the least", colorous::RED_BLUE),
        reversed("red-yellow-blue, blue the least", colorous::RED_YELLOW_BLUE),
        reversed("spectral, blue the least", colorous::SPECTRAL),
    ]
});

/// `[pixels]` values 0..=1, and in words what they were read as.
pub(super) fn values(pixels: &Pixels) -> (Vec<f32>, String) {
    let size = pixels.size();
    let count = (size.x * size.y) as usize;
    let step = count.div_ceil(SAMPLES);
    let opaque = |index: &usize| pixels.wide(*index)[3] >= 0x8000;
    let sample: Vec<[f32; 3]> = (0..count).step_by(step).filter(opaque).map(|i| rgb(pixels, i)).collect();
    let is_grey = sample.iter().filter(|c| spread(**c) > NEAR).count() as f32 <= STRAY * sample.len() as f32;
    if is_grey {
        return (luminances(pixels, count), "grey, by luminance".into());
    }
    let strays = |map: &Map| sample.iter().filter(|c| map.nearest(**c).1 > NEAR).count();
    let distance = |map: &Map| sample.iter().map(|c| f64::from(map.nearest(*c).1)).sum::<f64>();
    let best = MAPS
        .par_iter()
        .filter(|map| strays(map) as f32 <= STRAY * sample.len() as f32)
        .min_by(|a, b| distance(a).total_cmp(&distance(b)));
    match best {
        Some(map) => {
            let values = (0..count).into_par_iter().map(|i| map.nearest(rgb(pixels, i)).0).collect();
            (values, format!("the colour map {}", map.name))
        }
        None => (luminances(pixels, count), "colours of no map that is known, by luminance".into()),
    }
}

impl Map {
    /// Where along the map a colour is, 0..=1, and how far from it, by the nearest point of the polyline.
    fn nearest(&self, colour: [f32; 3]) -> (f32, f32) {
        let square = |a: [f32; 3], b: [f32; 3]| (0..3).map(|c| (a[c] - b[c]).powi(2)).sum::<f32>();
        let segments = self.colours.len() - 1;
        let mut best = (0.0, f32::INFINITY);
        for (index, ends) in self.colours.windows(2).enumerate() {
            let (mut along, length) = (0.0, square(ends[0], ends[1]));
            (0..3).for_each(|c| along += (colour[c] - ends[0][c]) * (ends[1][c] - ends[0][c]));
            let t = if length > 0.0 { (along / length).clamp(0.0, 1.0) } else { 0.0 };
            let distance = square(colour, std::array::from_fn(|c| ends[0][c] + t * (ends[1][c] - ends[0][c])));
            if distance < best.1 {
                best = ((index as f32 + t) / segments as f32, distance);
            }
        }
        (best.0, best.1.sqrt())
    }
}

/// MATLAB's: four linear ramps.
fn jet(t: f64) -> [f32; 3] {
    let ramp = |centre: f64| (1.5 - (4.0 * t - centre).abs()).clamp(0.0, 1.0) as f32;
    [ramp(3.0), ramp(2.0), ramp(1.0)]
}

/// Moreland, *Diverging Color Maps for Scientific Visualization* (2009), read off its table at nine places.
fn cool_warm(t: f64) -> [f32; 3] {
    const COLOURS: [[f32; 3]; 9] = [
        [59.0, 76.0, 192.0],
        [98.0, 130.0, 234.0],
        [141.0, 176.0, 254.0],
        [184.0, 208.0, 249.0],
        [221.0, 221.0, 221.0],
        [245.0, 196.0, 173.0],
        [244.0, 154.0, 123.0],
        [222.0, 96.0, 77.0],
        [180.0, 4.0, 38.0],
    ];
    let position = t * 8.0;
    let first = (position as usize).min(7);
    let part = (position - first as f64) as f32;
    std::array::from_fn(|c| (COLOURS[first][c] + part * (COLOURS[first + 1][c] - COLOURS[first][c])) / 255.0)
}

fn rgb(pixels: &Pixels, index: usize) -> [f32; 3] {
    let [r, g, b, _] = pixels.wide(index);
    [r, g, b].map(|c| f32::from(c) / 65535.0)
}

fn spread([r, g, b]: [f32; 3]) -> f32 {
    r.max(g).max(b) - r.min(g).min(b)
}

/// ITU-R BT.709 weights on the coded values, as for pictures on bodies.
fn luminances(pixels: &Pixels, count: usize) -> Vec<f32> {
    let luminance = |[r, g, b]: [f32; 3]| 0.2126 * r + 0.7152 * g + 0.0722 * b;
    (0..count).into_par_iter().map(|i| luminance(rgb(pixels, i))).collect()
}
