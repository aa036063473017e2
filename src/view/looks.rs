//! What the surface shows, and the legend that says so.

use std::sync::Arc;

use bevy::prelude::*;

use super::colours::{self, Map};

/// How a [`Body`](super::Body) is drawn.
#[derive(Component, Debug, Clone, Default, PartialEq)]
pub struct Looks {
    /// Which field, if any.
    pub mode: Mode,
    /// `[vertices]` importance f, > 0: for [`Mode::Importance`].
    pub importance: Option<Arc<Vec<f32>>>,
    /// `[vertices]` size achieved over size asked, > 0, 1 = reached: for [`Mode::Fidelity`].
    pub fidelity: Option<Arc<Vec<f32>>>,
    /// `[nodes]` of the complex, > 0: importance, or the size factor reached: for [`Mode::Voxels`].
    pub voxels: Option<Arc<Vec<f32>>>,
    /// Least and greatest value of the colour map, or `None` to take them from the values shown.
    pub range: Option<[f32; 2]>,
    /// Triangles of the boundary drawn red, because they cross others.
    pub marked: Option<Arc<Vec<u32>>>,
    /// Only one side of a line is drawn.
    pub wipe: Option<Wipe>,
}

/// Which field the surface shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Mode {
    /// None: the file's own colours, or studio grey.
    #[default]
    Plain,
    /// Size asked for, by a diverging map of ln f with light grey at 1.
    Importance,
    /// Size achieved over size asked, by another diverging map.
    Fidelity,
    /// The complex instead of the surface, as in Fig. 3.
    Voxels(VoxelColour),
}

/// What the complex is coloured by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum VoxelColour {
    /// Nothing.
    #[default]
    Plain,
    /// Size asked for.
    Importance,
    /// Size factor of the state shown at λ.
    Growth,
}

/// A vertical line on the screen with one body to either side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wipe {
    /// 0 = left, 1 = right edge of the picture.
    pub at: f32,
    /// Whether this body is what lies left of the line, else right of it.
    pub keeps_left: bool,
}

/// What colours mean.
#[derive(Debug, Clone, PartialEq)]
pub struct Legend {
    /// What is shown: "importance".
    pub title: &'static str,
    /// In which unit: "size factor".
    pub unit: &'static str,
    /// Value and sRGB colour, evenly spaced along the bar from its low to its high end.
    pub stops: Vec<(f32, [u8; 3])>,
    /// Place along the bar in 0..=1, and what to write there: `×2`.
    pub ticks: Vec<(f32, String)>,
}

/// Ends that a colour map may have, as factors from 1: what reads well on a legend.
const ENDS: [f32; 15] = [1.1, 1.25, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0, 32.0, 64.0, 128.0, 1024.0];

/// Colours along a legend's bar.
const STOPS: usize = 65;

/// How values become places on a map: by their logarithm, 1 in the middle, as far to either side as the furthest value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Scale {
    /// What the ends of the map stand for: `1 / reach` and `reach`.
    reach: f32,
    /// What the legend shows of it.
    shown: [f32; 2],
}

impl Scale {
    /// The scale for values within a range. A range that is empty or no range is as wide as the narrowest scale.
    fn new([low, high]: [f32; 2]) -> Self {
        let end = |factor: f32| ENDS.into_iter().find(|&end| end >= factor * 0.999).unwrap_or(ENDS[ENDS.len() - 1]);
        let (low, high) = (end((1.0 / low).max(1.0)), end(high.max(1.0)));
        // Nothing below 1 to speak of: the legend begins there.
        let near = |factor: f32| if factor <= ENDS[0] { 1.0 } else { factor };
        let shown = if near(low) * near(high) == 1.0 { [1.0 / low, high] } else { [1.0 / near(low), near(high)] };
        Self { reach: low.max(high), shown }
    }

    /// Place on the map in 0..=1; the middle for what is no size.
    pub fn place(&self, value: f32) -> f32 {
        if value > 0.0 { (0.5 + 0.5 * value.ln() / self.reach.ln()).clamp(0.0, 1.0) } else { 0.5 }
    }
}

impl Looks {
    /// The field that is shown: its values, map, title and unit.
    fn field(&self) -> Option<(&Arc<Vec<f32>>, &'static Map, &'static str, &'static str)> {
        let asked = "size factor asked for";
        let (values, map, title, unit) = match self.mode {
            Mode::Plain | Mode::Voxels(VoxelColour::Plain) => return None,
            Mode::Importance => (&self.importance, &colours::SIZE, "importance", asked),
            Mode::Fidelity => (&self.fidelity, &colours::REACHED, "fidelity", "size reached / asked for"),
            Mode::Voxels(VoxelColour::Importance) => (&self.voxels, &colours::SIZE, "importance", asked),
            Mode::Voxels(VoxelColour::Growth) => (&self.voxels, &colours::SIZE, "growth", "size factor reached"),
        };
        Some((values.as_ref()?, map, title, unit))
    }

