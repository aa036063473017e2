//! Guard: a step is taken only where it stays injective.
//!
//! The present state is valid. Elements that the proposed step would invert (or flatten further below a small part of
//! their target volume) and boundary triangles that it would make cross mark their nodes; those nodes and a ring around
//! them take half the step, again and again, down to no step at all, which is valid because the present state is.

use glam::Vec3A;
use rayon::prelude::*;

use crate::{
    certificate::{Surface, orientation},
    edge::CHUNK,
    voxel::{Complex, KUHN},
};

/// Elements may not shrink further once below this part of their target volume. Zero would let slivers through that the
/// next step cannot leave; above about 0.1 hard cases lock too early.
const VOLUME_FLOOR: f32 = 0.05;

/// After this many halvings a node stays where it is.
const HALVINGS: u8 = 5;

/// Cells per parallel task.
const CELLS_PER_TASK: usize = 512;

/// What the guard had to do in one step.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Guarded {
    /// Nodes that took less than the whole step.
    pub held_back: u32,
    /// Rounds of halving.
    pub rounds: u32,
}

/// Makes `proposed` valid by drawing nodes back towards `current`. `size` is `[cells]`, the size asked for now.
pub fn guard(complex: &Complex, skin: &mut Surface, size: &[f32], current: &[Vec3A], proposed: &mut [Vec3A]) -> Guarded {
    let mut halved = vec![0_u8; complex.nodes()];
    let mut moved: Option<Vec<bool>> = None;
    let near = skin.near_pairs(current, proposed, 0.0);
    let full: Vec<Vec3A> = proposed.to_vec();
    let mut guarded = Guarded::default();
    loop {
        let mut marked = bad_cells(complex, size, current, proposed, moved.as_deref());
        let pairs: Vec<(u32, u32)> = match &moved {
            None => skin.crossing_pairs(&near, proposed),
            Some(moved) => {
                let touched = |t: u32| skin.triangles[t as usize].iter().any(|&v| moved[v as usize]);
                let again: Vec<(u32, u32)> = near.iter().filter(|&&(s, t)| touched(s) || touched(t)).copied().collect();
                skin.crossing_pairs(&again, proposed)
            }
        };
        for (s, t) in pairs {
            marked.extend(skin.triangles[s as usize]);
            marked.extend(skin.triangles[t as usize]);
        }
        if marked.is_empty() {
            break;
        }
        guarded.rounds += 1;
        let mut changed = vec![false; complex.nodes()];
        for i in marked {
            changed[i as usize] = true;
            for &j in &complex.neighbours[i as usize] {
                changed[j as usize] = true;
            }
        }
        for i in 0..complex.nodes() {
            if changed[i] {
                halved[i] = halved[i].saturating_add(1);
                let step = if halved[i] > HALVINGS { 0.0 } else { 0.5_f32.powi(i32::from(halved[i])) };
                proposed[i] = current[i] + step * (full[i] - current[i]);
                if step == 0.0 {
                    proposed[i] = current[i];
                }
            }
        }
        moved = Some(changed);
        if guarded.rounds > 200 {
            // Unreachable while the present state is valid: every round holds back more, and no step at all is valid.
            proposed.copy_from_slice(current);
            break;
        }
    }
    guarded.held_back = halved.iter().filter(|&&h| h > 0).count() as u32;
    guarded
}

/// Nodes of elements that the step would break, cell by cell.
fn bad_cells(complex: &Complex, size: &[f32], current: &[Vec3A], proposed: &[Vec3A], moved: Option<&[bool]>) -> Vec<u32> {
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
                let floor = VOLUME_FLOOR * size[chunk * CELLS_PER_TASK + k].powi(3);
                let at = corners.map(|c| proposed[c as usize]);
                for element in KUHN {
                    let volume = determinant(element.map(|c| at[c]));
                    if volume > floor {
                        continue;
                    }
                    let nodes = element.map(|c| corners[c]);
                    let positive = positive(element.map(|c| at[c]));
                    let before = determinant(nodes.map(|c| current[c as usize]));
                    if !positive || volume < before {
                        bad.extend(nodes);
                    }
                }
            }
            bad
        })
        .collect()
}

/// `det[b − a, c − a, d − a]` in f32: six times the volume.
#[inline]
pub(crate) fn determinant([a, b, c, d]: [Vec3A; 4]) -> f32 {
    (b - a).dot((c - a).cross(d - a))
}

/// Exact.
fn positive([a, b, c, d]: [Vec3A; 4]) -> bool {
    orientation(a.as_dvec3(), b.as_dvec3(), c.as_dvec3(), d.as_dvec3()) > 0
}

/// Shortens steps longer than `limit` (per node, in cells).
pub fn limit(current: &[Vec3A], proposed: &mut [Vec3A], limit: impl Fn(usize) -> f32 + Sync) {
    proposed.par_iter_mut().enumerate().with_min_len(CHUNK).for_each(|(i, p)| {
        let step = *p - current[i];
        let (length, most) = (step.length(), limit(i));
        if length > most {
            *p = current[i] + step * (most / length);
        }
    });
}
