//! Surfaces carried by the nodes that must not cross themselves.

use std::{borrow::Cow, sync::Arc};

use glam::Vec3A;
use rayon::prelude::*;

use super::{BySurface, Checked, Surface, flat_stays_positive, is_positive};
use crate::{
    boundary::{Boundary, Sets},
    transfer::Binding,
    voxel::{Complex, Dimension},
};

/// A surface carried by the nodes that must not cross itself: the complex's own skin, or the boundary bound to it.
#[derive(Debug, Clone)]
pub struct Shell {
    surface: Surface,
    /// How its vertices follow the nodes; `None` where they are the nodes.
    binding: Option<Arc<Binding>>,
    /// How many pairs of triangles crossed at rest already: what the input brought is not ours to mend. Triangles that
    /// touch but for rounding are treated alike.
    inherited: usize,
    /// Pairs of corner identities, one from each triangle of such a pair, both ways, sorted. A crossing may slide along
    /// the surface, so that triangles crossed next to those that did are the same crossing.
    inherited_corners: Vec<(u32, u32)>,
    /// `[triangles]` piece of surface that hangs together; empty for the skin.
    piece: Vec<u32>,
    /// Pairs of pieces that crossed at rest, both ways, sorted: an eye in its socket, a spout stuck into a pot. They
    /// stay stuck into each other, and their crossing may slide far.
    inherited_pieces: Vec<(u32, u32)>,
    /// Triangles of a flat surface, by its vertices: they must stay positively oriented. Empty in space.
    flat_elements: Vec<[u32; 3]>,
}

impl Shell {
    /// The boundary faces of the complex.
    pub fn skin(complex: &Complex) -> Self {
        let faces = complex.faces.clone();
        Self::sound(match complex.dimension {
            Dimension::Two => Surface::flat(faces, &complex.rest),
            Dimension::Three => Surface::new(faces, &complex.rest),
        })
    }

    /// A surface of the nodes that does not cross itself at rest.
    fn sound(surface: Surface) -> Self {
        Self {
            surface,
            binding: None,
            inherited: 0,
            inherited_corners: Vec::new(),
            piece: Vec::new(),
            inherited_pieces: Vec::new(),
            flat_elements: Vec::new(),
        }
    }

    /// The flat mesh a picture is drawn on: its outline must not cross itself, its triangles must not turn over.
    fn flat(boundary: &Boundary, binding: Arc<Binding>, complex: &Complex) -> Self {
        let mut directed: Vec<[u32; 2]> =
            boundary.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
        directed.sort_unstable();
        let outline: Vec<[u32; 3]> = directed
            .iter()
            .filter(|&&[a, b]| directed.binary_search(&[b, a]).is_err())
            .map(|&[a, b]| [a, b, b])
            .collect();
        let surface = Surface::flat(outline, &binding.apply_for_check(&complex.rest));
        Self { binding: Some(binding), flat_elements: boundary.triangles.clone(), ..Self::sound(surface) }
    }

