//! Even triangles of a wanted size on an implicit surface: collapse, split, flip, relax, project.
//!
//! **Theory.** Incremental remeshing (Botsch and Kobbelt 2004, "A remeshing approach to multiresolution modeling"),
//! with a size that varies over the surface and vertices that return to the *implicit* surface after each round, so
//! that nothing of the sampling lattice survives.
//!
//! **Changes from the paper.** Flips seek the Delaunay property instead of valence six (fewer slivers where the size
//! changes quickly); the projection is onto the field, not onto the input mesh.
//!
//! **Practice.** Five rounds take a few seconds for half a million triangles; it runs when the assets are baked.

use glam::Vec3;
use rayon::prelude::*;

use super::mesh::{Mesh, onto_surface};

/// Edges are split above this share of the wanted length and collapsed below the other: 4/3 and 4/5 make a split
/// edge's halves longer than a collapsed one's limit, so that the two never undo each other (Botsch and Kobbelt).
const SPLIT: f32 = 4.0 / 3.0;
const COLLAPSE: f32 = 4.0 / 5.0;

/// What [`remesh`] is asked for.
#[derive(Debug, Clone, Copy)]
pub struct Remesh {
    /// Rounds of collapse, split, flip, relax; 5 is enough, more changes little.
    pub rounds: usize,
    /// How far a vertex may travel to the surface in one round, metres.
    pub reach: f32,
}

/// Remeshes a closed manifold to edges of about `size(position)` metres with all vertices on `field = 0`.
pub fn remesh(
    mesh: &Mesh,
    field: &(impl Fn(Vec3) -> f32 + Sync),
    size: &(impl Fn(Vec3) -> f32 + Sync),
    how: Remesh,
) -> Mesh {
    let mut work = Work::new(mesh);
    for _ in 0..how.rounds {
        work.sizes = work.at.par_iter().map(|&p| size(p)).collect();
        work.collapse_short();
        work.split_long();
        work.flip();
        for _ in 0..2 {
            work.relax(field, how.reach);
        }
    }
    work.flip();
    work.relax(field, how.reach);
    work.into_mesh()
}

struct Work {
    at: Vec<Vec3>,
    triangles: Vec<Option<[u32; 3]>>,
    around: Vec<Vec<u32>>,
    sizes: Vec<f32>,
}

impl Work {
    fn new(mesh: &Mesh) -> Self {
        let mut around = vec![Vec::new(); mesh.positions.len()];
        for (i, t) in mesh.triangles.iter().enumerate() {
            t.iter().for_each(|&v| around[v as usize].push(i as u32));
        }
        let triangles = mesh.triangles.iter().copied().map(Some).collect();
        Self { at: mesh.positions.clone(), triangles, around, sizes: Vec::new() }
    }

