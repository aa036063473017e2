//! Importance as colour.

use std::sync::LazyLock;

use crate::boundary::source::linear_from_srgb;

/// A colour for each importance: viridis, which is perceptually uniform and survives grey printing and colour
/// blindness, over `ln f` from the least to the greatest value given (so ×2 is as long a step anywhere).
///
/// Colours are **linear** RGB in 0..=1, as glTF's `COLOR_0` wants; encode to sRGB before writing 8-bit colours.
/// Where all values are equal the colour is the middle of the map. Values that are not positive and finite are dark.
pub fn colours(importance: &[f32]) -> Vec<[f32; 3]> {
    static MAP: LazyLock<Vec<[f32; 3]>> = LazyLock::new(|| (0..=255).map(|i| viridis(f64::from(i) / 255.0)).collect());
    let logarithms = importance.iter().filter(|f| **f > 0.0 && f.is_finite()).map(|f| f.ln());
    let (low, high) = logarithms.fold((f32::INFINITY, f32::NEG_INFINITY), |(a, b), l| (a.min(l), b.max(l)));
    let colour = |f: &f32| {
        let t = if high > low { (f.ln() - low) / (high - low) } else { 0.5 };
        // NaN and infinities saturate in the cast; the clamp keeps the index inside the table.
        MAP[((t * 255.0).round() as usize).min(255)]
    };
    importance.iter().map(colour).collect()
}

/// The map at `t` in 0..=1, linear RGB.
fn viridis(t: f64) -> [f32; 3] {
    let colour = colorous::VIRIDIS.eval_continuous(t);
    [colour.r, colour.g, colour.b].map(|c| linear_from_srgb(f32::from(c) / 255.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn luminance(c: [f32; 3]) -> f32 {
        0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]
    }

    fn rises(colours: &[[f32; 3]]) -> bool {
        colours.windows(2).all(|pair| luminance(pair[1]) > luminance(pair[0]))
    }

    #[test]
    fn brighter_means_more_important() {
        let importance: Vec<f32> = (0..40).map(|i| 0.2 * 1.1f32.powi(i)).collect();
        let mut shown = colours(&importance);
        assert!(rises(&shown));
        shown.swap(3, 30); // sabotage: seen to fail
        assert!(!rises(&shown));
    }

    #[test]
    fn equal_ratios_are_equal_steps() {
        let shown = colours(&[0.5, 1.0, 2.0]);
        assert_eq!(shown[1], viridis(128.0 / 255.0));
        assert_ne!(colours(&[0.5, 1.25, 2.0])[1], shown[1], "the middle of the plain values is not the middle");
    }

    #[test]
    fn takes_constant_empty_and_poisoned_input() {
        assert_eq!(colours(&[3.0, 3.0]), vec![viridis(128.0 / 255.0); 2]);
        assert!(colours(&[]).is_empty());
        assert!(colours(&[f32::NAN, 0.0, 1.0, f32::INFINITY, 2.0]).iter().flatten().all(|c| (0.0..=1.0).contains(c)));
    }
}
