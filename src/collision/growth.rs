//! Growth: which λ comes next, and when a state counts as settled.
//!
//! Where nothing is in the way, growth goes in one extrapolated step from keyframe to keyframe: it starts from where
//! the last two keyframes point, a few iterations follow that nobody guards, and the certificate of the whole motion
//! decides. Where that is refused, the same stretch is walked in small guarded steps.

use crate::voxel::Dimension;

/// λ grows by at most this many steps' worth of relative size change: `ln` of the largest factor per step. Above about
/// 0.2 steps fold cells that the guard must then hold; smaller only costs time.
const LN_SIZE_PER_STEP: f32 = 0.12;

/// Steps of λ at the least: the film's own keyframes.
pub const LEAST_STEPS: usize = 20;

/// Iterations at each λ below 1: on the way, and where the state becomes a keyframe.
const ITERATIONS_PER_STEP: [u32; 2] = [2, 4];

/// Iterations of an extrapolated step to a keyframe.
const ITERATIONS_PER_EXTRAPOLATION: u32 = 2;

/// An extrapolated step takes at most this much relative size change at once, as `ln` of the largest factor.
const LN_SIZE_PER_EXTRAPOLATION: f32 = 0.4;

/// Iterations at λ = 1 at most.
const SETTLING_ITERATIONS: u32 = 80;

/// The same where the boundary is guarded in every iteration: each costs several times as much there, and what is held
/// does not come to rest.
const HURRIED_ITERATIONS: u32 = 40;

/// Iterations at λ = 1 at least.
const LEAST_SETTLING: u32 = 8;

/// The same at the end of an extrapolated step, which starts nearer: at least and at most.
const EXTRAPOLATED_SETTLING: [u32; 2] = [4, 8];

/// At λ = 1 the state is settled when no node moves further than this in an iteration, in cells.
const SETTLED_MOTION: f32 = 0.02;

/// How fast a growth is walked.
#[derive(Debug, Clone, Copy)]
struct Pace {
    /// Steps of λ at the least.
    steps: usize,
    /// Relative size change of a step at most, as `ln` of the largest factor.
    ln_size: f32,
    /// Iterations at each λ below 1: on the way, and where the state becomes a keyframe.
    iterations: [u32; 2],
}

/// In space.
const BODY: Pace = Pace { steps: LEAST_STEPS, ln_size: LN_SIZE_PER_STEP, iterations: ITERATIONS_PER_STEP };

/// In the plane, where large parts flow far at every λ: in steps half as long, each brought nearer to rest. A
/// population cartogram locked in folded cells at the pace of bodies.
const PICTURE: Pace = Pace { steps: 48, ln_size: 0.06, iterations: [4, 6] };

/// Where the growth is.
#[derive(Debug, Clone)]
pub struct Growth {
    /// λ of each step, ascending, the last 1.
    steps: Vec<f32>,
    /// Iterations at each λ below 1: on the way, and where the state becomes a keyframe.
    iterations: [u32; 2],
    /// λ of keyframes are multiples of 1 / keys.
    keys: usize,
    step: usize,
    iteration: u32,
    motion: f32,
    patience: u32,
    /// Least and greatest importance.
    range: [f32; 2],
    /// The first step after the last keyframe.
    stretch: usize,
    /// Whether the present step is extrapolated over the stretch to its keyframe.
    is_extrapolated: bool,
    /// Whether nothing was held back since the last keyframe.
    free: bool,
}

/// The largest change of ln size from λ = a to b.
fn ln_change(range: [f32; 2], a: f32, b: f32) -> f32 {
    let ln_size = |lambda: f32, f: f32| (1.0 + lambda * (f - 1.0)).ln();
    range.map(|f| (ln_size(b, f) - ln_size(a, f)).abs()).into_iter().fold(0.0, f32::max)
}

impl Growth {
    /// Plans the steps for importance in `low..=high`: at least `keys` equal ones, cut where sizes change fast.
    pub fn plan(keys: usize, low: f32, high: f32) -> Self {
        Self::paced(BODY, keys, low, high)
    }