    /// The boundary surface B as it will be written.
    ///
    /// B' is made of flat triangles between moved vertices, while the complex bends between them: that the complex does
    /// not cross itself is not enough where triangles are larger than cells.
    pub fn boundary(boundary: &Boundary, binding: Arc<Binding>, complex: &Complex) -> Self {
        if complex.dimension == Dimension::Two {
            return Self::flat(boundary, binding, complex);
        }
        let welded = boundary.welded();
        let identities = boundary.triangles.iter().map(|t| t.map(|v| welded[v as usize])).collect();
        let rest = binding.apply_for_check(&complex.rest);
        let surface = Surface::welded(boundary.triangles.clone(), identities, &rest);
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
            binding: Some(binding),
            inherited: crossing_at_rest,
            inherited_corners,
            piece,
            inherited_pieces,
            ..Self::sound(surface)
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
    pub(crate) fn near_pairs(&self, a: &[Vec3A], b: &[Vec3A]) -> Vec<(u32, u32)> {
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
    pub(crate) fn mark_crossings(
        &self,
        near: &[(u32, u32)],
        nodes: &[Vec3A],
        moved: Option<&[bool]>,
        marked: &mut Vec<u32>,
    ) {
        let again = self.touched(near, self.moved_vertices(moved).as_deref());
        if again.is_empty() {
            return;
        }
        let crossing = self.surface.crossing_pairs(&again, &self.positions(nodes));
        for (s, t) in crossing.into_iter().filter(|&pair| !self.is_inherited(pair)) {
            marked.extend(self.nodes_of_triangle(s));
            marked.extend(self.nodes_of_triangle(t));
        }
    }

    /// Adds the nodes of pairs among `near` that are not proven to stay apart during the straight motion between two
    /// states, and of flat elements that are not proven to stay positive: of those that have a node in `moved` if
    /// given.
    pub(crate) fn mark_unproven(
        &self,
        near: &[(u32, u32)],
        [from, to]: [&[Vec3A]; 2],
        moved: Option<&[bool]>,
        marked: &mut Vec<u32>,
    ) {
        let moved = self.moved_vertices(moved);
        let again = self.touched(near, moved.as_deref());
        if again.is_empty() && self.flat_elements.is_empty() {
            return;
        }
        let ends = [self.positions(from), self.positions(to)];
        let concerns = |t: &[u32; 3]| moved.as_ref().is_none_or(|moved| t.iter().any(|&v| moved[v as usize]));
        let unproven = self.unproven_corners(again, [&ends[0], &ends[1]], concerns);
        marked.extend(unproven.into_iter().flat_map(|v| self.nodes_of(v)));
    }

    /// `[vertices]` whether one of the nodes that carry each has moved.
    fn moved_vertices(&self, moved: Option<&[bool]>) -> Option<Vec<bool>> {
        moved.map(|moved| match &self.binding {
            None => moved.to_vec(),
            Some(binding) => (0..binding.nodes.len() as u32)
                .into_par_iter()
                .map(|v| binding.carriers(v).any(|i| moved[i as usize]))
                .collect(),
        })
    }

    /// Of `pairs`, those that have a vertex in `moved`; all, if it is not given.
    fn touched(&self, pairs: &[(u32, u32)], moved: Option<&[bool]>) -> Vec<(u32, u32)> {
        let touched = |t: u32| {
            let corners = &self.surface.triangles[t as usize];
            moved.is_none_or(|moved| corners.iter().any(|&v| moved[v as usize]))
        };
        pairs.iter().filter(|&&(s, t)| touched(s) || touched(t)).copied().collect()
    }

    /// All crossing pairs of a state that were not there at rest. Exact.
    pub fn crossings(&self, nodes: &[Vec3A]) -> Vec<(u32, u32)> {
        let mut pairs = self.surface.crossings(&self.positions(nodes));
        pairs.retain(|&pair| !self.is_inherited(pair));
        pairs
    }

    /// The same of the rest state, for the `[nodes]` rest positions: of a surface in space that was bound there are
    /// none by definition, since all that [`boundary`](Self::boundary) found to cross there is inherited.
    pub(crate) fn crossings_at_rest(&self, rest: &[Vec3A]) -> Vec<(u32, u32)> {
        let was_searched = self.binding.is_some() && self.flat_elements.is_empty();
        if was_searched { Vec::new() } else { self.crossings(rest) }
    }

    /// Triangles of a flat surface that are not positively oriented in a state. Exact.
    pub fn inverted(&self, nodes: &[Vec3A]) -> Vec<u32> {
        if self.flat_elements.is_empty() { Vec::new() } else { self.inverted_at(&self.positions(nodes)) }
    }

    /// Makes a flat surface follow the complex's own elements where it is not proven to keep from turning over and from
    /// crossing itself during the straight motion between two states, although they are: four-point rules overshoot
    /// where sizes change abruptly. For a single state, both ends are the same. Returns the vertices that follow
    /// otherwise now.
    pub fn straighten(&mut self, [from, to]: [&[Vec3A]; 2]) -> Vec<u32> {
        if self.flat_elements.is_empty() {
            return Vec::new();
        }
        let ends = [from, to].map(|nodes| self.positions(nodes).into_owned());
        let ends = [&*ends[0], &*ends[1]];
        let unproven = self.unproven_corners(self.surface.near_pairs(ends[0], ends[1], 0.0), ends, |_| true);
        self.binding.as_mut().map_or_else(Vec::new, |binding| Arc::make_mut(binding).straighten(unproven.into_iter()))
    }

    /// Whether a flat surface is proven to stay as it should be during the straight motion between two states, as far
    /// as the vertices in `changed` are concerned. True for others.
    pub fn stays_sound(&self, changed: &[bool], [from, to]: [&[Vec3A]; 2]) -> bool {
        if self.flat_elements.is_empty() {
            return true;
        }
        let ends = [from, to].map(|nodes| self.positions(nodes));
        let ends = [&*ends[0], &*ends[1]];
        let concerns = |t: &[u32; 3]| t.iter().any(|&v| changed[v as usize]);
        let near = self.touched(&self.surface.near_pairs(ends[0], ends[1], 0.0), Some(changed));
        self.unproven_corners(near, ends, concerns).is_empty()
    }

    /// Corners of what is not proven to stay as it should be during a straight motion of the vertices: of flat elements
    /// that `concerns` says yes to, which must stay positive, and of `pairs`, which must stay apart.
    fn unproven_corners(
        &self,
        pairs: Vec<(u32, u32)>,
        ends: [&[Vec3A]; 2],
        concerns: impl Fn(&[u32; 3]) -> bool + Sync,
    ) -> Vec<u32> {
        let is_unproven = |t: &&[u32; 3]| concerns(t) && !stays_positive(t, ends);
        let elements = self.flat_elements.par_iter().with_min_len(2048).filter(is_unproven);
        let mut corners: Vec<u32> = elements.flatten_iter().copied().collect();
        let corners_of = |s: u32| &self.surface.triangles[s as usize];
        let unproven = self.surface.unproven_of(pairs, ends);
        for (s, t) in unproven.into_iter().filter(|&pair| !self.is_inherited(pair)) {
            corners.extend(corners_of(s).iter().chain(corners_of(t)));
        }
        corners
    }

    /// How its vertices follow the nodes, where they are not the nodes.
    pub fn binding(&self) -> Option<&Arc<Binding>> {
        self.binding.as_ref()
    }

    fn inverted_at(&self, positions: &[Vec3A]) -> Vec<u32> {
        let is_sound = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| positions[v as usize].as_dvec3());
            is_positive(Dimension::Two, [a, b, c, c])
        };
        let elements = self.flat_elements.par_iter().with_min_len(2048).enumerate();
        elements.filter(|(_, t)| !is_sound(t)).map(|(t, _)| t as u32).collect()
    }

