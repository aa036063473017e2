//! The film: certified states at λ_0 = 0 < … < λ_K = 1.
//!
//! Playback, scrubbing, recording and export read the film and never solve again. Between two keyframes a state is their
//! linear blend, which need not be injective because both ends are: blends are checked as well, and where one fails the
//! film keeps more of what was solved between.

pub mod plugin;

use glam::Vec3A;
use rayon::prelude::*;

use crate::{
    certificate::{Certificate, certify},
    collision::{Shell, Watch, guard::guard},
    edge::CHUNK,
    voxel::Complex,
};

/// One certified state.
#[derive(Debug, Clone)]
pub struct Keyframe {
    /// λ, 0 = rest, 1 = all of the growth.
    pub lambda: f32,
    /// V'' at λ, in cells.
    pub positions: Vec<Vec3A>,
    /// What the check found.
    pub certificate: Certificate,
}

/// Keyframes by ascending λ; the first is the rest state.
#[derive(Debug, Clone, Default)]
pub struct Film {
    keyframes: Vec<Keyframe>,
}

/// Blends that are checked between two chosen keyframes; half-way is checked when a keyframe is made.
const BLENDS: [f32; 2] = [0.3, 0.7];

/// Intervals of λ are not halved below this: less than a frame of any recording.
const SHORTEST_STEP: f32 = 5.0e-4;

impl Film {
    /// Adds the next keyframe; its λ must be above the last one's, or equal, which replaces it.
    pub fn push(&mut self, keyframe: Keyframe) {
        if self.keyframes.last().is_some_and(|last| last.lambda >= keyframe.lambda) {
            self.keyframes.pop();
        }
        self.keyframes.push(keyframe);
    }

    /// All keyframes.
    pub fn keyframes(&self) -> &[Keyframe] {
        &self.keyframes
    }

    /// The state at λ, blended from its two neighbours.
    pub fn at(&self, lambda: f32) -> Vec<Vec3A> {
        let after = self.keyframes.partition_point(|k| k.lambda < lambda);
        match (after.checked_sub(1).and_then(|k| self.keyframes.get(k)), self.keyframes.get(after)) {
            (Some(a), Some(b)) => blend(&a.positions, &b.positions, (lambda - a.lambda) / (b.lambda - a.lambda)),
            (Some(k), None) | (None, Some(k)) => k.positions.clone(),
            (None, None) => Vec::new(),
        }
    }

    /// Chooses about `keys` keyframes after the rest state, evenly in λ, and more wherever a blend of two chosen ones
    /// fails the check: ones the film holds between them, else new ones, made by [`between`]. Returns their indices,
    /// first and last included, and the certificates of blends that could not be mended.
    pub fn select(
        &mut self,
        keys: usize,
        complex: &Complex,
        shells: &mut [Shell],
        size: &[f32],
    ) -> (Vec<usize>, Vec<(f32, Certificate)>) {
        let Some(last) = self.keyframes.len().checked_sub(1) else { return (Vec::new(), Vec::new()) };
        let mut chosen: Vec<usize> = (0..=keys)
            .map(|k| {
                let lambda = k as f32 / keys.max(1) as f32;
                self.keyframes.partition_point(|f| f.lambda < lambda - 1.0e-4).min(last)
            })
            .collect();
        chosen.dedup();
        let mut failed = Vec::new();
        let mut k = 0;
        while k + 1 < chosen.len() {
            let (a, b) = (chosen[k], chosen[k + 1]);
            let Some(bad) = self.bad_blend(a, b, complex, shells) else {
                k += 1;
                continue;
            };
            if b - a > 1 {
                chosen.insert(k + 1, usize::midpoint(a, b));
                continue;
            }
            let (from, to) = (&self.keyframes[a], &self.keyframes[b]);
            let sound = from.certificate.certified() && to.certificate.certified();
            if !sound || to.lambda - from.lambda < SHORTEST_STEP {
                failed.push(bad);
                k += 1;
                continue;
            }
            let keyframe = between(complex, shells, size, from, to);
            self.keyframes.insert(b, keyframe);
            for later in &mut chosen[k + 1..] {
                *later += 1;
            }
            chosen.insert(k + 1, b);
        }
        (chosen, failed)
    }

    fn bad_blend(&self, a: usize, b: usize, complex: &Complex, shells: &mut [Shell]) -> Option<(f32, Certificate)> {
        let (a, b) = (&self.keyframes[a], &self.keyframes[b]);
        BLENDS.iter().find_map(|&t| {
            let certificate = certify(complex, shells, &blend(&a.positions, &b.positions, t));
            (!certificate.certified()).then_some((a.lambda + t * (b.lambda - a.lambda), certificate))
        })
    }
}

/// A keyframe half-way between two, guarded from the first of them.
pub fn between(complex: &Complex, shells: &mut [Shell], size: &[f32], a: &Keyframe, b: &Keyframe) -> Keyframe {
    let mut positions = blend(&a.positions, &b.positions, 0.5);
    guard(complex, shells, size, &a.positions, &mut positions, Watch::Way, &mut Vec::new());
    let certificate = certify(complex, shells, &positions);
    Keyframe { lambda: 0.5 * (a.lambda + b.lambda), positions, certificate }
}

/// `(1 − t) a + t b`.
pub fn blend(a: &[Vec3A], b: &[Vec3A], t: f32) -> Vec<Vec3A> {
    a.par_iter().zip(b).with_min_len(CHUNK).map(|(a, b)| *a + t * (*b - *a)).collect()
}
