//! Contact: spheres around boundary nodes, found by spatial hashing (Teschner et al. 2003), as springs of the global step.
//!
//! Radius `r_i` is the least target length of the edges at node i. A pair of boundary nodes that are not near each other
//! *within* the complex and come closer than `d = max(r_i, r_j)` is pulled to that distance along its direction.

use glam::{IVec3, Vec3A};
use rayon::prelude::*;

use crate::voxel::{CHUNK, Complex};

/// Weight of a contact relative to an edge with one cell around it. Below about 5 contacts give way until the guard
/// must stop them; above about 20 they shake.
pub const CONTACT_WEIGHT: f32 = 10.0;

/// One side of a contact pair.
#[derive(Debug, Clone, Copy)]
pub struct Contact {
    /// The other node.
    pub other: u32,
    /// Unit vector from the other node to this one.
    pub direction: Vec3A,
    /// How much too close they are, in cells, > 0.
    pub depth: f32,
}

/// All contacts of a state, by node.
#[derive(Debug, Clone, Default)]
pub struct Contacts {
    /// `[nodes + 1]` compressed rows; empty if there is no contact at all.
    start: Vec<u32>,
    list: Vec<Contact>,
}

impl Contacts {
    /// Contacts of node i.
    #[inline]
    pub fn of(&self, i: usize) -> &[Contact] {
        if self.list.is_empty() { &[] } else { &self.list[self.start[i] as usize..self.start[i + 1] as usize] }
    }

    /// Number of pairs.
    pub fn len(&self) -> usize {
        self.list.len() / 2
    }

    /// Whether nothing touches.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }
}

/// Spatial hash over points: buckets by hashed cell, points in each bucket in index order.
struct SpatialHash {
    cell: f32,
    start: Vec<u32>,
    entries: Vec<u32>,
}

impl SpatialHash {
    fn new(points: &[u32], positions: &[Vec3A], cell: f32) -> Self {
        let buckets = (2 * points.len()).next_power_of_two();
        let mut start = vec![0_u32; buckets + 1];
        let of: Vec<u32> = points
            .par_iter()
            .with_min_len(CHUNK)
            .map(|&p| Self::bucket(Self::cell_of(positions[p as usize], cell), buckets) as u32)
            .collect();
        for &b in &of {
            start[b as usize + 1] += 1;
        }
        for b in 0..buckets {
            start[b + 1] += start[b];
        }
        let mut cursor = start.clone();
        let mut entries = vec![0_u32; points.len()];
        for (&p, &b) in points.iter().zip(&of) {
            entries[cursor[b as usize] as usize] = p;
            cursor[b as usize] += 1;
        }
        Self { cell, start, entries }
    }

    fn cell_of(p: Vec3A, cell: f32) -> IVec3 {
        (p / cell).floor().as_ivec3()
    }

    fn bucket(c: IVec3, buckets: usize) -> usize {
        // The primes of Teschner et al.
        let h = (c.x.wrapping_mul(73_856_093)) ^ (c.y.wrapping_mul(19_349_663)) ^ (c.z.wrapping_mul(83_492_791));
        let h = (h as u32).wrapping_mul(0x9E37_79B1);
        (h >> 8) as usize & (buckets - 1)
    }

    /// Calls `visit` for each entry in cells that meet the ball; an entry may come twice when two cells share a bucket.
    fn near(&self, p: Vec3A, radius: f32, mut visit: impl FnMut(u32)) {
        // A thousandth of a cell more, so that rounding of the ball's ends loses no point on its rim.
        let reach = radius + 1.0e-3 * self.cell;
        let (low, high) = (Self::cell_of(p - reach, self.cell), Self::cell_of(p + reach, self.cell));
        let buckets = self.start.len() - 1;
        for z in low.z..=high.z {
            for y in low.y..=high.y {
                for x in low.x..=high.x {
                    let b = Self::bucket(IVec3::new(x, y, z), buckets);
                    for &e in &self.entries[self.start[b] as usize..self.start[b + 1] as usize] {
                        visit(e);
                    }
                }
            }
        }
    }
}

