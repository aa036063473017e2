//! The film: certified states at λ_0 = 0 < … < λ_K = 1.
//!
//! Playback, scrubbing, recording and export read the film and never solve again. Between two keyframes a state is their
//! linear blend, which need not be injective because both ends are: blends are checked as well, and where one fails the
//! film keeps more of what was solved between.

pub mod plugin;

use glam::{DVec2, Vec3A};
use rayon::prelude::*;

use crate::{
    certificate::{Certificate, certify, certify_way},
    collision::{Placed, Shell, Watch, guard::guard},
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
    /// Whether the blends from the keyframe before to this one are known to be valid.
    pub way_is_clear: bool,
}

/// Keyframes by ascending λ; the first is the rest state.
#[derive(Debug, Clone, Default)]
pub struct Film {
    keyframes: Vec<Keyframe>,
}

/// Between keyframes nearer in λ than this no other is put.
const SHORTEST_STEP: f32 = 0.03;

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

    /// Makes every blend of two neighbouring keyframes valid where it is looked at ([`Watch::Way`]): by new keyframes
    /// between them, and where that does not help, by drawing the later one back to what can be reached from the earlier.
    pub fn mend(&mut self, complex: &Complex, shells: &mut [Shell], size: &[f32]) {
        self.straighten(complex, shells);
        let mut k = 1;
        while k < self.keyframes.len() {
            let (from, to) = (&self.keyframes[k - 1], &self.keyframes[k]);
            if !from.certificate.certified() || to.way_is_clear {
                k += 1;
            } else if is_clear(complex, shells, from, to) {
                self.keyframes[k].way_is_clear = true;
                k += 1;
            } else if to.lambda - from.lambda > SHORTEST_STEP {
                let keyframe = between(complex, shells, size, from, to);
                self.keyframes[k].way_is_clear = false;
                self.keyframes.insert(k, keyframe);
            } else {
                self.keyframes[k] = reached(complex, shells, size, from, to.lambda, to.positions.clone());
                k += 1;
            }
        }
    }
}

impl Film {
    /// Makes a flat surface follow the complex where it must in any keyframe or blend that is looked at, and certifies all
    /// keyframes anew where that changed them.
    fn straighten(&mut self, complex: &Complex, shells: &mut [Shell]) {
        let mut changed = false;
        let mut again = true;
        while again {
            again = false;
            for k in 0..self.keyframes.len() {
                let at = &self.keyframes[k].positions;
                again |= straighten(shells, at);
                let Some(next) = self.keyframes.get(k + 1) else { continue };
                for part in (1..8).map(|k| k as f32 / 8.0) {
                    let state = blend(at, &next.positions, part);
                    again |= straighten(shells, &state);
                }
            }
            changed |= again;
        }
        if changed {
            for keyframe in &mut self.keyframes {
                keyframe.certificate = certify(complex, shells, &keyframe.positions);
                keyframe.way_is_clear = false;
            }
        }
    }
}

/// Whether every blend of two keyframes is valid.
fn is_clear(complex: &Complex, shells: &[Shell], from: &Keyframe, to: &Keyframe) -> bool {
    let [from, to] = [from, to].map(|keyframe| Placed::new(shells, keyframe.positions.clone()));
    certify_way(complex, shells, &from, &to).1
}

/// Straightens what flat surfaces need in a state; whether that changed any.
fn straighten(shells: &mut [Shell], positions: &[Vec3A]) -> bool {
    shells.iter_mut().map(|shell| shell.straighten(positions)).filter(|&changed| changed).count() > 0
}

/// A keyframe half-way between two, guarded from the first of them.
pub fn between(complex: &Complex, shells: &mut [Shell], size: &[f32], a: &Keyframe, b: &Keyframe) -> Keyframe {
    reached(complex, shells, size, a, 0.5 * (a.lambda + b.lambda), blend(&a.positions, &b.positions, 0.5))
}

/// The keyframe at λ that can be reached from another on the way to `positions`.
fn reached(
    complex: &Complex,
    shells: &mut [Shell],
    size: &[f32],
    from: &Keyframe,
    lambda: f32,
    mut positions: Vec<Vec3A>,
) -> Keyframe {
    guard(complex, shells, size, &from.positions, &mut positions, Watch::Way, &mut Vec::new());
    let certificate = certify(complex, shells, &positions);
    Keyframe { lambda, positions, certificate, way_is_clear: false }
}

/// `(1 − t) a + t b` of places in the plane.
pub fn blend_places(a: &[DVec2], b: &[DVec2], t: f64) -> Vec<DVec2> {
    a.par_iter().zip(b).with_min_len(CHUNK).map(|(a, b)| a.lerp(*b, t)).collect()
}

/// `(1 − t) a + t b`.
pub fn blend(a: &[Vec3A], b: &[Vec3A], t: f32) -> Vec<Vec3A> {
    a.par_iter().zip(b).with_min_len(CHUNK).map(|(a, b)| *a + t * (*b - *a)).collect()
}