    /// The values shown and how they become colours.
    pub(super) fn mapped(&self) -> Option<(&Arc<Vec<f32>>, Scale, &'static Map)> {
        let (values, map, ..) = self.field()?;
        let range = self.range.unwrap_or_else(|| {
            let fine = values.iter().copied().filter(|v| *v > 0.0 && v.is_finite());
            fine.fold([f32::INFINITY, 0.0], |[low, high], v| [low.min(v), high.max(v)])
        });
        Some((values, Scale::new(range), map))
    }

    /// The legend of what is shown; `None` where colours mean nothing.
    pub fn legend(&self) -> Option<Legend> {
        let (_, _, title, unit) = self.field()?;
        let (_, scale, map) = self.mapped()?;
        let [low, high] = scale.shown.map(f32::ln);
        let value = |t: f32| (low + t * (high - low)).exp();
        let stops = (0..STOPS)
            .map(|k| value(k as f32 / (STOPS - 1) as f32))
            .map(|v| (v, colours::bytes(colours::at(map, scale.place(v)))))
            .collect();
        let ticks = ticks(scale.shown).into_iter().map(|v| ((v.ln() - low) / (high - low), label(v))).collect();
        Some(Legend { title, unit, stops, ticks })
    }

    /// The linear colour of a value on the map shown, for the preview of a dab.
    pub(super) fn colour(&self, value: f32) -> LinearRgba {
        // Where no field is shown a dab previews what the importance map would show.
        match self.mapped() {
            Some((_, scale, map)) => colours::at(map, scale.place(value)),
            None => colours::at(&colours::SIZE, Scale::new([0.25, 4.0]).place(value)),
        }
    }
}

/// Round values within a range: 1, its powers of two, or the ends of a narrow range.
fn ticks([low, high]: [f32; 2]) -> Vec<f32> {
    let (low, high) = (low * 0.999, high * 1.001);
    if high < 2.0 && low > 0.5 {
        return [low / 0.999, 1.0, high / 1.001].into_iter().filter(|v| (low..=high).contains(v)).collect();
    }
    let every = if high / low > 100.0 { 4.0_f32 } else { 2.0 };
    let mut ticks: Vec<f32> = (-10..=10).map(|k| every.powi(k)).filter(|v| (low..=high).contains(v)).collect();
    // The ends too, where there is room for them.
    let room = 0.12 * (high / low).ln();
    let (low, high) = (low / 0.999, high / 1.001);
    if ticks.first().is_none_or(|first| (first / low).ln() > room) {
        ticks.insert(0, low);
    }
    if ticks.last().is_none_or(|last| (high / last).ln() > room) {
        ticks.push(high);
    }
    ticks
}

/// `×2`, `×½`, `×1.25`.
fn label(value: f32) -> String {
    let below = (1.0 / value).round();
    if value < 1.0 && (below * value - 1.0).abs() < 1.0e-3 {
        return match below as u32 {
            2 => "×½".into(),
            4 => "×¼".into(),
            n => format!("×1/{n}"),
        };
    }
    let text = format!("{value:.2}");
    format!("×{}", text.trim_end_matches('0').trim_end_matches('.'))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn importance(values: &[f32]) -> Looks {
        Looks { mode: Mode::Importance, importance: Some(Arc::new(values.to_vec())), ..default() }
    }

    #[test]
    fn the_legend_has_neutral_grey_at_one_and_equal_ratios_are_equal_steps() {
        let looks = importance(&[0.3, 1.0, 5.0]);
        let legend = looks.legend().expect("a legend");
        let at_one = legend.stops.iter().min_by(|a, b| a.0.ln().abs().total_cmp(&b.0.ln().abs())).expect("stops");
        assert!(at_one.1[0].abs_diff(at_one.1[2]) < 16, "{at_one:?}");
        let ticks: Vec<&str> = legend.ticks.iter().map(|t| t.1.as_str()).collect();
        assert_eq!(ticks, ["×¼", "×½", "×1", "×2", "×4", "×6"]);
        let [half, one, two] = [1, 2, 3].map(|k| legend.ticks[k].0);
        assert!((one - half - (two - one)).abs() < 1e-5);
        assert!(legend.ticks.iter().all(|t| (0.0..=1.0).contains(&t.0)));
    }

    #[test]
    fn odd_values_have_a_legend_too() {
        for values in [&[1.0; 3][..], &[], &[f32::NAN, 0.0, -1.0, f32::INFINITY], &[1e-20, 1e20]] {
            let legend = importance(values).legend().expect("a legend");
            assert!(legend.stops.iter().all(|s| s.0.is_finite() && s.0 > 0.0));
            assert!(!legend.ticks.is_empty(), "{values:?}");
        }
        assert_eq!(Looks::default().legend(), None);
    }
}
