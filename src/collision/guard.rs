//! Guard: a step is taken only where it stays injective.
//!
//! The present state is valid. Elements that the proposed step would invert (or flatten further below a small part of
//! their target volume) and boundary triangles that it would make cross mark their nodes; those nodes and a ring around
//! them take half the step, again and again, down to no step at all, which is valid because the present state is.

use std::borrow::Cow;

use glam::Vec3A;
use rayon::prelude::*;

use crate::{
    certificate::{BySurface, Checked, VOLUME_ROUNDING, cell_stays_positive, enclosed_solids, is_positive},
    voxel::{CHUNK, Complex, Dimension, blend},
};

/// Elements may not shrink further once below this part of their target volume. Zero would let slivers through that the
/// next step cannot leave; above about 0.1 hard cases lock too early.
pub(crate) const VOLUME_FLOOR: f32 = 0.05;

/// A node's step is halved at most this often; after that it stays where it is.
const MOST_BACKTRACKING: u8 = 3;

/// Rounds of backtracking before the whole step is shortened instead: where it spreads from ring to ring, a shorter
/// smooth step folds less than a long one with a frozen patch in it.
const MOST_ROUNDS: u32 = 24;

/// Parts of the whole step that are tried; after the last the state stays as it is, which is valid.
const WHOLE_STEPS: [f32; 3] = [1.0, 0.25, 0.0625];

/// Cells per parallel task.
const CELLS_PER_TASK: usize = 512;

/// What the guard had to do in one step.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Guarded {
    /// Nodes that took less than the whole step.
    pub backtracked: u32,
    /// Rounds of backtracking.
    pub rounds: u32,
}

/// Of what of a step it has to be valid. In the plane, where steps are long, the skin is proven to stay apart at every
/// instant in either case.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extent {
    /// At its end: enough for the skin, whose cells are thicker than a step is long.
    End,
    /// Proven at every instant: for sheets of the boundary, which may lie nearer to each other than a step is long and
    /// must not change places unseen, and for keyframes, whose blends are shown.
    Motion,
}

/// Makes `proposed` valid by drawing nodes back towards `current`. `size` is `[cells]`, the size asked for now.
///
/// `backtracking` is `[nodes]` how often each node's step was halved, or empty: what had to be drawn back in the last
/// step starts a little freer in this one, instead of all over again.
pub fn guard<'a>(
    complex: &Complex,
    surfaces: impl Into<Checked<'a>>,
    size: &[f32],
    current: &[Vec3A],
    proposed: &mut [Vec3A],
    extent: Extent,
    backtracking: &mut Vec<u8>,
) -> Guarded {
    let surfaces = surfaces.into();
    let near = surfaces.each(|shell| shell.near_pairs(current, proposed));
    let full: Vec<Vec3A> = proposed.to_vec();
    let mut guarded = Guarded::default();
    backtracking.resize(complex.nodes(), 0);
    for count in backtracking.iter_mut() {
        *count = count.saturating_sub(1);
    }
    let step = Step { complex, surfaces, near: &near, size, current, extent };
    for whole in WHOLE_STEPS {
        let target =
            if whole < 1.0 { Cow::Owned(blend(current, &full, whole)) } else { Cow::Borrowed(full.as_slice()) };
        if step.backtrack(&target, proposed, backtracking, &mut guarded.rounds) {
            guarded.backtracked = backtracking.iter().filter(|&&h| h > 0).count() as u32;
            return guarded;
        }
    }
    proposed.copy_from_slice(current);
    guarded.backtracked = complex.nodes() as u32;
    guarded
}

/// A step to be made valid.
struct Step<'a> {
    complex: &'a Complex,
    surfaces: Checked<'a>,
    near: &'a BySurface<Vec<(u32, u32)>>,
    size: &'a [f32],
    current: &'a [Vec3A],
    extent: Extent,
}

