//! How much of the room each place of a surface sees: what makes armpits and the gaps between fingers darker.
//!
//! # Theory
//! Ambient occlusion from a solid's own density (Evans 2006): the inside of the complex, blurred at a few scales, is looked up
//! at as many distances along the normal. Above a plane nothing is met; in a crease the far wall is. No rays, no noise, smooth
//! over the surface, and a property of the rest shape: a warp by local similarities keeps it nearly.
//!
//! # Practice
//! Once for a body, a few milliseconds for 48 cells, some hundred for 256.

use glam::{IVec3, Vec3A};
use rayon::prelude::*;

use crate::voxel::Complex;

/// Distances looked at, as shares of the longest side.
const REACHES: [f32; 3] = [0.018, 0.04, 0.085];

/// What a wall at each distance takes.
const SHARES: [f32; 3] = [0.55, 0.65, 0.65];

/// Cells on the surface stick out of it by up to one; half of that is expected.
const CRUST: f32 = 0.6;

/// Places per parallel task.
const PLACES_PER_TASK: usize = 4096;

/// A grid of densities with a margin around the complex.
struct Density {
    size: IVec3,
    margin: i32,
    values: Vec<f32>,
}

/// `[places]` share of the room that is seen, 0..=1, of surface places in cells with unit normals at rest.
pub(super) fn openness(complex: &Complex, places: &[(Vec3A, Vec3A)]) -> Vec<f32> {
    let longest = complex.grid.cells.as_vec3().max_element();
    let levels = REACHES.map(|reach| {
        let reach = (reach * longest).max(1.0);
        let mut density = Density::new(complex, 2 * reach.ceil() as i32 + 2);
        density.blur((0.5 * reach).round().max(1.0) as i32);
        (reach + CRUST, density)
    });
    let seen = |&(place, normal): &(Vec3A, Vec3A)| {
        let free = levels
            .iter()
            .zip(SHARES)
            .map(|((reach, density), share)| 1.0 - share * density.at(place + *reach * normal));
        free.product::<f32>()
    };
    places.par_iter().with_min_len(PLACES_PER_TASK).map(seen).collect()
}

impl Density {
    fn new(complex: &Complex, margin: i32) -> Self {
        let size = complex.grid.cells.as_ivec3() + 2 * margin;
        let mut density = Self { size, margin, values: vec![0.0; (size.x * size.y * size.z) as usize] };
        for &cell in &complex.cells {
            let k = density.index(cell + margin);
            density.values[k] = 1.0;
        }
        density
    }

    fn index(&self, c: IVec3) -> usize {
        ((c.z * self.size.y + c.y) * self.size.x + c.x) as usize
    }

    /// Two box filters of width `2 half + 1` along each axis: a tent.
    fn blur(&mut self, half: i32) {
        let [sx, sy, sz] = self.size.to_array().map(|s| s as usize);
        for (stride, length) in [(1, sx), (sx, sy), (sx * sy, sz)] {
            for _ in 0..2 {
                let from = std::mem::take(&mut self.values);
                let filtered = |k: usize| {
                    let along = (k / stride % length) as i32;
                    let (first, last) = ((along - half).max(0), (along + half).min(length as i32 - 1));
                    let start = k - (along - first) as usize * stride;
                    let sum: f32 = (0..=(last - first) as usize).map(|i| from[start + i * stride]).sum();
                    sum / (2 * half + 1) as f32
                };
                self.values = (0..from.len()).into_par_iter().with_min_len(PLACES_PER_TASK).map(filtered).collect();
            }
        }
    }

    /// Between cell centres, linear; 0 outside.
    fn at(&self, place: Vec3A) -> f32 {
        let p = place - 0.5 + self.margin as f32;
        let low = p.floor();
        let t = p - low;
        let low = low.as_ivec3();
        let mut sum = 0.0;
        for k in 0..8 {
            let corner = IVec3::new(k & 1, k >> 1 & 1, k >> 2);
            let c = low + corner;
            if c.cmplt(IVec3::ZERO).any() || c.cmpge(self.size).any() {
                continue;
            }
            let weight = |bit: i32, t: f32| if bit == 1 { t } else { 1.0 - t };
            sum += weight(corner.x, t.x) * weight(corner.y, t.y) * weight(corner.z, t.z) * self.values[self.index(c)];
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::voxel::Grid;
    use glam::{DVec3, UVec3};

    #[test]
    fn planes_are_open_and_gaps_are_not() {
        // A block with a slit three cells wide.
        let grid = Grid { origin: DVec3::ZERO, cell_size: 1.0, cells: UVec3::new(35, 40, 40) };
        let inside: Vec<bool> = (0..35 * 40 * 40).map(|k| !(16..19).contains(&(k % 35)) || k / 35 % 40 < 10).collect();
        let complex = Complex::from_cells(grid, &inside);
        let plane = (Vec3A::new(0.0, 20.0, 20.0), Vec3A::NEG_X);
        let slit = (Vec3A::new(16.0, 25.0, 20.0), Vec3A::X);
        let seen = openness(&complex, &[plane, slit]);
        assert!(seen[0] > 0.9, "{seen:?}");
        assert!(seen[1] < 0.6, "{seen:?}");
    }
}
