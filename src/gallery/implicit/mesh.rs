//! From a field to triangles: sampled only near the surface, surface nets, then Newton steps onto the surface.

use std::ops::Range;

use fast_surface_nets::ndshape::RuntimeShape;
use fast_surface_nets::{SurfaceNetsBuffer, surface_nets};
use glam::Vec3;
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
    let shape = RuntimeShape::<u32, 3>::new(size.into());
    let mut net = SurfaceNetsBuffer::default();
    let last = size - 1;
    surface_nets(&samples, &shape, [0; 3], last.into(), &mut net);
    let positions = net.positions.iter().map(|&q| low + Vec3::from(q) * cell).collect();
    let triangles = net.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
    Mesh { positions, triangles }
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