impl Step<'_> {
    /// Where a node goes whose step was halved so often.
    fn backtracked_to(&self, i: usize, full: &[Vec3A], backtracking: u8) -> Vec3A {
        match backtracking {
            0 => full[i],
            h if h > MOST_BACKTRACKING => self.current[i],
            h => self.current[i] + 0.5_f32.powi(i32::from(h)) * (full[i] - self.current[i]),
        }
    }

    /// Draws nodes back until the step is valid; false if that takes too many rounds.
    fn backtrack(&self, full: &[Vec3A], proposed: &mut [Vec3A], backtracking: &mut [u8], rounds: &mut u32) -> bool {
        for (i, p) in proposed.iter_mut().enumerate() {
            *p = self.backtracked_to(i, full, backtracking[i]);
        }
        let mut moved: Option<Vec<bool>> = None;
        for _ in 0..MOST_ROUNDS {
            let marked = self.faults(proposed, moved.as_deref());
            if marked.is_empty() {
                return true;
            }
            *rounds += 1;
            let mut changed = vec![false; self.complex.nodes()];
            for i in marked {
                changed[i as usize] = true;
                for &j in &self.complex.neighbours[i as usize] {
                    changed[j as usize] = true;
                }
            }
            for i in (0..changed.len()).filter(|&i| changed[i]) {
                backtracking[i] = backtracking[i].saturating_add(1).min(MOST_BACKTRACKING + 1);
                proposed[i] = self.backtracked_to(i, full, backtracking[i]);
            }
            moved = Some(changed);
        }
        false
    }

    /// Nodes of solids inside others: a small one may be there after one step without having been seen to cross a skin.
    fn enclosed(&self, state: &[Vec3A]) -> Vec<u32> {
        let enclosed = enclosed_solids(self.complex, state);
        if enclosed.is_empty() {
            return Vec::new();
        }
        let cells = self.complex.corners.iter().zip(&self.complex.solid);
        cells.filter(|(_, solid)| enclosed.contains(solid)).flat_map(|(corners, _)| *corners).collect()
    }

    /// Nodes of what the step would break, of what has a node in `moved` if given. Of a motion what is not proven
    /// counts as broken; what keeps apart throughout does not come to lie within another either.
    fn faults(&self, proposed: &[Vec3A], moved: Option<&[bool]>) -> Vec<u32> {
        let mut marked = bad_cells(self.complex, self.size, self.current, proposed, moved);
        let surfaces = self.surfaces.iter().zip(self.near.iter());
        if self.extent == Extent::End && self.complex.dimension == Dimension::Three {
            marked.extend(self.enclosed(proposed));
            for (shell, near) in surfaces {
                shell.mark_crossings(near, proposed, moved, &mut marked);
            }
            return marked;
        }
        if self.extent == Extent::Motion {
            let stays_positive = cell_stays_positive(self.complex.dimension);
            let is_unproven = |corners: &&[u32; 8]| {
                moved.is_none_or(|moved| corners.iter().any(|&c| moved[c as usize]))
                    && !stays_positive([self.current, proposed].map(|p| corners.map(|c| p[c as usize])))
            };
            let cells = self.complex.corners.par_iter().with_min_len(CELLS_PER_TASK);
            marked.extend(cells.filter(is_unproven).flatten_iter().collect::<Vec<_>>());
        }
        for (shell, near) in surfaces {
            shell.mark_unproven(near, [self.current, proposed], moved, &mut marked);
        }
        marked
    }
}

/// Nodes of elements that the step would break, cell by cell. A volume above the floor counts only where it is also
/// above what rounding can make of a volume that is not positive: elements that are long beside the size asked for are
/// told exactly.
fn bad_cells(
    complex: &Complex,
    size: &[f32],
    current: &[Vec3A],
    proposed: &[Vec3A],
    moved: Option<&[bool]>,
) -> Vec<u32> {
    bad_cells_with(VOLUME_ROUNDING, complex, size, current, proposed, moved)
}

