//! Which state each frame shows, and from where. Time is the frame's number: nothing here knows a clock.

use super::Settings;

/// What one frame shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FramePlan {
    /// λ, 0..=1.
    pub lambda: f32,
    /// The state.
    pub mix: Mix,
    /// How far the table has turned, radians.
    pub turn: f32,
}

/// A state of the film: the blend `(1 − t) a + t b` of two neighbouring keyframes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mix {
    /// The earlier keyframe.
    pub from: usize,
    /// The later one; the same where `t` is 0.
    pub to: usize,
    /// How far from the one to the other, 0..1.
    pub t: f32,
}

impl Mix {
    /// The state at `lambda` of a film with keyframes at these λ (`[keyframes]`, rising). Outside of them it is the nearest
    /// keyframe.
    pub fn at(lambda: f32, keyframes: &[f32]) -> Self {
        let to = keyframes.partition_point(|&key| key < lambda).min(keyframes.len().saturating_sub(1));
        let alone = Self { from: to, to, t: 0.0 };
        if to == 0 || keyframes[to] <= lambda {
            return alone;
        }
        let (low, high) = (keyframes[to - 1], keyframes[to]);
        let t = (lambda - low) / (high - low);
        // Rounding may bring it to a whole step.
        if t < 1.0 { Self { from: to - 1, to, t } } else { alone }
    }
}

/// What each frame of a film shows. `keyframes`: their λ, rising, at least one.
///
/// Without ping-pong the first frame is at rest and the last at λ = 1. With it, the last is one step before rest again, so
/// that the film loops without a stutter; λ = 1 is shown exactly.
pub fn plan(settings: &Settings, keyframes: &[f32]) -> Vec<FramePlan> {
    if let Some(lambda) = settings.still {
        return vec![FramePlan { lambda, mix: Mix::at(lambda, keyframes), turn: 0.0 }];
    }
    let frames = settings.frames();
    (0..frames)
        .map(|frame| {
            let lambda = settings.ease.at(share(settings, frame)) as f32;
            let turn = std::f64::consts::TAU * f64::from(settings.turntable) * frame as f64 / frames as f64;
            FramePlan { lambda, mix: Mix::at(lambda, keyframes), turn: turn as f32 }
        })
        .collect()
}

/// Share of the growing time that has passed at a frame, 0..=1.
fn share(settings: &Settings, frame: usize) -> f64 {
    let (frames, hold) = (settings.frames(), settings.hold_frames());
    let ramp = |from: usize, steps: usize| (frame.saturating_sub(from) as f64 / steps as f64).min(1.0);
    if !settings.ping_pong {
        return ramp(hold, frames - 1 - 2 * hold);
    }
    let up = (frames - 2 * hold) / 2;
    let down = frames - 2 * hold - up;
    let full = hold + up;
    if frame <= full { ramp(hold, up) } else { 1.0 - ramp(full + hold, down) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::{Draft, Ease};

    const KEYS: [f32; 4] = [0.0, 0.3, 0.35, 1.0];

    fn lambdas(draft: Draft) -> Vec<f32> {
        plan(&Settings::new(draft).unwrap(), &KEYS).iter().map(|frame| frame.lambda).collect()
    }

    fn draft(seconds: f64, hold: f64, ping_pong: bool) -> Draft {
        Draft { seconds, fps: 10, hold, ping_pong, ease: Ease::Linear, ..Draft::default() }
    }

    #[test]
    fn grows_from_rest_to_the_end() {
        assert_eq!(lambdas(draft(0.5, 0.0, false)), [0.0, 0.25, 0.5, 0.75, 1.0]);
        assert_eq!(lambdas(draft(0.9, 0.2, false)), [0.0, 0.0, 0.0, 0.25, 0.5, 0.75, 1.0, 1.0, 1.0]);
        assert_eq!(lambdas(draft(0.2, 0.0, false)), [0.0, 1.0]);
    }

    #[test]
    fn there_and_back_loops() {
        assert_eq!(lambdas(draft(0.4, 0.0, true)), [0.0, 0.5, 1.0, 0.5]);
        assert_eq!(lambdas(draft(0.8, 0.2, true)), [0.0, 0.0, 0.0, 0.5, 1.0, 1.0, 1.0, 0.5]);
        for frames in 3..40 {
            let shown = lambdas(draft(f64::from(frames) / 10.0, 0.0, true));
            assert!(shown.contains(&1.0) && shown[0] == 0.0 && shown[shown.len() - 1] < 1.0, "{frames}: {shown:?}");
        }
    }

    #[test]
    fn mixes_are_between_the_right_keyframes() {
        assert_eq!(Mix::at(0.0, &KEYS), Mix { from: 0, to: 0, t: 0.0 });
        assert_eq!(Mix::at(1.0, &KEYS), Mix { from: 3, to: 3, t: 0.0 });
        assert_eq!(Mix::at(0.3, &KEYS), Mix { from: 1, to: 1, t: 0.0 });
        assert_eq!(Mix::at(0.15, &KEYS), Mix { from: 0, to: 1, t: 0.5 });
        assert_eq!(Mix::at(0.5, &[0.0]), Mix { from: 0, to: 0, t: 0.0 });
        for i in 0..=1000 {
            let lambda = i as f32 / 1000.0;
            let Mix { from, to, t } = Mix::at(lambda, &KEYS);
            let shown = (1.0 - t) * KEYS[from] + t * KEYS[to];
            assert!((shown - lambda).abs() < 1e-6 && (0.0..1.0).contains(&t) && to - from <= 1, "{lambda}");
        }
    }

    #[test]
    fn the_table_turns_evenly_and_closes() {
        let settings = Settings::new(Draft { turntable: 2.0, ..draft(1.0, 0.0, false) }).unwrap();
        let turns: Vec<f32> = plan(&settings, &KEYS).iter().map(|frame| frame.turn).collect();
        let step = std::f32::consts::TAU * 2.0 / 10.0;
        assert!(turns.iter().enumerate().all(|(i, turn)| (turn - i as f32 * step).abs() < 1e-5), "{turns:?}");
    }

    #[test]
    fn a_still_is_one_frame() {
        let settings = Settings::new(Draft { still: Some(0.15), ..Draft::default() }).unwrap();
        let frame = FramePlan { lambda: 0.15, mix: Mix { from: 0, to: 1, t: 0.5 }, turn: 0.0 };
        assert_eq!(plan(&settings, &KEYS), [frame]);
    }
}