/// Whether i and j are the same node, neighbours, or have a common neighbour: then they are near each other within the
/// complex, and their distance is the business of the elements between them.
pub fn near_within(complex: &Complex, i: u32, j: u32) -> bool {
    let rest = (complex.rest[i as usize] - complex.rest[j as usize]).abs();
    if rest.max_element() > 2.5 {
        return false;
    }
    let (a, b) = (&complex.neighbours[i as usize], &complex.neighbours[j as usize]);
    i == j || a.contains(&j) || a.iter().any(|n| *n != i && b.contains(n) && *n != j)
}

/// Finds the contacts of a state. `boundary` lists the boundary nodes, `radius` is `[nodes]`.
pub fn find(complex: &Complex, boundary: &[u32], radius: &[f32], positions: &[Vec3A]) -> Contacts {
    among(complex, &near(complex, boundary, radius, positions, 1.0), radius, positions)
}

/// Pairs of boundary nodes nearer to each other than `reach` times the larger radius, but for those that are near
/// within the complex.
pub fn near(complex: &Complex, boundary: &[u32], radius: &[f32], positions: &[Vec3A], reach: f32) -> Vec<(u32, u32)> {
    if boundary.is_empty() {
        return Vec::new();
    }
    let mean = boundary.iter().map(|&i| f64::from(radius[i as usize])).sum::<f64>() / boundary.len() as f64;
    let hash = SpatialHash::new(boundary, positions, 1.25 * reach * mean as f32);
    // Each pair is found from its end with the larger radius.
    let found: Vec<Vec<(u32, u32)>> = boundary
        .par_chunks(CHUNK / 8)
        .map(|nodes| {
            let mut pairs = Vec::new();
            for &i in nodes {
                let (p, r) = (positions[i as usize], radius[i as usize]);
                let within = reach * r;
                hash.near(p, within, |j| {
                    let rj = radius[j as usize];
                    let first = r > rj || (r == rj && i < j);
                    if first
                        && (positions[j as usize] - p).length_squared() < within * within
                        && !near_within(complex, i, j)
                    {
                        pairs.push((i, j));
                    }
                });
            }
            pairs.sort_unstable();
            pairs.dedup();
            pairs
        })
        .collect();
    found.concat()
}

/// The contacts of a state among pairs of boundary nodes.
pub fn among(complex: &Complex, pairs: &[(u32, u32)], radius: &[f32], positions: &[Vec3A]) -> Contacts {
    let too_close = |&(i, j): &(u32, u32)| {
        let (i, j) = (i as usize, j as usize);
        let most = radius[i].max(radius[j]);
        (positions[i] - positions[j]).length_squared() < most * most
    };
    let pairs: Vec<(u32, u32)> = pairs.iter().copied().filter(too_close).collect();
    if pairs.is_empty() {
        return Contacts::default();
    }
    let mut start = vec![0_u32; complex.nodes() + 1];
    for &(i, j) in &pairs {
        start[i as usize + 1] += 1;
        start[j as usize + 1] += 1;
    }
    for i in 0..complex.nodes() {
        start[i + 1] += start[i];
    }
    let mut cursor = start.clone();
    let nothing = Contact { other: 0, direction: Vec3A::ZERO, depth: 0.0 };
    let mut list = vec![nothing; 2 * pairs.len()];
    for &(i, j) in &pairs {
        let offset = positions[i as usize] - positions[j as usize];
        let distance = offset.length();
        let direction = if distance > 0.0 { offset / distance } else { Vec3A::X };
        let depth = radius[i as usize].max(radius[j as usize]) - distance;
        for (node, other, direction) in [(i, j, direction), (j, i, -direction)] {
            list[cursor[node as usize] as usize] = Contact { other, direction, depth };
            cursor[node as usize] += 1;
        }
    }
    Contacts { start, list }
}
