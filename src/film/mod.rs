//! The film: certified states at λ_0 = 0 < … < λ_K = 1.
//!
//! Playback, scrubbing, recording and export read the film and never solve again. Between two keyframes a state is
//! their linear blend, which need not be injective because both ends are. So the motion from one to the next is proven
//! to be valid at every instant, and where that fails the film keeps more of what was solved between, or draws the
//! later one back. Since the first keyframe is the rest state, every state of the film hangs together with it by proven
//! motions.

pub mod plugin;

use glam::{Vec2, Vec3A};

use crate::{
    certificate::{CarriedState, Certificate, Checked, Surfaces, certify, certify_motion},
    collision::{Extent, Trail, guard::guard},
    voxel::{Complex, Dimension, blend},
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
    /// Whether the blends from the keyframe before to this one are proven to be valid, at every instant.
    pub motion_is_proven: bool,
}

/// Keyframes by ascending λ; the first is the rest state.
#[derive(Debug, Clone, Default)]
pub struct Film {
    keyframes: Vec<Keyframe>,
    /// λ and flat positions of states that the growth passed between keyframes where the motion is not proven,
    /// ascending.
    passed: Vec<(f32, Vec<Vec2>)>,
    /// Vertices that follow the states otherwise than when the keyframes were certified.
    stale: Vec<u32>,
}

/// Between keyframes nearer in λ than this no other is put.
const SHORTEST_STEP: f32 = 0.03;

/// The same in the plane, where what was passed lies near to each other: as a part of the distance of the keyframes
/// that were asked for.
const SHORTEST_FLAT_STEP: f32 = 0.008;

impl Film {
    /// Adds the next keyframe; its λ must be above the last one's, or equal, which replaces it.
    pub fn push(&mut self, keyframe: Keyframe) {
        self.push_after(keyframe, &mut Trail::default());
    }

    /// The same, with the flat states that were passed on the way to it, of which none are left.
    pub fn push_after(&mut self, mut keyframe: Keyframe, trail: &mut Trail) {
        if self.keyframes.last().is_some_and(|last| last.lambda >= keyframe.lambda) {
            self.keyframes.pop();
            // It was the motion from the one that is replaced.
            keyframe.motion_is_proven = false;
            let last = self.keyframes.last().map_or(0.0, |last| last.lambda);
            self.passed.retain(|(lambda, _)| *lambda < last);
        }
        let passed = trail.take_up_to(&keyframe.positions);
        if let (Some(last), false) = (self.keyframes.last(), keyframe.motion_is_proven) {
            let step = (keyframe.lambda - last.lambda) / (passed.len() + 1) as f32;
            let lambda = |k: usize| last.lambda + step * (k + 1) as f32;
            self.passed.extend(passed.into_iter().enumerate().map(|(k, positions)| (lambda(k), positions)));
        }
        self.keyframes.push(keyframe);
    }

    /// Makes flat surfaces follow the complex during the straight motion between two states, where they must; whether
    /// that changed any.
    fn straighten(&mut self, surfaces: &mut Surfaces, motion: [&[Vec3A]; 2]) -> bool {
        let before = self.stale.len();
        self.stale.extend(surfaces.straighten(motion));
        self.stale.len() > before
    }

    /// The middle one of the states that were passed between two λ, if there are any.
    fn take_passed(&mut self, from: f32, to: f32) -> Option<(f32, Vec<Vec3A>)> {
        let first = self.passed.partition_point(|(lambda, _)| *lambda <= from);
        let end = self.passed.partition_point(|(lambda, _)| *lambda < to);
        let (lambda, flat) = (first < end).then(|| self.passed.remove(first.midpoint(end)))?;
        Some((lambda, flat.into_iter().map(|p| p.extend(0.0).to_vec3a()).collect()))
    }

    /// All keyframes.
    pub fn keyframes(&self) -> &[Keyframe] {
        &self.keyframes
    }

    /// Makes every blend of two neighbouring keyframes valid, as [`certify_motion`] has it. A flat surface that alone
    /// prevents it follows the complex. Else there are new keyframes between, the states that were passed there first,
    /// and where that does not help, the later one is drawn back to what can be reached from the earlier.
    pub fn mend(&mut self, complex: &Complex, surfaces: &mut Surfaces, size: &[f32]) {
        let shortest = match complex.dimension {
            Dimension::Two => SHORTEST_FLAT_STEP / self.keyframes.len().saturating_sub(1).max(1) as f32,
            Dimension::Three => SHORTEST_STEP,
        };
        let mut k = 1_usize;
        loop {
            if self.certify_again(complex, surfaces) {
                k = 1;
            }
            let [from, to] = match self.keyframes.get(k.saturating_sub(1)..=k) {
                Some([from, to]) => [from, to],
                _ => break,
            };
            if !from.certificate.certified() || to.motion_is_proven {
                k += 1;
                continue;
            }
            if is_proven(complex, &*surfaces, from, to) {
                self.keyframes[k].motion_is_proven = true;
                k += 1;
                continue;
            }
            let [a, b] = [from.lambda, to.lambda];
            if complex.dimension == Dimension::Two && is_proven(complex, surfaces.skin_alone(), from, to) {
                let motion = [from.positions.clone(), to.positions.clone()];
                if self.straighten(surfaces, [&motion[0], &motion[1]]) {
                    continue;
                }
            }
            if let Some((lambda, positions)) = self.take_passed(a, b) {
                let mut certificate = certify(complex, &*surfaces, &positions);
                while !certificate.certified() && self.straighten(surfaces, [&positions, &positions]) {
                    certificate = certify(complex, &*surfaces, &positions);
                }
                if certificate.certified() {
                    self.keyframes.insert(k, Keyframe { lambda, positions, certificate, motion_is_proven: false });
                }
                continue;
            }
            let (from, to) = (&self.keyframes[k - 1], &self.keyframes[k]);
            if b - a > shortest {
                let keyframe = between(complex, surfaces, size, from, to);
                self.keyframes.insert(k, keyframe);
            } else {
                self.keyframes[k] = reached(complex, surfaces, size, from, b, to.positions.clone());
                if let Some(next) = self.keyframes.get_mut(k + 1) {
                    // It was the motion from where this one was.
                    next.motion_is_proven = false;
                }
                k += 1;
            }
        }
        self.passed = Vec::new();
    }

