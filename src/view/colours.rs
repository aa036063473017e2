//! Colour maps: diverging from a light neutral grey, even to the eye.
//!
//! Each half runs through a few colours of falling lightness and is walked at constant speed in Oklab, so that equal steps of the
//! value are equal steps to the eye, also printed in grey within a half. Blue and red halves differ for every common colour
//! blindness; purple and green do too and are not taken for importance.

use std::sync::LazyLock;

use bevy::{
    color::{Mix, Oklaba},
    prelude::*,
};

/// Colours in a map: a step is below what 8 bits show.
pub(super) const ENTRIES: usize = 257;

/// A map, linear RGB, from its low to its high end; the middle is neutral.
pub(super) type Map = [LinearRgba; ENTRIES];

/// What is neither more nor less.
const NEUTRAL: [u8; 3] = [0xe4, 0xe3, 0xe0];

/// For sizes: blue is smaller, red is larger.
pub(super) static SIZE: LazyLock<Map> = LazyLock::new(|| {
    diverging(
        &[[0xa9, 0xcb, 0xe2], [0x4a, 0x90, 0xc6], [0x1f, 0x55, 0x9e], [0x1a, 0x25, 0x63]],
        &[[0xf6, 0xcf, 0x8f], [0xf0, 0x8a, 0x4b], [0xd1, 0x3f, 0x3f], [0x9a, 0x1a, 0x58], [0x62, 0x12, 0x58]],
    )
});

/// For what was reached of it: purple is too small, green is too large.
pub(super) static REACHED: LazyLock<Map> = LazyLock::new(|| {
    diverging(
        &[[0xc4, 0xb1, 0xdb], [0x8f, 0x6b, 0xb5], [0x5a, 0x2d, 0x86], [0x33, 0x11, 0x55]],
        &[[0xb5, 0xd9, 0xa6], [0x63, 0xa9, 0x6c], [0x1f, 0x73, 0x43], [0x08, 0x40, 0x2a]],
    )
});

/// A map from two lists of sRGB colours, each going outwards from the middle.
fn diverging(low: &[[u8; 3]], high: &[[u8; 3]]) -> Map {
    let (low, high) = (half(low), half(high));
    std::array::from_fn(|k| {
        let from_middle = k.abs_diff(ENTRIES / 2);
        LinearRgba::from(if k < ENTRIES / 2 { low[from_middle] } else { high[from_middle] })
    })
}

/// From the neutral colour outwards, at constant speed in Oklab.
fn half(outwards: &[[u8; 3]]) -> Vec<Oklaba> {
    let colour = |c: &[u8; 3]| Oklaba::from(Srgba::rgb_u8(c[0], c[1], c[2]));
    let stops: Vec<Oklaba> = std::iter::once(&NEUTRAL).chain(outwards).map(colour).collect();
    let steps: Vec<f32> = stops.windows(2).map(|pair| distance(&pair[0], &pair[1])).collect();
    let total: f32 = steps.iter().sum();
    (0..=ENTRIES / 2)
        .map(|k| {
            let mut left = total * k as f32 / (ENTRIES / 2) as f32;
            let last = steps.len() - 1;
            for (i, &step) in steps.iter().enumerate() {
                if left <= step || i == last {
                    return stops[i].mix(&stops[i + 1], (left / step).min(1.0));
                }
                left -= step;
            }
            stops[last]
        })
        .collect()
}

fn distance(a: &Oklaba, b: &Oklaba) -> f32 {
    Vec3::new(a.lightness - b.lightness, a.a - b.a, a.b - b.b).length()
}

/// The colour at a place in 0..=1.
pub(super) fn at(map: &Map, place: f32) -> LinearRgba {
    let along = place.clamp(0.0, 1.0) * (ENTRIES - 1) as f32;
    let low = (along as usize).min(ENTRIES - 2);
    map[low].mix(&map[low + 1], along - low as f32)
}

/// As sRGB bytes.
pub(super) fn bytes(colour: LinearRgba) -> [u8; 3] {
    let [r, g, b, _] = Srgba::from(colour).to_u8_array();
    [r, g, b]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest over smallest step to the eye within one half.
    fn unevenness(map: &[LinearRgba]) -> f32 {
        let lab: Vec<Oklaba> = map.iter().map(|&c| c.into()).collect();
        let steps: Vec<f32> = lab.windows(2).map(|pair| distance(&pair[0], &pair[1])).collect();
        let (low, high) = steps.iter().fold((f32::INFINITY, 0.0_f32), |(l, h), &s| (l.min(s), h.max(s)));
        high / low
    }

    #[test]
    fn steps_are_even_and_halves_darken_outwards() {
        for map in [&*SIZE, &*REACHED] {
            let (low, high) = map.split_at(ENTRIES / 2);
            assert!(unevenness(low) < 1.3 && unevenness(high) < 1.3);
            assert_eq!(bytes(map[ENTRIES / 2]), NEUTRAL);
            let lightness = |c: &LinearRgba| Oklaba::from(*c).lightness;
            assert!(low.is_sorted_by_key(lightness) && high.iter().rev().is_sorted_by_key(lightness));
        }
        // Sabotage: a map that lingers at its end is seen.
        let mut map = SIZE[ENTRIES / 2..].to_vec();
        map[60] = map[61];
        assert!(unevenness(&map) > 1.9);
    }
}
