//! Guard: a step is taken only where it stays injective.
//!
//! The present state is valid. Elements that the proposed step would invert (or flatten further below a small part of
//! their target volume) and boundary triangles that it would make cross mark their nodes; those nodes and a ring around
//! them take half the step, again and again, down to no step at all, which is valid because the present state is.

use std::borrow::Cow;

use glam::Vec3A;
use rayon::prelude::*;

use crate::{
    boundary::Boundary,
    certificate::{Surface, orientation},
    edge::CHUNK,
    transfer::Binding,
    voxel::{Complex, KUHN},
};

/// A surface carried by the nodes that must not cross itself: the complex's own skin, or the boundary bound to it.
#[derive(Debug, Clone)]
pub struct Shell {
    surface: Surface,
    /// How its vertices follow the nodes; `None` where they are the nodes.
    binding: Option<Binding>,
    /// Pairs of triangles that crossed at rest already, sorted: what the input brought is not ours to mend.
    inherited: Vec<(u32, u32)>,
}

impl Shell {
    /// The boundary faces of the complex.
    pub fn skin(complex: &Complex) -> Self {
        Self { surface: Surface::new(complex.faces.clone(), &complex.rest), binding: None, inherited: Vec::new() }
    }

    /// The boundary surface B as it will be written.
    ///
    /// B' is made of flat triangles between moved vertices, while the complex bends between them: that the complex does
    /// not cross itself is not enough where triangles are larger than cells.
    pub fn boundary(boundary: &Boundary, binding: Binding, complex: &Complex) -> Self {
        let welded = boundary.welded();
        let identities = boundary.triangles.iter().map(|t| t.map(|v| welded[v as usize])).collect();
        let rest = binding.apply_for_check(&complex.rest);
        let mut surface = Surface::welded(boundary.triangles.clone(), identities, &rest);
        let inherited = surface.crossings(&rest);
        Self { surface, binding: Some(binding), inherited }
    }

    /// Pairs that crossed at rest.
    pub fn inherited(&self) -> usize {
        self.inherited.len()
    }

    fn positions<'a>(&self, nodes: &'a [Vec3A]) -> Cow<'a, [Vec3A]> {
        match &self.binding {
            None => Cow::Borrowed(nodes),
            Some(binding) => Cow::Owned(binding.apply_for_check(nodes)),
        }
    }

    fn nodes_of(&self, vertex: u32) -> Cow<'_, [u32]> {
        match &self.binding {
            None => Cow::Owned(vec![vertex]),
            Some(binding) => Cow::Borrowed(&binding.nodes[vertex as usize]),
        }
    }

    /// Pairs that may cross in any state between two, node by node.
    fn near_pairs(&mut self, a: &[Vec3A], b: &[Vec3A]) -> Vec<(u32, u32)> {
        match &self.binding {
            None => self.surface.near_pairs(a, b, 0.0),
            Some(binding) => {
                let low = binding.apply_between(a, b, Vec3A::min);
                let high = binding.apply_between(a, b, Vec3A::max);
                // A hundredth of a cell covers the rounding of B' many times over.
                self.surface.near_pairs(&low, &high, 0.01)
            }
        }
    }

    /// All crossing pairs of a state that were not there at rest. Exact.
    pub fn crossings(&mut self, nodes: &[Vec3A]) -> Vec<(u32, u32)> {
        let positions = match &self.binding {
            None => Cow::Borrowed(nodes),
            Some(binding) => Cow::Owned(binding.apply_for_check(nodes)),
        };
        let mut pairs = self.surface.crossings(&positions);
        pairs.retain(|pair| self.inherited.binary_search(pair).is_err());
        pairs
    }

    /// The nodes that carry triangle `t`: where a crossing is.
    pub(crate) fn nodes_of_triangle(&self, t: u32) -> Vec<u32> {
        self.surface.triangles[t as usize].iter().flat_map(|&v| self.nodes_of(v).into_owned()).collect()
    }
}

/// Elements may not shrink further once below this part of their target volume. Zero would let slivers through that the
/// next step cannot leave; above about 0.1 hard cases lock too early.
const VOLUME_FLOOR: f32 = 0.05;

/// After this many halvings a node stays where it is.
const HALVINGS: u8 = 5;

/// Rounds after which the whole step is dropped. Each round holds back more and no step at all is valid, so the rounds
/// end by themselves; this bounds their time on states that lock in many places.
const MOST_ROUNDS: u32 = 60;

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
pub fn guard(
    complex: &Complex,
    shells: &mut [Shell],
    size: &[f32],
    current: &[Vec3A],
    proposed: &mut [Vec3A],
) -> Guarded {
    let mut near: Vec<Vec<(u32, u32)>> = shells.iter_mut().map(|s| s.near_pairs(current, proposed)).collect();
    let full: Vec<Vec3A> = proposed.to_vec();
    let mut halved = vec![0_u8; complex.nodes()];
    let mut moved: Option<Vec<bool>> = None;
    let mut guarded = Guarded::default();
    loop {
        let mut marked = bad_cells(complex, size, current, proposed, moved.as_deref());
        for (shell, near) in shells.iter().zip(&mut near) {
            let positions = shell.positions(proposed);
            let crossing = match &moved {
                None => {
                    near.retain(|&(s, t)| shell.inherited.binary_search(&(s.min(t), s.max(t))).is_err());
                    shell.surface.crossing_pairs(near, &positions)
                }
                Some(moved) => {
                    let touched = |t: u32| {
                        shell.surface.triangles[t as usize]
                            .iter()
                            .any(|&v| shell.nodes_of(v).iter().any(|&i| moved[i as usize]))
                    };
                    let again: Vec<(u32, u32)> =
                        near.iter().filter(|&&(s, t)| touched(s) || touched(t)).copied().collect();
                    shell.surface.crossing_pairs(&again, &positions)
                }
            };
            for t in crossing.into_iter().flat_map(|(s, t)| [s, t]) {
                for v in shell.surface.triangles[t as usize] {
                    marked.extend_from_slice(&shell.nodes_of(v));
                }
            }
        }
        if marked.is_empty() {
            break;
        }
        guarded.rounds += 1;
        if guarded.rounds > MOST_ROUNDS {
            proposed.copy_from_slice(current);
            break;
        }
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
                proposed[i] = if halved[i] > HALVINGS {
                    current[i]
                } else {
                    current[i] + 0.5_f32.powi(i32::from(halved[i])) * (full[i] - current[i])
                };
            }
        }
        moved = Some(changed);
    }
    guarded.held_back = halved.iter().filter(|&&h| h > 0).count() as u32;
    guarded
}

/// Nodes of elements that the step would break, cell by cell.
fn bad_cells(
    complex: &Complex,
    size: &[f32],
    current: &[Vec3A],
    proposed: &[Vec3A],
    moved: Option<&[bool]>,
) -> Vec<u32> {
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

/// Shortens steps longer than `most`, in cells.
pub fn limit(current: &[Vec3A], proposed: &mut [Vec3A], most: f32) {
    proposed.par_iter_mut().zip(current).with_min_len(CHUNK).for_each(|(p, x)| {
        let step = *p - *x;
        let length = step.length();
        if length > most {
            *p = *x + step * (most / length);
        }
    });
}
