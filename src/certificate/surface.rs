//! Crossings of a triangle surface with itself, in the plane of lines: boxes first, exact predicates last.

use glam::{DVec3, Vec3A};
use rayon::prelude::*;

use crate::voxel::Dimension;

use super::{
    motion::{Moving, SUBDIVISION_DEPTH, lie_apart, stay_apart},
    predicates::{Triangle, segments_cross, triangles_cross},
    segments,
    star::Stars,
    tree::{Bounds, Boxes, Tree, may_meet, union},
};

/// Pairs per parallel task.
const PAIRS_PER_TASK: usize = 1024;

/// A triangle with its plane, for proving others apart from it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plane {
    at: [Vec3A; 3],
    /// `(b − a) × (c − a)`.
    normal: DVec3,
    /// Bounds the rounding of `normal · (p − a)`, per largest coordinate of `p − a`.
    error: f64,
}

/// Bounds the rounding of `normal · (p − a)`, relative to the permanent of the normal (the sum of the sizes of its
/// products) and the largest coordinate of `p − a`: 2 differences, product and difference of the normal, the difference
/// `p − a`, a product and two sums are n = 8 roundings of each term, 8.9e-16.
pub(super) const PLANE_ROUNDING: f64 = 1.0e-14;

impl Plane {
    #[inline]
    fn of(at: [Vec3A; 3]) -> Self {
        Self::with(PLANE_ROUNDING, at)
    }

    /// As [`of`](Self::of), with a rounding bound.
    #[inline(always)]
    pub(super) fn with(rounding: f64, at: [Vec3A; 3]) -> Self {
        let [a, b, c] = at.map(|p| p.as_dvec3());
        let (u, v) = (b - a, c - a);
        let (p, q) = (u.abs(), v.abs());
        let permanent = p.y * q.z + p.z * q.y + p.z * q.x + p.x * q.z + p.x * q.y + p.y * q.x;
        Self { at, normal: u.cross(v), error: rounding * permanent }
    }

    #[inline]
    fn bounds(&self) -> Bounds {
        let [a, b, c] = self.at;
        Bounds { low: a.min(b).min(c), high: a.max(b).max(c) }
    }

    /// Whether all corners of `other` that are not shared lie strictly, and provably, on one side of this plane.
    #[inline]
    pub(super) fn is_apart(&self, other: &Self, own_ids: &[u32; 3], other_ids: &[u32; 3]) -> bool {
        let origin = self.at[0].as_dvec3();
        let (mut above, mut below) = (false, false);
        for (corner, id) in other.at.iter().zip(other_ids) {
            if own_ids.contains(id) {
                continue;
            }
            let offset = corner.as_dvec3() - origin;
            let side = self.normal.dot(offset);
            let bound = self.error * offset.abs().max_element();
            above |= side > bound;
            below |= side < -bound;
            if side.abs() <= bound || side.is_nan() {
                return false;
            }
        }
        above != below
    }
}

/// A triangle surface, or lines of the plane z = 0, to be checked in many states.
#[derive(Debug, Clone)]
pub struct Surface {
    /// Whether triangles or segments are meant; a segment is a triangle whose third corner is the second once more.
    dimension: Dimension,
    /// `[triangles]` corner indices into the state's positions.
    pub triangles: Vec<[u32; 3]>,
    /// `[triangles]` identities of the corners: equal where corners are the same point (welded).
    pub identities: Vec<[u32; 3]>,
    /// Triangles two by two, neighbours across an edge; those without one are there twice.
    triangle_pairs: Vec<[u32; 2]>,
    /// Over the pairs of triangles.
    tree: Tree,
    stars: Stars,
    /// `[triangles]` whether one is without area at rest: it has no side that anything could be proven to be on.
    degenerate: Vec<bool>,
}

/// Triangles not wider than this part of their length, at rest, are without area: positions are rounded to f32.
const DEGENERATE: f32 = 1.0e-5;

/// Instants of a motion at which pairs with a degenerate triangle are looked at: samples, not a proof.
const SAMPLES: [f64; 9] = [0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1.0];

impl Surface {
    /// A surface whose corners are what their indices say.
    pub fn new(triangles: Vec<[u32; 3]>, rest: &[Vec3A]) -> Self {
        let identities = triangles.clone();
        Self::welded(triangles, identities, rest)
    }

    /// Segments of the plane.
    pub fn flat(segments: Vec<[u32; 3]>, rest: &[Vec3A]) -> Self {
        Self { dimension: Dimension::Two, ..Self::new(segments, rest) }
    }