    fn paced(pace: Pace, keys: usize, low: f32, high: f32) -> Self {
        let count = pace.steps.div_ceil(keys.max(1)) * keys.max(1);
        let ln_size = |lambda: f32, f: f32| (1.0 + lambda * (f - 1.0)).ln();
        let mut steps = Vec::new();
        for k in 0..count {
            let (a, b) = (k as f32 / count as f32, (k + 1) as f32 / count as f32);
            let change = [low, high].map(|f| (ln_size(b, f) - ln_size(a, f)).abs());
            let cuts = (change[0].max(change[1]) / pace.ln_size).ceil().max(1.0);
            // Cuts equal in ln of the faster size, so that none of them takes the whole change.
            let f = if change[0] > change[1] { low } else { high };
            for cut in 1..cuts as usize {
                let ln = ln_size(a, f) + (ln_size(b, f) - ln_size(a, f)) * cut as f32 / cuts;
                steps.push((ln.exp() - 1.0) / (f - 1.0));
            }
            steps.push(b);
        }
        let mut growth = Self {
            steps,
            iterations: pace.iterations,
            keys: keys.max(1),
            step: 0,
            iteration: 0,
            motion: f32::INFINITY,
            patience: SETTLING_ITERATIONS,
            range: [low, high],
            stretch: 0,
            is_extrapolated: false,
            free: true,
        };
        growth.begin_stretch();
        growth
    }

    /// Begins the way to the next keyframe with an extrapolated step, if nothing was in the way to the last one.
    fn begin_stretch(&mut self) {
        self.stretch = self.step;
        let key = (self.step..self.steps.len()).find(|&k| self.is_key_step(k)).unwrap_or(self.step);
        self.is_extrapolated = self.free
            && key < self.steps.len()
            && ln_change(self.range, self.last_key(), self.steps[key]) <= LN_SIZE_PER_EXTRAPOLATION;
        self.free = true;
        if self.is_extrapolated {
            self.step = key;
        }
    }

    /// λ of the last keyframe.
    pub fn last_key(&self) -> f32 {
        self.stretch.checked_sub(1).map_or(0.0, |k| self.steps[k])
    }

    /// Whether the present step is extrapolated from the last keyframe to the next.
    pub fn is_extrapolated(&self) -> bool {
        self.is_extrapolated
    }

    /// Gives an extrapolated step up: the same stretch again, in small steps.
    pub fn walk(&mut self) {
        self.is_extrapolated = false;
        self.free = false;
        self.step = self.stretch;
        self.iteration = 0;
        self.motion = f32::INFINITY;
    }

    /// Notes that something was held back: the next stretch is walked as well.
    pub fn backtracked(&mut self) {
        self.free = false;
    }

    /// Plans the growth to `[cells]` sizes. In the plane it walks: large parts flow far, and the correction of areas
    /// wants a settled state.
    pub fn of(dimension: Dimension, keys: usize, importance: &[f32]) -> Self {
        let (low, high) = importance.iter().fold((1.0_f32, 1.0_f32), |(l, h), &f| (l.min(f), h.max(f)));
        if dimension == Dimension::Three {
            return Self::plan(keys, low, high);
        }
        let mut growth = Self::paced(PICTURE, keys, low, high);
        growth.walk();
        growth
    }

    /// Plans the way between two sizes that differ by at most `ln_change` in the logarithm: one keyframe, at its end.
    pub fn change(dimension: Dimension, ln_change: f32) -> Self {
        let pace = match dimension {
            Dimension::Two => PICTURE,
            Dimension::Three => BODY,
        };
        let count = (ln_change / pace.ln_size).ceil().max(1.0) as usize;
        let steps = (1..=count).map(|k| k as f32 / count as f32).collect();
        Self {
            steps,
            iterations: pace.iterations,
            keys: 1,
            step: 0,
            iteration: 0,
            motion: f32::INFINITY,
            patience: SETTLING_ITERATIONS,
            range: [1.0, 1.0],
            stretch: 0,
            is_extrapolated: false,
            free: false,
        }
    }

    /// λ now.
    pub fn lambda(&self) -> f32 {
        self.steps.get(self.step).copied().unwrap_or(1.0)
    }

    /// Whether this is the first iteration at this λ.
    pub fn is_new_step(&self) -> bool {
        self.iteration == 0
    }

