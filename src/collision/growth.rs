//! Growth: which λ comes next, and when a state counts as settled.

/// λ grows by at most this many steps' worth of relative size change: `ln` of the largest factor per step. Above about
/// 0.2 steps fold cells that the guard must then hold; smaller only costs time.
const LN_SIZE_PER_STEP: f32 = 0.12;

/// Steps of λ at the least: the film's own keyframes.
pub const LEAST_STEPS: usize = 20;

/// Iterations at each λ below 1: on the way, and where the state becomes a keyframe.
const ITERATIONS_PER_STEP: [u32; 2] = [2, 4];

/// Iterations at λ = 1 at most.
const SETTLING_ITERATIONS: u32 = 80;

/// The same where the boundary is guarded in every iteration: each costs several times as much there, and what is held
/// does not come to rest.
const HURRIED_ITERATIONS: u32 = 40;

/// Iterations at λ = 1 at least.
const LEAST_SETTLING: u32 = 8;

/// At λ = 1 the state is settled when no node moves further than this in an iteration, in cells.
const SETTLED_MOTION: f32 = 0.02;

/// Where the growth is.
#[derive(Debug, Clone)]
pub struct Growth {
    /// λ of each step, ascending, the last 1.
    steps: Vec<f32>,
    /// λ of keyframes are multiples of 1 / keys.
    keys: usize,
    step: usize,
    iteration: u32,
    motion: f32,
    patience: u32,
}

impl Growth {
    /// Plans the steps for importance in `low..=high`: at least `keys` equal ones, cut where sizes change fast.
    pub fn plan(keys: usize, low: f32, high: f32) -> Self {
        let count = LEAST_STEPS.div_ceil(keys.max(1)) * keys.max(1);
        let ln_size = |lambda: f32, f: f32| (1.0 + lambda * (f - 1.0)).ln();
        let mut steps = Vec::new();
        for k in 0..count {
            let (a, b) = (k as f32 / count as f32, (k + 1) as f32 / count as f32);
            let change = [low, high].map(|f| (ln_size(b, f) - ln_size(a, f)).abs());
            let cuts = (change[0].max(change[1]) / LN_SIZE_PER_STEP).ceil().max(1.0);
            // Cuts equal in ln of the faster size, so that none of them takes the whole change.
            let f = if change[0] > change[1] { low } else { high };
            for cut in 1..cuts as usize {
                let ln = ln_size(a, f) + (ln_size(b, f) - ln_size(a, f)) * cut as f32 / cuts;
                steps.push((ln.exp() - 1.0) / (f - 1.0));
            }
            steps.push(b);
        }
        Self { steps, keys: keys.max(1), step: 0, iteration: 0, motion: f32::INFINITY, patience: SETTLING_ITERATIONS }
    }

    /// Plans the growth to `[cells]` sizes.
    pub fn of(keys: usize, importance: &[f32]) -> Self {
        let (low, high) = importance.iter().fold((1.0_f32, 1.0_f32), |(l, h), &f| (l.min(f), h.max(f)));
        Self::plan(keys, low, high)
    }

    /// Plans the way between two sizes that differ by at most `ln_change` in the logarithm: one keyframe, at its end.
    pub fn change(ln_change: f32) -> Self {
        let count = (ln_change / LN_SIZE_PER_STEP).ceil().max(1.0) as usize;
        let steps = (1..=count).map(|k| k as f32 / count as f32).collect();
        Self { steps, keys: 1, step: 0, iteration: 0, motion: f32::INFINITY, patience: SETTLING_ITERATIONS }
    }

    /// λ now.
    pub fn lambda(&self) -> f32 {
        self.steps.get(self.step).copied().unwrap_or(1.0)
    }

    /// Whether this is the first iteration at this λ.
    pub fn is_new_step(&self) -> bool {
        self.iteration == 0
    }

    /// Notes an iteration and its largest motion in cells.
    pub fn iterated(&mut self, motion: f32) {
        self.iteration += 1;
        self.motion = motion;
    }

    /// Whether the state at this λ becomes a keyframe.
    pub fn is_key(&self) -> bool {
        let key = self.lambda() * self.keys as f32;
        (key - key.round()).abs() < 1.0e-3
    }

    /// Whether the state at this λ is as good as it gets: time for a keyframe.
    pub fn settled(&self) -> bool {
        if self.step + 1 < self.steps.len() {
            self.iteration >= ITERATIONS_PER_STEP[usize::from(self.is_key())]
        } else {
            self.iteration >= self.patience || (self.iteration >= LEAST_SETTLING && self.motion < SETTLED_MOTION)
        }
    }

    /// Goes to the next λ.
    pub fn advance(&mut self) {
        self.step += 1;
        self.iteration = 0;
        self.motion = f32::INFINITY;
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
            / if self.step as f32 >= last { self.patience } else { ITERATIONS_PER_STEP[1] } as f32;
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