    /// A surface with corner identities of its own (a soup whose equal points are one).
    pub fn welded(triangles: Vec<[u32; 3]>, identities: Vec<[u32; 3]>, rest: &[Vec3A]) -> Self {
        let triangle_pairs = triangle_pairs(&triangles, &identities, rest);
        let centre = |t: u32| triangles[t as usize].map(|v| rest[v as usize]).iter().sum::<Vec3A>() / 3.0;
        let centres: Vec<Vec3A> = triangle_pairs.iter().map(|&[s, t]| 0.5 * (centre(s) + centre(t))).collect();
        let degenerate = triangles.iter().map(|t| is_degenerate(t.map(|v| rest[v as usize]))).collect();
        let (dimension, stars) = (Dimension::Three, Stars::new(&identities));
        Self { dimension, tree: Tree::new(&centres), triangle_pairs, stars, degenerate, triangles, identities }
    }

    /// Pairs of triangles whose boxes meet where each corner is anywhere between its places in `a` and `b`.
    pub fn near_pairs(&self, a: &[Vec3A], b: &[Vec3A], margin: f32) -> Vec<(u32, u32)> {
        let bounds = |corners: &[u32; 3]| {
            [Bounds::of(corners.iter().flat_map(|&v| [a[v as usize], b[v as usize]])).grown(margin)]
        };
        self.pairs(bounds, |_, _| true)
    }

    /// Pairs of triangles whose boxes may meet, each as (lower, higher), of those that `keep` keeps. `bounds` gives the
    /// boxes of a triangle.
    ///
    /// It is pairs of neighbours that are searched for: half as many, in boxes hardly larger, so that each search saves
    /// three of four.
    fn pairs<const ENDS: usize>(
        &self,
        bounds: impl Fn(&[u32; 3]) -> Boxes<ENDS> + Sync,
        keep: impl Fn(u32, u32) -> bool + Sync,
    ) -> Vec<(u32, u32)> {
        let boxes: Vec<Boxes<ENDS>> = self.triangles.par_iter().with_min_len(PAIRS_PER_TASK).map(&bounds).collect();
        let take = |s: u32, t: u32, pairs: &mut Vec<(u32, u32)>| {
            if may_meet(&boxes[s as usize], &boxes[t as usize]) && keep(s, t) {
                pairs.push((s.min(t), s.max(t)));
            }
        };
        let within =
            self.triangle_pairs.par_iter().with_min_len(PAIRS_PER_TASK).fold(Vec::new, |mut pairs, &[s, t]| {
                if s != t {
                    take(s, t, &mut pairs);
                }
                pairs
            });
        let mut pairs: Vec<(u32, u32)> = within.reduce(Vec::new, |mut a, b| {
            a.extend(b);
            a
        });
        pairs.extend(self.tree.pairs(
            |pair| {
                let [s, t] = self.triangle_pairs[pair as usize];
                union(&boxes[s as usize], &boxes[t as usize])
            },
            |a, b, pairs| {
                let ([s, t], [u, v]) = (self.triangle_pairs[a as usize], self.triangle_pairs[b as usize]);
                take(s, u, pairs);
                if u != v {
                    take(s, v, pairs);
                }
                if s != t {
                    take(t, u, pairs);
                    if u != v {
                        take(t, v, pairs);
                    }
                }
            },
        ));
        pairs
    }

    /// Pairs of triangles, each as (lower, higher), that neither their boxes nor a star around a common corner prove
    /// apart, in one state or at every instant between two.
    fn candidate_pairs<const ENDS: usize>(&self, ends: [&[Vec3A]; ENDS]) -> Vec<(u32, u32)> {
        if self.dimension == Dimension::Two {
            return self.near_pairs(ends[0], ends[ENDS - 1], 0.0);
        }
        let proven = self.stars.proven(&self.triangles, ends);
        let bounds = |corners: &[u32; 3]| ends.map(|p| Bounds::of(corners.map(|v| p[v as usize])));
        self.pairs(bounds, |s, t| !self.are_around(&proven, s, t))
    }

    /// Whether two triangles are around a vertex whose star is proven.
    #[inline]
    fn are_around(&self, proven: &[bool], s: u32, t: u32) -> bool {
        // Without branches as long as nothing is shared: each pair of boxes that meet comes by here.
        let ([a, b, c], t_ids) = (self.identities[s as usize], self.identities[t as usize]);
        let shares = |v: u32| t_ids.iter().fold(false, |any, &other| any | (other == v));
        let [of_a, of_b, of_c] = [a, b, c].map(shares);
        let is_proven = |shared: bool, v: u32| shared && proven[v as usize];
        (of_a | of_b | of_c) && (is_proven(of_a, a) || is_proven(of_b, b) || is_proven(of_c, c))
    }

