//! Guard: a step is taken only where it stays injective.
//!
//! The present state is valid. Elements that the proposed step would invert (or flatten further below a small part of
//! their target volume) and boundary triangles that it would make cross mark their nodes; those nodes and a ring around
//! them take half the step, again and again, down to no step at all, which is valid because the present state is.

use std::borrow::Cow;

use glam::Vec3A;
use rayon::prelude::*;

use crate::{
    boundary::{Boundary, Sets},
    certificate::{Surface, enclosed_bodies, orientation},
    edge::CHUNK,
    film::blend,
    transfer::Binding,
    voxel::{Complex, KUHN},
};

/// A surface carried by the nodes that must not cross itself: the complex's own skin, or the boundary bound to it.
#[derive(Debug, Clone)]
pub struct Shell {
    surface: Surface,
    /// How its vertices follow the nodes; `None` where they are the nodes.
    binding: Option<Binding>,
    /// How many pairs of triangles crossed at rest already: what the input brought is not ours to mend. Triangles that
    /// touch but for rounding are treated alike.
    inherited: usize,
    /// Pairs of corner identities, one from each triangle of such a pair, both ways, sorted. A crossing may slide along
    /// the surface, so that triangles crossed next to those that did are the same crossing.
    inherited_corners: Vec<(u32, u32)>,
    /// `[triangles]` piece of surface that hangs together; empty for the skin.
    piece: Vec<u32>,
    /// Pairs of pieces that crossed at rest, both ways, sorted: an eye in its socket, a spout stuck into a pot. They stay
    /// stuck into each other, and their crossing may slide far.
    inherited_pieces: Vec<(u32, u32)>,
}

impl Shell {
    /// The boundary faces of the complex.
    pub fn skin(complex: &Complex) -> Self {
        Self {
            surface: Surface::new(complex.faces.clone(), &complex.rest),
            binding: None,
            inherited: 0,
            inherited_corners: Vec::new(),
            piece: Vec::new(),
            inherited_pieces: Vec::new(),
        }
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
        let mut inherited = surface.crossings(&rest);
        let crossing_at_rest = inherited.len();
        for seed in 1..=NUDGES {
            inherited.extend(surface.crossings(&nudged(&rest, &welded, NUDGE * binding.check_cell_size(), seed)));
        }
        inherited.sort_unstable();
        inherited.dedup();
        let mut inherited_corners: Vec<(u32, u32)> = inherited
            .iter()
            .flat_map(|&(s, t)| [(s, t), (t, s)])
            .flat_map(|(s, t)| {
                let (s, t) = (surface.identities[s as usize], surface.identities[t as usize]);
                s.into_iter().flat_map(move |a| t.map(|b| (a, b)))
            })
            .collect();
        inherited_corners.sort_unstable();
        inherited_corners.dedup();
        let piece = pieces(&surface.identities, boundary.positions.len());
        let mut inherited_pieces: Vec<(u32, u32)> = inherited
            .iter()
            .map(|&(s, t)| (piece[s as usize], piece[t as usize]))
            .filter(|(a, b)| a != b)
            .flat_map(|(a, b)| [(a, b), (b, a)])
            .collect();
        inherited_pieces.sort_unstable();
        inherited_pieces.dedup();
        Self {
            surface,
            binding: Some(binding),
            inherited: crossing_at_rest,
            inherited_corners,
            piece,
            inherited_pieces,
        }
    }

    /// Pairs that crossed at rest.
    pub fn inherited(&self) -> usize {
        self.inherited
    }

    /// Whether a crossing of these triangles was there at rest, between them or their neighbours.
    fn is_inherited(&self, (s, t): (u32, u32)) -> bool {
        if self.inherited_corners.is_empty() {
            return false;
        }
        let pieces = (self.piece[s as usize], self.piece[t as usize]);
        self.inherited_pieces.binary_search(&pieces).is_ok()
            || self.surface.identities[s as usize].iter().any(|&a| {
                self.surface.identities[t as usize]
                    .iter()
                    .any(|&b| self.inherited_corners.binary_search(&(a, b)).is_ok())
            })
    }

