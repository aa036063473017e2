//! The rounds: which edges are halved, and which triangles take the place of one.

use std::collections::{HashMap, HashSet};

use glam::{DVec3, Vec2, Vec3};

use super::Split;
use crate::boundary::Boundary;
use crate::boundary::source::NONE;

/// Two places, the smaller first.
pub(super) type Edge = [u32; 2];

/// Edges that are halved together.
pub(super) struct Round(pub HashSet<Edge>);

impl Round {
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

/// A corner of a triangle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Corner {
    pub vertex: u32,
    /// Index of a texture coordinate, or [`NONE`].
    pub uv: u32,
    /// Index of a normal, or [`NONE`].
    pub normal: u32,
    /// Weights of the parent's corners.
    pub weights: [f32; 3],
}

/// A triangle on its way.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece {
    pub parent: u32,
    pub corners: [Corner; 3],
}

/// The surface between two rounds.
pub(super) struct Work {
    pub positions: Vec<DVec3>,
    /// `[vertices]` the first vertex at the same place.
    place: Vec<u32>,
    first_at: HashMap<[u64; 3], u32>,
    pub pieces: Vec<Piece>,
    pub ends: Vec<[u32; 2]>,
    pub uvs: Vec<Vec2>,
    pub normals: Vec<Vec3>,
    middle_uv: HashMap<[u32; 2], u32>,
    middle_normal: HashMap<[u32; 2], u32>,
}

impl Work {
    pub fn new(boundary: &Boundary) -> Self {
        let source = &boundary.source;
        let of = |triangle: usize, corner: usize, indices: &[u32]| {
            let at = source.triangle_corners.get(triangle).map(|corners| corners[corner] as usize);
            at.and_then(|at| indices.get(at)).copied().unwrap_or(NONE)
        };
        let piece = |(index, triangle): (usize, &[u32; 3])| Piece {
            parent: index as u32,
            corners: std::array::from_fn(|corner| Corner {
                vertex: triangle[corner],
                uv: of(index, corner, &source.corner_uvs),
                normal: of(index, corner, &source.corner_normals),
                weights: std::array::from_fn(|i| if i == corner { 1.0 } else { 0.0 }),
            }),
        };
        let mut first_at = HashMap::with_capacity(boundary.positions.len());
        let place = (0..).zip(&boundary.positions).map(|(v, p)| *first_at.entry(key(p)).or_insert(v)).collect();
        Self {
            positions: boundary.positions.clone(),
            place,
            first_at,
            pieces: boundary.triangles.iter().enumerate().map(piece).collect(),
            ends: Vec::new(),
            uvs: source.uvs.clone(),
            normals: source.normals.clone(),
            middle_uv: HashMap::new(),
            middle_normal: HashMap::new(),
        }
    }

    /// The edge between the places of two vertices; `None` where it cannot be halved.
    pub fn edge_at(&self, a: u32, b: u32) -> Option<Edge> {
        let [from, to] = [a, b].map(|v| self.positions[v as usize]);
        let middle = middle(from, to);
        let [a, b] = [a, b].map(|v| self.place[v as usize]);
        (middle != from && middle != to).then_some([a.min(b), a.max(b)])
    }