    /// Pairs of triangles, each as (lower, higher), sorted, that are not proven to stay apart at every instant of a
    /// straight motion of the corners. Few, where nothing crosses. Those with a triangle that is without area at rest,
    /// so that nothing can be proven of them, are looked at in eighths of the motion.
    pub fn unproven_pairs(&self, from: &[Vec3A], to: &[Vec3A]) -> Vec<(u32, u32)> {
        self.unproven_among(self.candidate_pairs([from, to]), [from, to])
    }

    fn unproven_segments(&self, pairs: Vec<(u32, u32)>, ends: [&[Vec3A]; 2]) -> Vec<(u32, u32)> {
        let moving = |s: u32| {
            let [a, b, _] = self.triangles[s as usize];
            ends.map(|p| [a, b].map(|v| p[v as usize].as_dvec3().truncate()))
        };
        let ids = |s: u32| [self.identities[s as usize][0], self.identities[s as usize][1]];
        let left = pairs.into_par_iter().with_min_len(PAIRS_PER_TASK / 8);
        left.filter(|&(s, t)| !segments::stay_apart(&moving(s), &moving(t), ids(s), ids(t))).collect()
    }

    /// The same of given pairs.
    pub(crate) fn unproven_of(&self, mut pairs: Vec<(u32, u32)>, ends: [&[Vec3A]; 2]) -> Vec<(u32, u32)> {
        if self.dimension == Dimension::Three && pairs.len() > self.triangles.len() {
            let proven = self.stars.proven(&self.triangles, ends);
            pairs.retain(|&(s, t)| !self.are_around(&proven, s, t));
        }
        self.unproven_among(pairs, ends)
    }

    fn unproven_among(&self, pairs: Vec<(u32, u32)>, ends: [&[Vec3A]; 2]) -> Vec<(u32, u32)> {
        let mut left = self.not_apart(pairs, ends, SUBDIVISION_DEPTH);
        if self.dimension == Dimension::Three {
            left.retain(|&(s, t)| {
                !(self.degenerate[s as usize] || self.degenerate[t as usize]) || self.cross_at_samples(s, t, ends)
            });
        }
        left
    }

    /// Whether two triangles cross in some eighth of a motion.
    fn cross_at_samples(&self, s: u32, t: u32, [from, to]: [&[Vec3A]; 2]) -> bool {
        let [s, t] = [s, t].map(|t| [self.triangle(t, from), self.triangle(t, to)]);
        let at = |[from, to]: &[Triangle; 2], part: f64| Triangle {
            at: [0, 1, 2].map(|k| from.at[k].lerp(to.at[k], part)),
            id: from.id,
        };
        SAMPLES.into_iter().any(|part| triangles_cross(&at(&s, part), &at(&t, part)))
    }

    /// Sorts pairs and leaves out those that are proven apart.
    fn not_apart(&self, pairs: Vec<(u32, u32)>, ends: [&[Vec3A]; 2], depth: u32) -> Vec<(u32, u32)> {
        if self.dimension == Dimension::Two {
            let mut left = self.unproven_segments(pairs, ends);
            left.par_sort_unstable();
            return left;
        }
        let moving = |t: u32| -> Moving {
            let corners = self.triangles[t as usize];
            ends.map(|p| corners.map(|v| p[v as usize].as_dvec3()))
        };
        let mut left: Vec<(u32, u32)> = pairs
            .into_par_iter()
            .with_min_len(PAIRS_PER_TASK / 8)
            .filter(|&(s, t)| {
                let [s_ids, t_ids] = [s, t].map(|t| self.identities[t as usize]);
                if !s_ids.iter().any(|id| t_ids.contains(id)) {
                    let [s, t] = [s, t].map(|t| self.triangles[t as usize]);
                    let place = |corners: [u32; 3]| ends.map(|p| corners.map(|v| p[v as usize]));
                    if lie_apart(place(s), place(t)) {
                        return false;
                    }
                }
                !stay_apart(&moving(s), &moving(t), s_ids, t_ids, depth)
            })
            .collect();
        left.par_sort_unstable();
        left
    }

    /// Triangle `t` in a state.
    pub fn triangle(&self, t: u32, positions: &[Vec3A]) -> Triangle {
        let corners = self.triangles[t as usize];
        Triangle { at: corners.map(|v| positions[v as usize].as_dvec3()), id: self.identities[t as usize] }
    }