/// As [`bad_cells`], with a rounding bound.
#[inline(always)]
fn bad_cells_with(
    rounding: f32,
    complex: &Complex,
    size: &[f32],
    current: &[Vec3A],
    proposed: &[Vec3A],
    moved: Option<&[bool]>,
) -> Vec<u32> {
    let dimension = complex.dimension;
    complex
        .corners
        .par_chunks(CELLS_PER_TASK)
        .enumerate()
        .flat_map_iter(|(chunk, cells)| {
            let mut bad = Vec::new();
            for (k, corners) in cells.iter().enumerate() {
                if moved.is_some_and(|m| !corners.iter().any(|&c| m[c as usize])) {
                    continue;
                }
                let floor = VOLUME_FLOOR * dimension.measure(size[chunk * CELLS_PER_TASK + k]);
                let at = corners.map(|c| proposed[c as usize]);
                // All elements start at corner 0.
                let largest = at.iter().fold(Vec3A::ZERO, |m, p| m.max((*p - at[0]).abs())).max_element();
                let bound = rounding * dimension.measure(largest);
                for element in dimension.elements() {
                    let volume = determinant(dimension, element.map(|c| at[c]));
                    if volume > floor.max(bound) {
                        continue;
                    }
                    let nodes = element.map(|c| corners[c]);
                    let positive = is_positive(dimension, element.map(|c| at[c].as_dvec3()));
                    let before = determinant(dimension, nodes.map(|c| current[c as usize]));
                    if !positive || (volume <= floor && volume < before) {
                        bad.extend(nodes);
                    }
                }
            }
            bad
        })
        .collect()
}

/// `det[b − a, c − a, d − a]` in f32: six times the volume; in the plane `det[b − a, c − a]`, twice the area.
#[inline]
pub(crate) fn determinant(dimension: Dimension, [a, b, c, d]: [Vec3A; 4]) -> f32 {
    let (u, v) = (b - a, c - a);
    match dimension {
        Dimension::Two => u.x * v.y - u.y * v.x,
        Dimension::Three => u.dot(v.cross(d - a)),
    }
}

/// Shortens steps longer than `most`, per node, in cells.
pub fn limit(current: &[Vec3A], proposed: &mut [Vec3A], most: impl Fn(usize) -> f32 + Sync) {
    proposed.par_iter_mut().zip(current).enumerate().with_min_len(CHUNK).for_each(|(i, (p, x))| {
        let step = *p - *x;
        let (length, most) = (step.length(), most(i));
        if length > most {
            *p = *x + step * (most / length);
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{certificate::exact, voxel::Grid};
    use glam::{DVec3, UVec3};

    /// How many elements of long flat cells, for which small sizes are asked, are let through though they are not
    /// positive.
    fn let_through(rounding: f32) -> usize {
        let grid = Grid { origin: DVec3::ZERO, cell_size: 1.0, cells: UVec3::ONE };
        let complex = Complex::from_cells(grid, &[true]);
        let mut state = 1_u64;
        let mut number = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f32 / (1 << 23) as f32 - 1.0
        };
        let mut missed = 0;
        for _ in 0..4000 {
            let [u, v] = [0; 2].map(|_| 3.0 * Vec3A::new(number(), number(), number()));
            // All nodes in one plane, but for what the last places of their coordinates make of it.
            let proposed: Vec<Vec3A> = complex.rest.iter().map(|_| number() * u + number() * v).collect();
            let bad = bad_cells_with(rounding, &complex, &[0.02], &complex.rest, &proposed, None);
            for element in (0..complex.elements()).map(|t| complex.element(t)) {
                let places = element.map(|node| exact::place([proposed[node as usize]; 2], 0));
                missed += usize::from(exact::orientation(places) <= 0 && !bad.chunks(4).any(|b| b == element));
            }
        }
        missed
    }

    #[test]
    fn elements_that_are_long_beside_their_size_are_told_exactly() {
        assert_eq!(let_through(VOLUME_ROUNDING), 0);
    }

    /// Until this was a test, the floor of volumes was taken to be above all rounding.
    #[test]
    fn sabotage_without_a_bound_inverted_elements_are_let_through() {
        assert!(let_through(0.0) > 0);
    }
}