    /// The same for the state at the end of a straight motion of this surface's vertices, and whether it is proven that
    /// there are none at any instant of the motion.
    fn crossings_after(&self, [start, end]: [&[Vec3A]; 2]) -> (Vec<(u32, u32)>, bool) {
        let mut unproven = self.surface.unproven_pairs(start, end);
        unproven.retain(|&pair| !self.is_inherited(pair));
        (self.surface.crossing_pairs(&unproven, end), unproven.is_empty())
    }

    /// The nodes that carry triangle `t`: where a crossing is.
    pub(crate) fn nodes_of_triangle(&self, t: u32) -> Vec<u32> {
        self.surface.triangles[t as usize].iter().flat_map(|&v| self.nodes_of(v)).collect()
    }
}

/// A state with the surface it carries: the end of one motion is the beginning of the next.
#[derive(Debug)]
pub struct CarriedState {
    nodes: Vec<Vec3A>,
    /// Vertices of the written surface, where there is one.
    written: Option<Vec<Vec3A>>,
}

impl CarriedState {
    /// Places the vertices of all surfaces.
    pub fn new<'a>(surfaces: impl Into<Checked<'a>>, nodes: Vec<Vec3A>) -> Self {
        let written = surfaces.into().written.map(|written| written.positions(&nodes).into_owned());
        Self { written, nodes }
    }

    /// `[nodes]` in cells.
    pub fn nodes(&self) -> &[Vec3A] {
        &self.nodes
    }

    /// `[nodes]` in cells.
    pub fn into_nodes(self) -> Vec<Vec3A> {
        self.nodes
    }

    /// Vertices of the written surface.
    fn written(&self) -> &[Vec3A] {
        self.written.as_deref().unwrap_or(&self.nodes)
    }

    /// Whether the triangles of a flat surface are proven to stay positive during the straight motion here.
    pub(crate) fn stays_unfolded_from(&self, from: &Self, surfaces: Checked) -> bool {
        surfaces.written.is_none_or(|written| {
            let ends = [from.written(), self.written()];
            written.flat_elements.par_iter().with_min_len(2048).all(|t| stays_positive(t, ends))
        })
    }

    /// By surface: crossings of this state that were not there at rest, and whether it is proven that there are none at
    /// any instant of the straight motion to it.
    pub(crate) fn crossings_from(&self, from: &Self, surfaces: Checked) -> BySurface<(Vec<(u32, u32)>, bool)> {
        let (skin, written) = rayon::join(
            || surfaces.skin.crossings_after([&from.nodes, &self.nodes]),
            || surfaces.written.map(|written| written.crossings_after([from.written(), self.written()])),
        );
        BySurface { skin, written }
    }
}

/// Whether a flat triangle is proven to stay positive during the straight motion of the vertices.
fn stays_positive(triangle: &[u32; 3], ends: [&[Vec3A]; 2]) -> bool {
    flat_stays_positive(ends.map(|at| triangle.map(|v| at[v as usize])))
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