    /// Of `pairs`, those that cross in a state, in the order given. Exact.
    pub fn crossing_pairs(&self, pairs: &[(u32, u32)], positions: &[Vec3A]) -> Vec<(u32, u32)> {
        let crosses = |s: u32, t: u32| self.cross(&self.triangle(s, positions), &self.triangle(t, positions));
        let filtered = |keep: &(dyn Fn(u32, u32) -> bool + Sync)| {
            pairs.par_iter().with_min_len(PAIRS_PER_TASK).filter(|&&(s, t)| keep(s, t)).copied().collect()
        };
        if self.dimension == Dimension::Two {
            return filtered(&crosses);
        }
        if pairs.len() < self.triangles.len() {
            let plane = |t: u32| Plane::of(self.triangles[t as usize].map(|v| positions[v as usize]));
            return filtered(&|s, t| self.may_cross(s, t, &plane(s), &plane(t)) && crosses(s, t));
        }
        // Most pairs are neighbours that a plane sets apart, and each triangle is in about eight: its plane is kept.
        let planes: Vec<Plane> = self
            .triangles
            .par_iter()
            .with_min_len(PAIRS_PER_TASK)
            .map(|t| Plane::of(t.map(|v| positions[v as usize])))
            .collect();
        filtered(&|s, t| self.may_cross(s, t, &planes[s as usize], &planes[t as usize]) && crosses(s, t))
    }

    fn cross(&self, s: &Triangle, t: &Triangle) -> bool {
        match self.dimension {
            Dimension::Two => segments_cross(s, t),
            Dimension::Three => triangles_cross(s, t),
        }
    }

    /// False only where boxes or the plane of one triangle prove two triangles apart but for what they share.
    #[inline]
    fn may_cross(&self, s: u32, t: u32, of_s: &Plane, of_t: &Plane) -> bool {
        if !of_s.bounds().meets(&of_t.bounds()) {
            return false;
        }
        let (of_s_ids, of_t_ids) = (&self.identities[s as usize], &self.identities[t as usize]);
        !of_s.is_apart(of_t, of_s_ids, of_t_ids) && !of_t.is_apart(of_s, of_t_ids, of_s_ids)
    }

    /// All crossing pairs of a state, sorted, each as (lower, higher). Exact.
    pub fn crossings(&self, positions: &[Vec3A]) -> Vec<(u32, u32)> {
        let unproven = self.not_apart(self.candidate_pairs([positions]), [positions; 2], 0);
        self.crossing_pairs(&unproven, positions)
    }

    /// The same by comparing every pair, for tests and for whoever does not trust the tree.
    pub fn crossings_by_brute_force(&self, positions: &[DVec3]) -> Vec<(u32, u32)> {
        let triangle = |t: u32| Triangle {
            at: self.triangles[t as usize].map(|v| positions[v as usize]),
            id: self.identities[t as usize],
        };
        let n = self.triangles.len() as u32;
        (0..n)
            .into_par_iter()
            .flat_map_iter(|s| (s + 1..n).filter(move |&t| self.cross(&triangle(s), &triangle(t))).map(move |t| (s, t)))
            .collect()
    }
}

fn is_degenerate([a, b, c]: [Vec3A; 3]) -> bool {
    let [a, b, c] = [b - a, c - b, a - c].map(|e| e.as_dvec3());
    let longest = a.length_squared().max(b.length_squared()).max(c.length_squared());
    a.cross(b).length() <= f64::from(DEGENERATE) * longest
}

/// Triangles two by two, across edges that are the longest of both; those without such a neighbour are there twice.
fn triangle_pairs(triangles: &[[u32; 3]], identities: &[[u32; 3]], rest: &[Vec3A]) -> Vec<[u32; 2]> {
    let longest = |t: usize| {
        let at = triangles[t].map(|v| rest[v as usize]);
        let length = |k: &usize| at[*k].distance_squared(at[(k + 1) % 3]);
        let k = (0..3).max_by(|a, b| length(a).total_cmp(&length(b)))?;
        let [a, b] = [identities[t][k], identities[t][(k + 1) % 3]];
        Some((a.min(b), a.max(b)))
    };
    let mut edges: Vec<((u32, u32), u32)> =
        (0..triangles.len()).filter_map(|t| Some((longest(t)?, t as u32))).collect();
    edges.par_sort_unstable();
    edges
        .chunk_by(|(a, _), (b, _)| a == b)
        .flat_map(|same| same.chunks(2))
        .map(|c| [c[0].1, c[c.len() - 1].1])
        .collect()
}