    /// Whether a flow comes before the next iteration, where there are flows: at each new λ, and at λ = 1 once more and
    /// after corrections that want it.
    pub fn flows(&self) -> bool {
        self.iteration == 0 || (self.at_end() && self.iteration == 1)
    }

    /// Notes an iteration and its largest motion in cells.
    pub fn iterated(&mut self, motion: f32) {
        self.iteration += 1;
        self.motion = motion;
    }

    /// Whether the state at this λ becomes a keyframe.
    pub fn is_key(&self) -> bool {
        self.is_key_step(self.step)
    }

    fn is_key_step(&self, step: usize) -> bool {
        let key = self.steps.get(step).copied().unwrap_or(1.0) * self.keys as f32;
        (key - key.round()).abs() < 1.0e-3
    }

    /// Whether the state at this λ is as good as it gets: time for a keyframe.
    pub fn settled(&self) -> bool {
        if self.step + 1 < self.steps.len() {
            let enough = if self.is_extrapolated {
                ITERATIONS_PER_EXTRAPOLATION
            } else {
                self.iterations[usize::from(self.is_key())]
            };
            self.iteration >= enough
        } else {
            let [least, most] =
                if self.is_extrapolated { EXTRAPOLATED_SETTLING } else { [LEAST_SETTLING, self.patience] };
            self.iteration >= most || (self.iteration >= least && self.motion < SETTLED_MOTION)
        }
    }

    /// Goes to the next λ.
    pub fn advance(&mut self) {
        let at_key = self.is_key();
        self.step += 1;
        self.iteration = 0;
        self.motion = f32::INFINITY;
        if at_key && !self.done() {
            self.begin_stretch();
        }
    }

    /// Whether λ = 1 is reached and not kept yet.
    pub fn at_end(&self) -> bool {
        self.step + 1 == self.steps.len()
    }

    /// Iterations at this λ so far.
    pub fn iteration(&self) -> u32 {
        self.iteration
    }

    /// Settles once more at this λ, for what is asked was changed; with a flow first, or without.
    pub fn again(&mut self, is_led: bool) {
        self.iteration = if is_led { 1 } else { 2 };
        self.motion = f32::INFINITY;
    }

    /// Settles no more: the state at λ = 1 is kept as it is.
    pub fn rest(&mut self) {
        self.iteration = self.patience;
    }

    /// Settles for less at λ = 1.
    pub fn hurry(&mut self) {
        self.patience = HURRIED_ITERATIONS;
    }

    /// Skips what is left.
    pub fn finish(&mut self) {
        self.step = self.steps.len();
    }

    /// Whether λ = 1 is settled and kept.
    pub fn done(&self) -> bool {
        self.step >= self.steps.len()
    }

    /// Share of the work done, 0..=1: settling counts as a quarter of the growth.
    pub fn fraction(&self) -> f32 {
        let last = self.steps.len().saturating_sub(1).max(1) as f32;
        let within = self.iteration as f32
            / if self.step as f32 >= last { self.patience } else { self.iterations[usize::from(self.is_key())] } as f32;
        if self.step as f32 >= last { 0.8 + 0.2 * within.min(1.0) } else { 0.8 * (self.step as f32 + within) / last }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_ascend_to_one_and_hold_every_key() {
        for (keys, low, high) in [(8, 0.5, 3.0), (3, 0.05, 20.0), (64, 1.0, 1.0), (1, 1.0, 1.0)] {
            let growth = Growth::plan(keys, low, high);
            assert!(growth.steps.windows(2).all(|w| w[0] < w[1]), "{:?}", growth.steps);
            assert_eq!(growth.steps.last(), Some(&1.0));
            for k in 1..=keys {
                let lambda = k as f32 / keys as f32;
                assert!(growth.steps.iter().any(|s| (s - lambda).abs() < 1e-4), "{keys} {lambda}");
            }
            let mut before = 0.0_f32;
            for &s in &growth.steps {
                for f in [low, high] {
                    let ln = |l: f32| (1.0 + l * (f - 1.0)).ln();
                    assert!((ln(s) - ln(before)).abs() < 1.3 * LN_SIZE_PER_STEP, "{f} {before} {s}");
                }
                before = s;
            }
        }
    }
}