    fn positions<'a>(&self, nodes: &'a [Vec3A]) -> Cow<'a, [Vec3A]> {
        match &self.binding {
            None => Cow::Borrowed(nodes),
            Some(binding) => Cow::Owned(binding.apply_for_check(nodes)),
        }
    }

    fn nodes_of(&self, vertex: u32) -> Vec<u32> {
        match &self.binding {
            None => vec![vertex],
            Some(binding) => binding.carriers(vertex).collect(),
        }
    }

    /// Pairs that may cross in any state between two, node by node.
    fn near_pairs(&mut self, a: &[Vec3A], b: &[Vec3A]) -> Vec<(u32, u32)> {
        match &self.binding {
            None => self.surface.near_pairs(a, b, 0.0),
            Some(binding) => {
                let [low, high] = binding.bounds_between(a, b);
                // A hundredth of a cell covers the rounding of B' many times over.
                self.surface.near_pairs(&low, &high, 0.01)
            }
        }
    }

    /// Adds the nodes of crossing pairs among `near` in a state, of those that have a node in `moved` if given.
    fn mark_crossings(&self, near: &[(u32, u32)], nodes: &[Vec3A], moved: Option<&[bool]>, marked: &mut Vec<u32>) {
        let vertex_moved: Option<Vec<bool>> = moved.map(|moved| match &self.binding {
            None => moved.to_vec(),
            Some(binding) => (0..binding.nodes.len() as u32)
                .into_par_iter()
                .map(|v| binding.carriers(v).any(|i| moved[i as usize]))
                .collect(),
        });
        let touched = |t: u32| {
            let corners = &self.surface.triangles[t as usize];
            vertex_moved.as_ref().is_none_or(|moved| corners.iter().any(|&v| moved[v as usize]))
        };
        let again: Vec<(u32, u32)> = near.iter().filter(|&&(s, t)| touched(s) || touched(t)).copied().collect();
        if again.is_empty() {
            return;
        }
        let crossing = self.surface.crossing_pairs(&again, &self.positions(nodes));
        for (s, t) in crossing.into_iter().filter(|&pair| !self.is_inherited(pair)) {
            marked.extend(self.nodes_of_triangle(s));
            marked.extend(self.nodes_of_triangle(t));
        }
    }

    /// All crossing pairs of a state that were not there at rest. Exact.
    pub fn crossings(&mut self, nodes: &[Vec3A]) -> Vec<(u32, u32)> {
        let positions = match &self.binding {
            None => Cow::Borrowed(nodes),
            Some(binding) => Cow::Owned(binding.apply_for_check(nodes)),
        };
        let mut pairs = self.surface.crossings(&positions);
        pairs.retain(|&pair| !self.is_inherited(pair));
        pairs
    }

    /// The nodes that carry triangle `t`: where a crossing is.
    pub(crate) fn nodes_of_triangle(&self, t: u32) -> Vec<u32> {
        self.surface.triangles[t as usize].iter().flat_map(|&v| self.nodes_of(v)).collect()
    }
}

/// How far vertices are nudged to find triangles that touch but for rounding, in cells: some units in the last place of
/// f32 coordinates at 256 cells. Sheets nearer to each other than that cross or not by chance once they are moved.
const NUDGE: f32 = 5.0e-5;

/// Nudged copies of the rest surface that are looked at.
const NUDGES: u32 = 2;

/// Every point moved by up to `size` along each axis; equal identities move alike.
fn nudged(points: &[Vec3A], identities: &[u32], size: f32, seed: u32) -> Vec<Vec3A> {
    let hash = |x: u32| {
        let x = (x ^ (x >> 16)).wrapping_mul(0x7FEB_352D);
        let x = (x ^ (x >> 15)).wrapping_mul(0x846C_A68B);
        ((x ^ (x >> 16)) >> 8) as f32 / (1 << 23) as f32 - 1.0
    };
    let axis = |id: u32, k: u32| hash(id.wrapping_mul(3).wrapping_add(k) ^ seed.wrapping_mul(0x9E37_79B9));
    points
        .iter()
        .zip(identities)
        .map(|(p, &id)| *p + size * Vec3A::new(axis(id, 0), axis(id, 1), axis(id, 2)))
        .collect()
}

/// `[triangles]` a number for each set of triangles that hang together by corners.
fn pieces(identities: &[[u32; 3]], vertices: usize) -> Vec<u32> {
    let mut sets = Sets::new(vertices);
    for &[a, b, c] in identities {
        sets.join(a, b);
        sets.join(b, c);
    }
    identities.iter().map(|t| sets.find(t[0])).collect()
}

/// Elements may not shrink further once below this part of their target volume. Zero would let slivers through that the
/// next step cannot leave; above about 0.1 hard cases lock too early.
const VOLUME_FLOOR: f32 = 0.05;

/// After this many halvings a node stays where it is.
const HALVINGS: u8 = 3;

