//! How much of the room's light a body takes from the floor around it: the soft darkness under its soles.
//!
//! # Theory
//! A patch A of the surface at distance r takes `A cos θ cos θ' / (π r²)` of a floor point's sky (the form factor of radiosity).
//! Patches do not hide each other here, so the sum is bent towards 1: `1 − exp(−Σ)`. Only patches that look down count.

use glam::Vec3A;
use rayon::prelude::*;

/// Texels along each side of the map.
pub(super) const SIDE: usize = 96;

/// Half the map's side, view units: a body of height 2 with its shade.
pub(super) const REACH: f32 = 2.6;

/// Side of the cubes that the surface is cut into, each with its patch, view units: about a texel. Smaller cost time, larger
/// show as spots under fine parts.
const CUBE: f32 = 0.06;

/// `[SIDE × SIDE]` x fastest, share of the sky taken, 0..=1. `positions`: `[vertices]`, view space, standing on y = 0.
pub(super) fn shade(triangles: &[[u32; 3]], positions: &[Vec3A]) -> Vec<f32> {
    let patches = patches(triangles, positions);
    let texel = 2.0 * REACH / SIDE as f32;
    (0..SIDE * SIDE)
        .into_par_iter()
        .with_min_len(SIDE)
        .map(|k| {
            let at = |i: usize| (i as f32 + 0.5) * texel - REACH;
            let floor = Vec3A::new(at(k % SIDE), 0.0, at(k / SIDE));
            let sum: f32 = patches
                .iter()
                .map(|&(centre, downward)| {
                    let d = centre - floor;
                    let square = d.length_squared();
                    // cos θ of the floor is d.y / r, cos θ' times the area is −d · (area vector) / r; a patch is never
                    // nearer than its own size or a texel's.
                    let area = downward.length();
                    let facing = (d.dot(downward)).max(0.0) * d.y.max(0.0);
                    facing
                        / (std::f32::consts::PI * (square * square).max(1.0e-6)
                            + area * area
                            + 0.3 * texel * texel * square)
                })
                .sum();
            1.0 - (-sum).exp()
        })
        .collect()
}

/// Centres and downward area vectors (n · area, turned over) of what looks down in each cube of space.
fn patches(triangles: &[[u32; 3]], positions: &[Vec3A]) -> Vec<(Vec3A, Vec3A)> {
    let mut facing_down: Vec<([i32; 3], u32)> = triangles
        .par_iter()
        .enumerate()
        .filter_map(|(t, triangle)| {
            let [a, b, c] = triangle.map(|v| positions[v as usize]);
            let cube = ((a + b + c) / (3.0 * CUBE)).floor().as_ivec3().to_array();
            ((b - a).cross(c - a).y < 0.0).then_some((cube, t as u32))
        })
        .collect();
    facing_down.par_sort_unstable();
    let patch = |triangle_of: &[([i32; 3], u32)]| {
        let (mut centre, mut downward, mut weight) = (Vec3A::ZERO, Vec3A::ZERO, 0.0);
        for &(_, t) in triangle_of {
            let [a, b, c] = triangles[t as usize].map(|v| positions[v as usize]);
            let area = 0.5 * (b - a).cross(c - a);
            let size = area.length();
            centre += size * (a + b + c) / 3.0;
            downward -= area;
            weight += size;
        }
        (centre / weight, downward)
    };
    facing_down.chunk_by(|(a, _), (b, _)| a == b).map(patch).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A level square of side 1 at a height, looking down or up.
    fn square(height: f32, is_down: bool) -> (Vec<[u32; 3]>, Vec<Vec3A>) {
        let at = |x: f32, z: f32| Vec3A::new(x, height, z);
        let positions = vec![at(-0.5, -0.5), at(0.5, -0.5), at(0.5, 0.5), at(-0.5, 0.5)];
        (if is_down { vec![[0, 1, 2], [0, 2, 3]] } else { vec![[0, 2, 1], [0, 3, 2]] }, positions)
    }

    #[test]
    fn it_is_darkest_below_and_fades() {
        let (triangles, positions) = square(0.4, true);
        let map = shade(&triangles, &positions);
        let at = |x: usize| map[SIDE / 2 * SIDE + x];
        assert!(at(SIDE / 2) > 0.2 && at(SIDE / 2) < 1.0);
        assert!(at(SIDE / 2) > at(SIDE / 2 + 12) && at(SIDE / 2 + 12) > at(SIDE - 1));
        assert!(at(SIDE - 1) < 0.02);
        // Two feet, their triangles in turn: darkest below each, not between.
        let feet = |x: f32| [0.3, 0.31].map(|z| [0.0, 0.02].map(|y| Vec3A::new(x + y, 0.02, z)));
        let (mut triangles, mut positions) = (Vec::new(), Vec::new());
        for [[a, b], [c, d]] in [feet(-0.5), feet(0.5)] {
            let first = positions.len() as u32;
            positions.extend([a, b, c, d]);
            triangles.extend([[first, first + 1, first + 2], [first + 1, first + 3, first + 2]]);
        }
        triangles.swap(1, 2);
        let map = shade(&triangles, &positions);
        let at = |x: f32, z: f32| {
            let texel = |x: f32| ((x + REACH) / (2.0 * REACH) * SIDE as f32) as usize;
            map[texel(z) * SIDE + texel(x)]
        };
        assert!(at(-0.5, 0.3) > 10.0 * at(0.0, 0.3) && at(0.5, 0.3) > 10.0 * at(0.0, 0.3));
        // What looks up takes nothing.
        let (triangles, positions) = square(0.4, false);
        assert!(shade(&triangles, &positions).iter().all(|&s| s == 0.0));
    }
}