    fn corners_around(&self, v: u32) -> impl Iterator<Item = (u32, [u32; 3])> + '_ {
        self.around[v as usize].iter().filter_map(|&t| self.triangles[t as usize].map(|c| (t, c)))
    }

    fn neighbours(&self, v: u32) -> Vec<u32> {
        let mut all: Vec<u32> = self.corners_around(v).flat_map(|(_, c)| c).filter(|&n| n != v).collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    fn normal(&self, t: [u32; 3]) -> Vec3 {
        let [a, b, c] = t.map(|i| self.at[i as usize]);
        (b - a).cross(c - a)
    }

    /// The two triangles at edge a→b: the one that runs a→b and the one that runs b→a, with their third corners.
    fn wings(&self, a: u32, b: u32) -> Option<[(u32, u32); 2]> {
        let mut wings = [None, None];
        for (t, c) in self.corners_around(a) {
            for k in 0..3 {
                let (from, to, apex) = (c[k], c[(k + 1) % 3], c[(k + 2) % 3]);
                if (from, to) == (a, b) {
                    wings[0] = Some((t, apex));
                } else if (from, to) == (b, a) {
                    wings[1] = Some((t, apex));
                }
            }
        }
        Some([wings[0]?, wings[1]?])
    }

    /// Length of edge a–b as a share of the length wanted there.
    fn stretch(&self, a: u32, b: u32) -> f32 {
        let (a, b) = (a as usize, b as usize);
        self.at[a].distance(self.at[b]) / self.sizes[a].min(self.sizes[b])
    }

    fn edges_of(&self, t: usize) -> Vec<(u32, u32)> {
        let Some(c) = self.triangles[t] else { return Vec::new() };
        [(c[0], c[1]), (c[1], c[2]), (c[2], c[0])].into_iter().filter(|(a, b)| a < b).collect()
    }

    fn collapse_short(&mut self) {
        for t in 0..self.triangles.len() {
            for (a, b) in self.edges_of(t) {
                if self.stretch(a, b) < COLLAPSE && self.may_collapse(a, b) {
                    self.collapse(a, b);
                    break;
                }
            }
        }
    }

    fn may_collapse(&self, a: u32, b: u32) -> bool {
        let Some([(_, c), (_, d)]) = self.wings(a, b) else { return false };
        let (na, nb) = (self.neighbours(a), self.neighbours(b));
        // The link condition: the ends share exactly the two wing tips, or the surface would pinch.
        let shared = na.iter().filter(|n| nb.binary_search(n).is_ok()).count();
        if shared != 2 || self.neighbours(c).len() <= 3 || self.neighbours(d).len() <= 3 || na.len() + nb.len() > 14 {
            return false;
        }
        let middle = self.at[a as usize].midpoint(self.at[b as usize]);
        let wanted = self.sizes[a as usize].min(self.sizes[b as usize]);
        let short = |n: &u32| self.at[*n as usize].distance(middle) < SPLIT * wanted.min(self.sizes[*n as usize]);
        if !na.iter().chain(&nb).filter(|&&n| n != a && n != b).all(short) {
            return false;
        }
        [(a, b), (b, a)].into_iter().all(|(end, other)| {
            self.corners_around(end).filter(|(_, t)| !t.contains(&other)).all(|(_, t)| {
                let before = self.normal(t);
                let [p, q, r] = t.map(|i| if i == end { middle } else { self.at[i as usize] });
                let after = (q - p).cross(r - p);
                after.dot(before) > 0.5 * after.length() * before.length()
            })
        })
    }

    fn collapse(&mut self, a: u32, b: u32) {
        self.at[a as usize] = self.at[a as usize].midpoint(self.at[b as usize]);
        for t in std::mem::take(&mut self.around[b as usize]) {
            let Some(corners) = self.triangles[t as usize] else { continue };
            if corners.contains(&a) {
                self.triangles[t as usize] = None;
            } else {
                self.triangles[t as usize] = Some(corners.map(|i| if i == b { a } else { i }));
                self.around[a as usize].push(t);
            }
        }
        let triangles = &self.triangles;
        self.around[a as usize].retain(|&t| triangles[t as usize].is_some());
    }

    fn split_long(&mut self) {
        let mut t = 0;
        while t < self.triangles.len() {
            for (a, b) in self.edges_of(t) {
                if self.stretch(a, b) > SPLIT {
                    self.split(a, b);
                    break;
                }
            }
            t += 1;
        }
    }

    fn split(&mut self, a: u32, b: u32) {
        let Some([(ab, c), (ba, d)]) = self.wings(a, b) else { return };
        let m = self.at.len() as u32;
        let middle = self.at[a as usize].midpoint(self.at[b as usize]);
        self.at.push(middle);
        self.sizes.push(0.5 * (self.sizes[a as usize] + self.sizes[b as usize]));
        self.around.push(Vec::new());
        for (old, corners, new) in [(ab, [a, m, c], [m, b, c]), (ba, [m, a, d], [b, m, d])] {
            let added = self.triangles.len() as u32;
            self.triangles[old as usize] = Some(corners);
            self.triangles.push(Some(new));
            self.around[b as usize].retain(|&t| t != old);
            let apex = corners[2];
            self.around[b as usize].push(added);
            self.around[apex as usize].push(added);
            self.around[m as usize].extend([old, added]);
        }
    }

    fn flip(&mut self) {
        for t in 0..self.triangles.len() {
            for (a, b) in self.edges_of(t) {
                if self.try_flip(a, b) {
                    break;
                }
            }
        }
    }

    /// Turns edge a–b into c–d where that brings the surface nearer to Delaunay (opposite angles sum to less than π).
    fn try_flip(&mut self, a: u32, b: u32) -> bool {
        let Some([(ab, c), (ba, d)]) = self.wings(a, b) else { return false };
        let angle = |apex: u32| {
            let o = self.at[apex as usize];
            (self.at[a as usize] - o).angle_between(self.at[b as usize] - o)
        };
        if angle(c) + angle(d) < std::f32::consts::PI + 0.02 || self.neighbours(c).binary_search(&d).is_ok() {
            return false;
        }
        let (one, two) = ([c, d, b], [d, c, a]);
        let (before, before2) =
            (self.normal([a, b, c]).normalize_or_zero(), self.normal([b, a, d]).normalize_or_zero());
        let (after, after2) = (self.normal(one).normalize_or_zero(), self.normal(two).normalize_or_zero());
        if [before, before2].iter().any(|n| n.dot(after) < 0.7 || n.dot(after2) < 0.7) {
            return false;
        }
        self.triangles[ab as usize] = Some(one);
        self.triangles[ba as usize] = Some(two);
        self.around[a as usize].retain(|&t| t != ab);
        self.around[b as usize].retain(|&t| t != ba);
        self.around[c as usize].push(ba);
        self.around[d as usize].push(ab);
        true
    }

    /// Each vertex towards the mean of its neighbours, within its tangent plane, then onto the surface.
    fn relax(&mut self, field: &(impl Fn(Vec3) -> f32 + Sync), reach: f32) {
        let moved = (0..self.at.len() as u32).into_par_iter().map(|v| {
            let here = self.at[v as usize];
            let normal = self.corners_around(v).map(|(_, t)| self.normal(t)).sum::<Vec3>().normalize_or_zero();
            let ring = self.neighbours(v);
            if ring.is_empty() {
                return here;
            }
            let mean = ring.iter().map(|&n| self.at[n as usize]).sum::<Vec3>() / ring.len() as f32;
            let pull = mean - here;
            let tangential = pull - normal * pull.dot(normal);
            onto_surface(field, here + tangential * 0.6, 0..3, reach)
        });
        self.at = moved.collect();
    }

    fn into_mesh(self) -> Mesh {
        let triangles = self.triangles.into_iter().flatten().collect();
        let mut mesh = Mesh { positions: self.at, triangles };
        mesh.drop_unused();
        mesh
    }
}