/// Rounds of holding back before the whole step is shortened instead: where holds spread from ring to ring, a shorter
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
    pub held_back: u32,
    /// Rounds of halving.
    pub rounds: u32,
}

/// Where on the way of a step its validity is looked at, as parts of the step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Watch {
    /// At its end: enough for the skin, whose cells are thicker than a step is long.
    End,
    /// On the way too: for sheets of the boundary, which may lie nearer to each other than a step is long and must not
    /// change places unseen, and for keyframes, whose blends are shown.
    Way,
}

impl Watch {
    /// Parts of the step that are looked at, the last one 1.
    pub const fn parts(self) -> &'static [f32] {
        match self {
            Self::End => &[1.0],
            Self::Way => &[0.25, 0.5, 0.75, 1.0],
        }
    }
}

/// Makes `proposed` valid by drawing nodes back towards `current`. `size` is `[cells]`, the size asked for now.
///
/// `holds` is `[nodes]` how often each node's step was halved, or empty: what had to be held in the last step starts a
/// little freer in this one, instead of all over again.
pub fn guard(
    complex: &Complex,
    shells: &mut [Shell],
    size: &[f32],
    current: &[Vec3A],
    proposed: &mut [Vec3A],
    watch: Watch,
    holds: &mut Vec<u8>,
) -> Guarded {
    let near: Vec<Vec<(u32, u32)>> = shells.iter_mut().map(|s| s.near_pairs(current, proposed)).collect();
    let full: Vec<Vec3A> = proposed.to_vec();
    let mut guarded = Guarded::default();
    holds.resize(complex.nodes(), 0);
    for hold in holds.iter_mut() {
        *hold = hold.saturating_sub(1);
    }
    let step = Step { complex, shells, near: &near, size, current, watch };
    for whole in WHOLE_STEPS {
        let shortened: Vec<Vec3A> = current.iter().zip(&full).map(|(x, f)| *x + whole * (*f - *x)).collect();
        let target = if whole < 1.0 { &shortened } else { &full };
        if step.hold_back(target, proposed, holds, &mut guarded.rounds) {
            guarded.held_back = holds.iter().filter(|&&h| h > 0).count() as u32;
            return guarded;
        }
    }
    proposed.copy_from_slice(current);
    guarded.held_back = complex.nodes() as u32;
    guarded
}

/// A step to be made valid.
struct Step<'a> {
    complex: &'a Complex,
    shells: &'a [Shell],
    near: &'a [Vec<(u32, u32)>],
    size: &'a [f32],
    current: &'a [Vec3A],
    watch: Watch,
}

impl Step<'_> {
    /// Where a node goes that was halved so often.
    fn held(&self, i: usize, full: &[Vec3A], halved: u8) -> Vec3A {
        match halved {
            0 => full[i],
            h if h > HALVINGS => self.current[i],
            h => self.current[i] + 0.5_f32.powi(i32::from(h)) * (full[i] - self.current[i]),
        }
    }

    /// Draws nodes back until the step is valid; false if that takes too many rounds.
    fn hold_back(&self, full: &[Vec3A], proposed: &mut [Vec3A], halved: &mut [u8], rounds: &mut u32) -> bool {
        for (i, p) in proposed.iter_mut().enumerate() {
            *p = self.held(i, full, halved[i]);
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
                halved[i] = halved[i].saturating_add(1).min(HALVINGS + 1);
                proposed[i] = self.held(i, full, halved[i]);
            }
            moved = Some(changed);
        }
        false
    }

    /// Nodes of what the step would break, of what has a node in `moved` if given.
    fn faults(&self, proposed: &[Vec3A], moved: Option<&[bool]>) -> Vec<u32> {
        let mut marked = Vec::new();
        for &part in self.watch.parts() {
            let state: Cow<'_, [Vec3A]> =
                if part < 1.0 { Cow::Owned(blend(self.current, proposed, part)) } else { Cow::Borrowed(proposed) };
            marked.extend(bad_cells(self.complex, self.size, self.current, &state, moved));
            // A small body may be inside another after one step without having been seen to cross its skin.
            let enclosed = enclosed_bodies(self.complex, &state);
            if !enclosed.is_empty() {
                let nodes = 0..self.complex.nodes() as u32;
                marked.extend(nodes.filter(|&i| enclosed.contains(&self.complex.body[i as usize])));
            }
            for (shell, near) in self.shells.iter().zip(self.near) {
                shell.mark_crossings(near, &state, moved, &mut marked);
            }
        }
        marked
    }
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
