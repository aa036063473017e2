//! Stars: all triangles around a vertex, proven at once not to cross each other.
//!
//! # Theory
//! Let the triangles around a vertex form one closed fan. If all of them are positively oriented seen along one
//! direction, and the fan goes around once, the star is seen without overlap, so no two of its triangles meet but in
//! what they share. Where corners move along straight lines, `n(τ) = u(τ) × v(τ)` is quadratic in τ, and positive along
//! a direction at every instant if its three Bernstein coefficients `u × v`, `(u × v' + u' × v) / 2`, `u' × v'` are;
//! the fan then goes around as often as at the start, since the ring cannot pass over the vertex.
//!
//! # Rounding
//! - *`n · d`*: each of the products goes through 2 differences, the product, the difference and the sum of two, and
//!   the product and two sums with d: n = 8. Let M be the largest component of the edges and S the sum of the
//!   components of d. A component of n is a sum of products of at most 2 M²: error ≤ 16 u M² S. In double precision
//!   1.8e-15, against [`ROUNDING`]; in single precision 9.5e-7, against [`SINGLE_ROUNDING`]. The components of a unit
//!   vector sum up to √3, of a rounded one to less than [`SUM_OF_UNIT`].
//! - *Where a motion is cut*, edges are off by e = 2 · [`MIDPOINT`] · X (page `motion`), X the largest coordinate. A
//!   product of two changes by at most 2 M e + e², n by twice that in each component: 2 e (2 M + e) S more.
//! - *The plane that the turns are counted at*, across a = d × c with c = (0.618…, 0.755…, 0.219…): a is rounded by 2 u
//!   in each product, which moves a · w by at most 2 u · 1.374 S M = 4.8 u M (1.374 is the sum of the two largest
//!   components of c, S ≤ 1.74); evaluating it on a difference has n = 4, on terms of at most 1.374 S M: 9.6 u M. In
//!   all 14.4 u M = 8.6e-7 M, against 1.8 · 6e-6 M.
//!
//! # Practice
//! Most pairs of triangles with near boxes are neighbours, and nearly all stars are proven with a dozen products each.
//! What is not proven is left to the exact predicates: a star never says that something crosses. So f32 is enough here.
//! Where normals leave the range of f32 their sum has no direction, and nothing is proven.

use glam::{DVec3, Vec3A};
use rayon::prelude::*;

/// Stars per parallel task.
const STARS_PER_TASK: usize = 512;

/// Bounds the rounding of products of up to three differences of coordinates, relative to the product of their largest
/// components: 2.8e-14 at most, for volumes that were cut (pages `elements`, `motion`, `star` and `segments` count),
/// and room.
pub(super) const ROUNDING: f64 = 1.0e-13;

/// Bounds how far off a coordinate is at an instant that a motion was cut at, relative to itself: 10.1 roundings of
/// 2⁻⁵³ (page `motion`), and room.
pub(super) const MIDPOINT: f64 = 12.0 * 0.5 * f64::EPSILON;

/// The bounds of a proof in double precision; tests lower them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rounding {
    /// As [`ROUNDING`].
    pub product: f64,
    /// As [`MIDPOINT`].
    pub midpoint: f64,
}

impl Rounding {
    pub const PROVEN: Self = Self { product: ROUNDING, midpoint: MIDPOINT };
}

/// Closed fans of a surface, by vertex identity.
#[derive(Debug, Clone)]
pub(super) struct Stars {
    /// `[identities + 1]` compressed rows; empty where the triangles around a vertex are not one closed fan.
    start: Vec<u32>,
    /// Triangles around each vertex, and which of their corners it is.
    corners: Vec<(u32, u8)>,
}

impl Stars {
    /// Finds the closed fans. `identities` is `[triangles]`.
    pub fn new(identities: &[[u32; 3]]) -> Self {
        let count = identities.iter().flatten().max().map_or(0, |&m| m as usize + 1);
        let mut all_start = vec![0_u32; count + 1];
        for &v in identities.iter().flatten() {
            all_start[v as usize + 1] += 1;
        }
        for v in 0..count {
            all_start[v + 1] += all_start[v];
        }
        let mut cursor = all_start.clone();
        let mut all = vec![(0_u32, 0_u8); 3 * identities.len()];
        for (t, corners) in identities.iter().enumerate() {
            for (k, &v) in corners.iter().enumerate() {
                all[cursor[v as usize] as usize] = (t as u32, k as u8);
                cursor[v as usize] += 1;
            }
        }
        let (mut start, mut corners) = (vec![0_u32], Vec::with_capacity(all.len()));
        for v in 0..count {
            let around = &all[all_start[v] as usize..all_start[v + 1] as usize];
            if is_closed_fan(identities, around) {
                corners.extend_from_slice(around);
            }
            start.push(corners.len() as u32);
        }
        Self { start, corners }
    }

