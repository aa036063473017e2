//! From a field to triangles: sampled only near the surface, marching tetrahedra, then Newton steps onto the surface.
//!
//! Tetrahedra and not surface nets, because each cube cut into six gives a closed manifold always; nets pinch two
//! sheets into one edge where a crease is narrower than a cell (an eyelid's corner, the web between two toes). Their
//! slivers do not matter: [`remesh`](super::remesh()) follows.

use std::collections::HashMap;
use std::ops::Range;

use glam::{UVec3, Vec3};
use rayon::prelude::*;

use super::gradient;

/// A triangle mesh, counter-clockwise seen from outside.
#[derive(Debug, Clone, Default)]
pub struct Mesh {
    /// `[vertices]`, metres.
    pub positions: Vec<Vec3>,
    /// `[triangles]` indices into `positions`.
    pub triangles: Vec<[u32; 3]>,
}

/// Edge of the blocks that are skipped as a whole when the field says that the surface is far, in cells.
const BLOCK: usize = 8;
/// A block is skipped where |field| exceeds this many times its half-diagonal. The fields overestimate distance by
/// less than 2 (flat ovals, seen from their side); smaller loses pieces of surface, larger only costs time.
const TRUST: f32 = 2.2;

/// The surface `field = 0` inside the box `low..high`, at cells of `cell` metres.
pub fn polygonize(field: &(impl Fn(Vec3) -> f32 + Sync), low: Vec3, high: Vec3, cell: f32) -> Mesh {
    let blocks = ((high - low) / (cell * BLOCK as f32)).ceil().as_uvec3() + 1;
    let size = blocks * BLOCK as u32;
    let layer = (size.x * size.y) as usize;
    let mut samples = vec![1.0_f32; layer * size.z as usize];
    let at = |x: usize, y: usize, z: usize| low + Vec3::new(x as f32, y as f32, z as f32) * cell;
    samples.par_chunks_mut(layer * BLOCK).enumerate().for_each(|(slab, out)| {
        for block in 0..(blocks.x * blocks.y) as usize {
            let (bx, by) = (block % blocks.x as usize * BLOCK, block / blocks.x as usize * BLOCK);
            let half = 0.5 * BLOCK as f32;
            let middle = field(at(bx, by, slab * BLOCK) + Vec3::splat(half * cell));
            let far = middle.abs() > TRUST * half * cell * 3.0_f32.sqrt();
            for z in 0..BLOCK {
                for y in by..by + BLOCK {
                    for x in bx..bx + BLOCK {
                        let value = if far { middle } else { field(at(x, y, slab * BLOCK + z)) };
                        out[z * layer + y * size.x as usize + x] = value;
                    }
                }
            }
        }
    });
    march(&samples, size, |q| low + q * cell)
}

/// The six tetrahedra of a cube by corner number (bit 0 = x, 1 = y, 2 = z), all of positive volume, and the same in
/// each cube, so that neighbours agree on their common face.
const TETRAHEDRA: [[usize; 4]; 6] =
    [[0, 1, 3, 7], [0, 1, 7, 5], [0, 2, 7, 3], [0, 2, 6, 7], [0, 4, 5, 7], [0, 4, 7, 6]];

/// Even orders of a tetrahedron's corners with the inner ones first, by the bit mask of inner corners; a mask of three
/// inner corners takes the order of its complement, turned around.
const ORDERS: [[usize; 4]; 16] = {
    let mut orders = [[0, 1, 2, 3]; 16];
    orders[0b0010] = [1, 0, 3, 2];
    orders[0b0100] = [2, 0, 1, 3];
    orders[0b1000] = [3, 0, 2, 1];
    orders[0b0101] = [0, 2, 3, 1];
    orders[0b1001] = [0, 3, 1, 2];
    orders[0b0110] = [1, 2, 0, 3];
    orders[0b1010] = [1, 3, 2, 0];
    orders[0b1100] = [2, 3, 0, 1];
    orders
};