    /// Edges to halve because they are longer, and whether no round may follow: so many that there are `most` triangles
    /// afterwards, the longest first.
    pub fn longer_than(&self, longest: f64, most: usize) -> (Round, bool) {
        let mut sides: HashMap<Edge, (f64, usize)> = HashMap::new();
        for piece in &self.pieces {
            for [a, b] in sides_of(piece) {
                let length = self.length(a, b);
                if let Some(edge) = (length > longest).then(|| self.edge_at(a, b)).flatten() {
                    sides.entry(edge).or_insert((length, 0)).1 += 1;
                }
            }
        }
        // A triangle becomes one more for each of its sides that is halved.
        let added: usize = sides.values().map(|&(_, sides)| sides).sum();
        let room = most.saturating_sub(self.pieces.len());
        if added <= room {
            return (Round(sides.into_keys().collect()), false);
        }
        let mut by_length: Vec<(f64, usize, Edge)> =
            sides.into_iter().map(|(edge, (length, sides))| (length, sides, edge)).collect();
        by_length.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.2.cmp(&b.2)));
        let (mut taken, mut left) = (0, room);
        for alike in by_length.chunk_by(|a, b| a.0 == b.0) {
            let Some(rest) = left.checked_sub(alike.iter().map(|side| side.1).sum()) else { break };
            left = rest;
            taken += alike.len();
        }
        (Round(by_length[..taken].iter().map(|side| side.2).collect()), true)
    }

    fn length(&self, a: u32, b: u32) -> f64 {
        let side = (self.positions[b as usize] - self.positions[a as usize]).abs();
        // Scaled first, so that squares neither vanish nor overflow.
        let scale = side.max_element();
        if scale > 0.0 { scale * (side / scale).length() } else { 0.0 }
    }

    /// One round.
    pub fn halve(&mut self, round: &Round) {
        let mut middles: HashMap<[u32; 2], u32> = HashMap::new();
        let mut pieces = Vec::with_capacity(self.pieces.len());
        for piece in std::mem::take(&mut self.pieces) {
            let halved = sides_of(&piece).map(|[a, b]| {
                let [from, to] = [a, b].map(|v| self.place[v as usize]);
                round.0.contains(&[from.min(to), from.max(to)])
            });
            let [a, b, c] = piece.corners;
            let mut between =
                |is_halved: bool, a: Corner, b: Corner| is_halved.then(|| self.between(a, b, &mut middles));
            let sides = [between(halved[0], a, b), between(halved[1], b, c), between(halved[2], c, a)];
            self.replace(&piece, sides, &mut pieces);
        }
        self.pieces = pieces;
    }

    /// The parts of a triangle with middles on some of its sides, in its orientation.
    fn replace(&self, piece: &Piece, sides: [Option<Corner>; 3], out: &mut Vec<Piece>) {
        let mut put = |corners: [Corner; 3]| out.push(Piece { parent: piece.parent, corners });
        let [a, b, c] = piece.corners;
        match sides {
            [None, None, None] => put([a, b, c]),
            [Some(ab), Some(bc), Some(ca)] => {
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]].into_iter().for_each(put);
            }
            [Some(m), None, None] => [[a, m, c], [m, b, c]].into_iter().for_each(put),
            [None, Some(m), None] => [[b, m, a], [m, c, a]].into_iter().for_each(put),
            [None, None, Some(m)] => [[c, m, b], [m, a, b]].into_iter().for_each(put),
            [Some(ab), None, Some(ca)] => self.cut([a, b, c], ab, ca).into_iter().for_each(put),
            [Some(ab), Some(bc), None] => self.cut([b, c, a], bc, ab).into_iter().for_each(put),
            [None, Some(bc), Some(ca)] => self.cut([c, a, b], ca, bc).into_iter().for_each(put),
        }
    }

    /// The parts of a triangle with middles `m` of its first and `n` of its last side: its tip, and two of the quad below, by the
    /// shorter diagonal. Of two alike that from the vertex whose place has the smaller index, so that triangles at the same place
    /// are cut alike.
    fn cut(&self, [a, b, c]: [Corner; 3], m: Corner, n: Corner) -> [[Corner; 3]; 3] {
        let (to_c, to_b) = (self.length(m.vertex, c.vertex), self.length(n.vertex, b.vertex));
        let place = |corner: Corner| (self.place[corner.vertex as usize], corner.vertex);
        if to_c < to_b || to_c == to_b && place(c) < place(b) {
            [[a, m, n], [m, b, c], [m, c, n]]
        } else {
            [[a, m, n], [m, b, n], [b, c, n]]
        }
    }

    /// The corner in the middle of a side.
    fn between(&mut self, a: Corner, b: Corner, middles: &mut HashMap<[u32; 2], u32>) -> Corner {
        let [from, to] = [a.vertex.min(b.vertex), a.vertex.max(b.vertex)];
        let vertex = *middles.entry([from, to]).or_insert_with(|| {
            let vertex = self.positions.len() as u32;
            let p = middle(self.positions[from as usize], self.positions[to as usize]);
            self.place.push(*self.first_at.entry(key(&p)).or_insert(vertex));
            self.positions.push(p);
            let place = |v: u32| (self.place[v as usize], v);
            self.ends.push(if place(to) < place(from) { [to, from] } else { [from, to] });
            vertex
        });
        let pair = |a: u32, b: u32| [a.min(b), a.max(b)];
        Corner {
            vertex,
            uv: mean(pair(a.uv, b.uv), &mut self.uvs, &mut self.middle_uv, |a, b| (*a + *b) * 0.5),
            normal: mean(pair(a.normal, b.normal), &mut self.normals, &mut self.middle_normal, |a, b| {
                (a.normalize_or_zero() + b.normalize_or_zero()).normalize_or_zero()
            }),
            weights: std::array::from_fn(|i| 0.5 * (a.weights[i] + b.weights[i])),
        }
    }

    /// The result.
    pub fn finish(self, boundary: &Boundary) -> Split {
        let sides = self.pieces.iter().flat_map(sides_of);
        let longest = sides.map(|[a, b]| self.length(a, b)).fold(0.0, f64::max);
        let parents = self.pieces.iter().map(|piece| piece.parent).collect();
        let corners = self.pieces.iter().map(|piece| piece.corners.map(|corner| corner.weights)).collect();
        let ends = self.ends.clone();
        let boundary = if ends.is_empty() { boundary.clone() } else { boundary.with_pieces(self) };
        Split { boundary, parents, corners, ends, longest }
    }
}

/// The sides of a triangle: first to second corner, second to third, third to first.
fn sides_of(piece: &Piece) -> [[u32; 2]; 3] {
    let [a, b, c] = piece.corners.map(|corner| corner.vertex);
    [[a, b], [b, c], [c, a]]
}

/// The same for one place; `-0.0` is `0.0`.
fn key(p: &DVec3) -> [u64; 3] {
    (*p + DVec3::ZERO).to_array().map(f64::to_bits)
}

/// The middle, to the bit the same from either end; of two places in single precision one in single precision.
fn middle(a: DVec3, b: DVec3) -> DVec3 {
    // Halved first: the sum of huge ones would be infinite. Zeros have one sign.
    let middle = a * 0.5 + b * 0.5 + DVec3::ZERO;
    let is_single = |p: DVec3| p.as_vec3().as_dvec3() == p;
    if is_single(a) && is_single(b) { middle.as_vec3().as_dvec3() } else { middle }
}

/// The index of the mean of two values, made once for each pair; [`NONE`] where one of them is.
fn mean<T: Copy>(
    pair: [u32; 2],
    values: &mut Vec<T>,
    known: &mut HashMap<[u32; 2], u32>,
    middle: impl Fn(&T, &T) -> T,
) -> u32 {
    let [Some(a), Some(b)] = pair.map(|index| values.get(index as usize)) else { return NONE };
    if pair[0] == pair[1] {
        return pair[0];
    }
    let value = middle(a, b);
    *known.entry(pair).or_insert_with(|| {
        values.push(value);
        values.len() as u32 - 1
    })
}