    /// `[identities]` stars whose triangles are proven not to cross each other, in one state or at every instant
    /// between two.
    pub fn proven<const ENDS: usize>(&self, triangles: &[[u32; 3]], ends: [&[Vec3A]; ENDS]) -> Vec<bool> {
        self.proven_with(SINGLE_ROUNDING, triangles, ends)
    }

    /// As [`proven`](Self::proven), with a rounding bound.
    pub fn proven_with<const ENDS: usize>(
        &self,
        rounding: f32,
        triangles: &[[u32; 3]],
        ends: [&[Vec3A]; ENDS],
    ) -> Vec<bool> {
        let normals: Vec<Facing> = triangles
            .par_iter()
            .with_min_len(STARS_PER_TASK)
            .map(|t| Facing::of(ends.map(|p| t.map(|v| p[v as usize]))))
            .collect();
        (0..self.start.len() - 1)
            .into_par_iter()
            .with_min_len(STARS_PER_TASK)
            .map(|v| {
                let fan = &self.corners[self.start[v] as usize..self.start[v + 1] as usize];
                !fan.is_empty() && is_seen_whole(rounding, fan, triangles, &normals, ends[0])
            })
            .collect()
    }
}

/// Whether the triangles around a vertex (and its corner in each) go around it once, each edge shared by two of them in
/// opposite directions.
fn is_closed_fan(identities: &[[u32; 3]], around: &[(u32, u8)]) -> bool {
    let ring = |&(t, k): &(u32, u8)| {
        let id = identities[t as usize];
        (id[usize::from(k)], id[(usize::from(k) + 1) % 3], id[(usize::from(k) + 2) % 3])
    };
    if around.len() < 3 || around.iter().map(ring).any(|(v, a, b)| v == a || v == b || a == b) {
        return false;
    }
    let (_, first, _) = ring(&around[0]);
    let mut at = first;
    for step in 1..=around.len() {
        let mut onward = around.iter().map(ring).filter(|&(_, a, _)| a == at);
        let (Some((_, _, next)), None) = (onward.next(), onward.next()) else { return false };
        at = next;
        if at == first {
            return step == around.len();
        }
    }
    false
}

/// Bernstein coefficients of a triangle's normal (all the same at a single state).
#[derive(Clone, Copy)]
pub(super) struct Normals {
    pub coefficients: [DVec3; 3],
    /// Bounds the error of `coefficients · d`, per sum of the components of d.
    error: f64,
}

impl Normals {
    #[inline]
    pub fn of(ends: [[DVec3; 3]; 2], rounding: Rounding) -> Self {
        let largest = |v: DVec3, m: DVec3| m.max(v.abs());
        let edges = ends.map(|[a, b, c]| [b - a, c - a]);
        let longest = edges.iter().flatten().fold(DVec3::ZERO, |m, e| largest(*e, m)).max_element();
        let furthest = ends.iter().flatten().fold(DVec3::ZERO, |m, p| largest(*p, m)).max_element();
        let [[u, v], [x, y]] = edges;
        let coefficients = [u.cross(v), 0.5 * (u.cross(y) + x.cross(v)), x.cross(y)];
        let misplaced = 2.0 * rounding.midpoint * furthest;
        let error = rounding.product * longest * longest + 2.0 * misplaced * (2.0 * longest + misplaced);
        Self { coefficients, error }
    }

    /// Whether the triangle is positively oriented along a direction at every instant; never wrongly true.
    #[inline]
    pub fn are_along(&self, direction: DVec3) -> bool {
        let bound = self.error * direction.abs().element_sum();
        self.coefficients.iter().all(|n| n.dot(direction) > bound)
    }
}

/// The same as [`Normals`] in f32.
#[derive(Clone, Copy)]
pub(super) struct Facing {
    coefficients: [Vec3A; 3],
    largest: f32,
}

/// The same in single precision: 9.5e-7 at most, for normals, and room.
pub(super) const SINGLE_ROUNDING: f32 = 6.0e-6;

impl Facing {
    #[inline]
    pub fn of<const ENDS: usize>(ends: [[Vec3A; 3]; ENDS]) -> Self {
        let edges = ends.map(|[a, b, c]| [b - a, c - a]);
        let largest = edges.iter().flatten().fold(Vec3A::ZERO, |m, e| m.max(e.abs())).max_element();
        let [[u, v], [x, y]] = [edges[0], edges[ENDS - 1]];
        let start = u.cross(v);
        let coefficients = if ENDS == 1 { [start; 3] } else { [start, 0.5 * (u.cross(y) + x.cross(v)), x.cross(y)] };
        Self { coefficients, largest }
    }

    fn sum(&self) -> Vec3A {
        self.coefficients[0] + self.coefficients[1] + self.coefficients[2]
    }

    /// Whether the triangle is positively oriented along a unit vector at every instant; never wrongly true. Where
    /// products leave the range of f32, it is not proven.
    #[inline]
    pub fn is_along(&self, rounding: f32, direction: Vec3A) -> bool {
        let bound = rounding * self.largest * self.largest * SUM_OF_UNIT;
        is_in_range(bound) && self.coefficients.iter().all(|n| n.dot(direction) > bound)
    }
}