fn march(samples: &[f32], size: UVec3, place: impl Fn(Vec3) -> Vec3) -> Mesh {
    let (row, layer) = (size.x as usize, (size.x * size.y) as usize);
    let mut mesh = Mesh::default();
    let mut on_edge: HashMap<(usize, usize), u32> = HashMap::new();
    for z in 0..size.z as usize - 1 {
        for y in 0..size.y as usize - 1 {
            for x in 0..row - 1 {
                let nodes: [usize; 8] =
                    std::array::from_fn(|k| x + (k & 1) + (y + (k >> 1 & 1)) * row + (z + (k >> 2)) * layer);
                let inner = nodes.iter().filter(|&&n| samples[n] < 0.0).count();
                if inner == 0 || inner == 8 {
                    continue;
                }
                let mut vertex = |a: usize, b: usize| {
                    let (a, b) = (a.min(b), a.max(b));
                    *on_edge.entry((a, b)).or_insert_with(|| {
                        let at = |n: usize| Vec3::new((n % row) as f32, (n % layer / row) as f32, (n / layer) as f32);
                        // Kept off the nodes, where vertices would coincide.
                        let share = (samples[a] / (samples[a] - samples[b])).clamp(0.05, 0.95);
                        mesh.positions.push(place(at(a).lerp(at(b), share)));
                        mesh.positions.len() as u32 - 1
                    })
                };
                for corners in TETRAHEDRA {
                    let t = corners.map(|k| nodes[k]);
                    let mask = (0..4).filter(|&k| samples[t[k]] < 0.0).fold(0, |m, k| m | 1 << k);
                    let flipped = u32::count_ones(mask) == 3;
                    let [a, b, c, d] = ORDERS[if flipped { 15 - mask } else { mask } as usize].map(|k| t[k]);
                    match u32::count_ones(mask) {
                        1 | 3 => {
                            let [p, q, r] = [vertex(a, b), vertex(a, c), vertex(a, d)];
                            mesh.triangles.push(if flipped { [p, r, q] } else { [p, q, r] });
                        }
                        2 => {
                            let [p, q, r, s] = [vertex(a, c), vertex(a, d), vertex(b, d), vertex(b, c)];
                            mesh.triangles.extend([[p, q, r], [p, r, s]]);
                        }
                        _ => {}
                    }
                }
            }
        }
    }
    mesh
}

impl Mesh {
    /// Moves each vertex onto the surface by Newton steps of at most `reach` metres in all.
    pub fn project(&mut self, field: &(impl Fn(Vec3) -> f32 + Sync), steps: Range<u32>, reach: f32) {
        self.positions.par_iter_mut().for_each(|p| *p = onto_surface(field, *p, steps.clone(), reach));
    }

    /// `[vertices]` area-weighted normals, unit length (zero for a vertex of no triangle).
    pub fn normals(&self) -> Vec<Vec3> {
        let mut normals = vec![Vec3::ZERO; self.positions.len()];
        for t in &self.triangles {
            let [a, b, c] = t.map(|i| self.positions[i as usize]);
            let n = (b - a).cross(c - a);
            for &i in t {
                normals[i as usize] += n;
            }
        }
        normals.into_iter().map(Vec3::normalize_or_zero).collect()
    }

    /// Six times the enclosed volume: positive when the triangles face outward.
    pub fn signed_volume(&self) -> f64 {
        let at = |i: u32| self.positions[i as usize].as_dvec3();
        self.triangles.iter().map(|t| at(t[0]).dot(at(t[1]).cross(at(t[2])))).sum()
    }

    /// Keeps the largest connected piece and drops unused vertices.
    pub fn keep_largest(&mut self) {
        let mut parent: Vec<u32> = (0..self.positions.len() as u32).collect();
        fn root(parent: &mut [u32], mut i: u32) -> u32 {
            while parent[i as usize] != i {
                parent[i as usize] = parent[parent[i as usize] as usize];
                i = parent[i as usize];
            }
            i
        }
        for t in &self.triangles {
            let r = root(&mut parent, t[0]);
            for &other in &t[1..] {
                let o = root(&mut parent, other);
                parent[o as usize] = r;
            }
        }
        let mut sizes = vec![0_u32; parent.len()];
        for i in 0..parent.len() as u32 {
            sizes[root(&mut parent, i) as usize] += 1;
        }
        let largest = (0..sizes.len()).max_by_key(|&i| sizes[i]).unwrap_or(0) as u32;
        let kept: Vec<[u32; 3]> =
            self.triangles.iter().copied().filter(|t| root(&mut parent, t[0]) == largest).collect();
        self.triangles = kept;
        self.drop_unused();
    }

    /// Drops vertices that no triangle uses; the order of the others stays.
    pub fn drop_unused(&mut self) {
        let mut index = vec![u32::MAX; self.positions.len()];
        for t in &self.triangles {
            t.iter().for_each(|&i| index[i as usize] = 0);
        }
        let mut kept = Vec::with_capacity(self.positions.len());
        for (i, slot) in index.iter_mut().enumerate() {
            if *slot == 0 {
                *slot = kept.len() as u32;
                kept.push(self.positions[i]);
            }
        }
        self.positions = kept;
        self.triangles.iter_mut().for_each(|t| *t = t.map(|i| index[i as usize]));
    }
}

/// The point of the surface near `p`, by Newton steps; `p` itself moved at most `reach`.
pub(super) fn onto_surface(field: &impl Fn(Vec3) -> f32, p: Vec3, steps: Range<u32>, reach: f32) -> Vec3 {
    // A tenth of a millimetre: large against the rounding of f32 at 1 m (1e-7), small against the finest detail (1 mm).
    const STEP: f32 = 1e-4;
    let mut q = p;
    for _ in steps {
        let g = gradient(field, q, STEP);
        let move_by = g * (field(q) / g.length_squared().max(0.05));
        q -= move_by.clamp_length_max(reach * 0.5);
    }
    p + (q - p).clamp_length_max(reach)
}