    /// Certifies anew what stale vertices have changed: what is proven to be sound where they are stays certified.
    /// Whether there were any.
    fn certify_again(&mut self, complex: &Complex, surfaces: &Surfaces) -> bool {
        let stale = std::mem::take(&mut self.stale);
        let Some(&last) = stale.iter().max() else { return false };
        let vertices = surfaces.binding().map(|binding| binding.nodes.len());
        let mut changed = vec![false; vertices.unwrap_or(0).max(last as usize + 1)];
        for vertex in stale {
            changed[vertex as usize] = true;
        }
        let stays_sound = |motion: [&[Vec3A]; 2]| {
            surfaces.written.as_ref().is_none_or(|written| written.stays_sound(&changed, motion))
        };
        for k in 0..self.keyframes.len() {
            let positions = &self.keyframes[k].positions;
            let motion_is_proven = self.keyframes[k].motion_is_proven
                && (k == 0 || stays_sound([&self.keyframes[k - 1].positions, positions]));
            // A motion that is proven ends in a state that is certified.
            let stays =
                motion_is_proven || self.keyframes[k].certificate.certified() && stays_sound([positions, positions]);
            if !stays {
                self.keyframes[k].certificate = certify(complex, surfaces, positions);
            }
            self.keyframes[k].motion_is_proven = motion_is_proven;
        }
        true
    }
}

/// Whether every blend of two keyframes is proven to be valid.
fn is_proven<'a>(complex: &Complex, surfaces: impl Into<Checked<'a>>, from: &Keyframe, to: &Keyframe) -> bool {
    let surfaces = surfaces.into();
    let [from, to] = [from, to].map(|keyframe| CarriedState::new(surfaces, keyframe.positions.clone()));
    certify_motion(complex, surfaces, &from, &to).1
}

/// A keyframe half-way between two, guarded from the first of them.
pub fn between(complex: &Complex, surfaces: &Surfaces, size: &[f32], a: &Keyframe, b: &Keyframe) -> Keyframe {
    reached(complex, surfaces, size, a, 0.5 * (a.lambda + b.lambda), blend(&a.positions, &b.positions, 0.5))
}

/// The keyframe at λ that can be reached from another on the way to `positions`.
fn reached(
    complex: &Complex,
    surfaces: &Surfaces,
    size: &[f32],
    from: &Keyframe,
    lambda: f32,
    mut positions: Vec<Vec3A>,
) -> Keyframe {
    guard(complex, surfaces, size, &from.positions, &mut positions, Extent::Motion, &mut Vec::new());
    let certificate = certify(complex, surfaces, &positions);
    Keyframe { lambda, positions, certificate, motion_is_proven: false }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::voxel::Grid;
    use glam::{DVec3, UVec3};

    /// Two squares change places: straight there, each would go through the other; `passes`: one goes above.
    fn mended(passes: bool) -> (Complex, Film, Vec<Vec3A>) {
        let grid = Grid { origin: DVec3::ZERO, cell_size: 1.0, cells: UVec3::new(7, 2, 1) };
        let inside: Vec<bool> = (0..14).map(|k| !(2..5).contains(&(k % 7))).collect();
        let complex = Complex::from_flat_cells(grid, &inside);
        let mut surfaces = Surfaces::skin_of(&complex);
        let moved = |by: Vec3A| -> Vec<Vec3A> {
            complex.rest.iter().map(|p| if p.x < 3.0 { *p + by } else { *p - by }).collect()
        };
        let last = moved(Vec3A::new(5.0, 0.0, 0.0));
        let mut film = Film::default();
        let keyframe = |lambda: f32, positions: Vec<Vec3A>, motion_is_proven: bool| Keyframe {
            lambda,
            certificate: certify(&complex, &surfaces, &positions),
            positions,
            motion_is_proven,
        };
        film.push(keyframe(0.0, complex.rest.clone(), true));
        let mut trail = Trail::default();
        if passes {
            trail.pass(&moved(Vec3A::new(2.5, 3.0, 0.0)));
        }
        film.push_after(keyframe(0.5, last.clone(), false), &mut trail);
        // A motion that is proven only as long as the keyframe before stays where it is.
        film.push(keyframe(1.0, last.clone(), true));
        film.mend(&complex, &mut surfaces, &vec![1.0; complex.cells.len()]);
        for pair in film.keyframes().windows(2) {
            assert!(pair[0].lambda < pair[1].lambda && pair[1].certificate.certified());
            assert!(is_proven(&complex, &surfaces, &pair[0], &pair[1]));
        }
        (complex, film, last)
    }

    #[test]
    fn motions_go_by_what_was_passed() {
        let (complex, film, last) = mended(true);
        assert_eq!(complex.bodies, 2);
        assert_eq!(film.keyframes().len(), 4);
        assert!(film.keyframes().iter().filter(|k| k.lambda >= 0.5).all(|k| k.positions == last));
    }

    #[test]
    fn sabotage_without_it_the_end_is_drawn_back_and_so_is_what_follows() {
        let (_, film, last) = mended(false);
        assert!(film.keyframes().iter().all(|k| k.positions != last));
    }
}