/// Whether a bound of rounding in f32 is large enough to hold what is lost below the range of f32 as well, and small
/// enough that nothing it bounds has left that range above.
#[inline]
pub(super) fn is_in_range(bound: f32) -> bool {
    bound > f32::MIN_POSITIVE && bound < LARGEST_BOUND
}

/// Products that are bounded by a hundred thousand times this stay finite.
const LARGEST_BOUND: f32 = 1.0e30;

/// The components of a unit vector sum up to at most this, and room.
const SUM_OF_UNIT: f32 = 1.8;

/// Whether a closed fan is seen without overlap along the sum of its normals. Never wrongly true.
fn is_seen_whole(
    rounding: f32,
    fan: &[(u32, u8)],
    triangles: &[[u32; 3]],
    normals: &[Facing],
    start: &[Vec3A],
) -> bool {
    let direction = fan.iter().map(|&(t, _)| normals[t as usize].sum()).sum::<Vec3A>().normalize_or_zero();
    if !fan.iter().all(|&(t, _)| normals[t as usize].is_along(rounding, direction)) {
        return false;
    }
    // Every triangle turns the same way by less than half a turn, so each time around passes once from behind a plane to
    // before it, where the direction lies in the plane. It is one that no edge of a lattice lies in.
    let across = direction.cross(Vec3A::new(0.618_034, 0.754_878, 0.219_372));
    let mut turns = 0;
    for &(t, k) in fan {
        let k = usize::from(k);
        let at = triangles[t as usize].map(|v| start[v as usize]);
        let bound = rounding * normals[t as usize].largest * SUM_OF_UNIT;
        let [a, b] = [1, 2].map(|step| across.dot(at[(k + step) % 3] - at[k]));
        if a.abs() <= bound || b.abs() <= bound {
            return false;
        }
        turns += u32::from(a < 0.0 && b > 0.0);
    }
    turns == 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certificate::Surface;

    /// A fan of `count` triangles around the origin that goes around `turns` times, its ring climbing with the angle
    /// but for the last step, which leads back.
    fn fan(count: u32, turns: f32) -> (Vec<[u32; 3]>, Vec<Vec3A>) {
        let ring = (0..count).map(|k| {
            let part = k as f32 / count as f32;
            let (sin, cos) = (std::f32::consts::TAU * turns * part + 0.1).sin_cos();
            Vec3A::new(cos, sin, 0.3 + 0.2 * part)
        });
        let positions = std::iter::once(Vec3A::ZERO).chain(ring).collect();
        ((0..count).map(|k| [0, 1 + k, 1 + (k + 1) % count]).collect(), positions)
    }

    fn is_proven(triangles: &[[u32; 3]], from: &[Vec3A], to: &[Vec3A]) -> [bool; 2] {
        let stars = Stars::new(triangles);
        [stars.proven(triangles, [from])[0], stars.proven(triangles, [from, to])[0]]
    }

    #[test]
    fn a_fan_around_once_is_proven_also_while_it_opens() {
        let (triangles, positions) = fan(8, 1.0);
        let opened: Vec<Vec3A> = positions.iter().map(|p| *p * Vec3A::new(1.0, 2.0, -1.0)).collect();
        assert_eq!(is_proven(&triangles, &positions, &opened), [true, true]);
        assert!(Surface::new(triangles, &positions).crossings(&positions).is_empty());
    }

    #[test]
    fn sabotage_a_fan_around_twice_or_turned_over_is_not_proven() {
        let (triangles, positions) = fan(8, 2.0);
        assert_eq!(is_proven(&triangles, &positions, &positions), [false, false]);
        let surface = Surface::new(triangles, &positions);
        let exact: Vec<DVec3> = positions.iter().map(|p| p.as_dvec3()).collect();
        assert!(!surface.crossings(&positions).is_empty());
        assert_eq!(surface.crossings(&positions), surface.crossings_by_brute_force(&exact));

        // Sound at both ends, flat on a line half-way.
        let (triangles, positions) = fan(8, 1.0);
        let over: Vec<Vec3A> = positions.iter().map(|p| *p * Vec3A::new(1.0, -1.0, 1.0)).collect();
        assert_eq!(is_proven(&triangles, &positions, &over), [true, false]);
    }

    #[test]
    fn what_is_no_closed_fan_is_not_proven() {
        let (triangles, positions) = fan(8, 1.0);
        assert_eq!(is_proven(&triangles[..7], &positions, &positions), [false, false]);
        let mut flipped = triangles.clone();
        flipped[3].swap(1, 2);
        assert_eq!(is_proven(&flipped, &positions, &positions), [false, false]);
        let twice = [triangles.clone(), triangles].concat();
        assert_eq!(is_proven(&twice, &positions, &positions), [false, false]);
    }
}
