//! Fields that a state brings with it: the size it gives each place.

use glam::Vec3A;
use rayon::prelude::*;

use super::Body;
use crate::{certificate::volume_ratios, voxel::Complex};

/// Sizes below this are drawn as it: an element pressed flat or turned over has none.
const LEAST: f32 = 1.0e-3;

/// `[nodes]` linear size factor of a state around each node, > 0: cube root of the mean volume ratio of the cells there. For
/// [`Looks::voxels`](super::Looks::voxels).
pub fn sizes(complex: &Complex, state: &[Vec3A]) -> Vec<f32> {
    let volumes = volume_ratios(complex, state);
    let per_cell = (volumes.len() / complex.cells.len().max(1)).max(1);
    let of_cell: Vec<f32> = volumes.par_chunks(per_cell).map(|v| v.iter().sum::<f32>() / v.len() as f32).collect();
    let of_node = |cells: &[u32; 8]| {
        let around = cells.iter().filter_map(|&cell| of_cell.get(cell as usize));
        let (sum, count) = around.fold((0.0, 0.0), |(sum, count), v| (sum + v, count + 1.0));
        let size = |mean: f32| complex.dimension.size(f64::from(mean.max(0.0))) as f32;
        if count > 0.0 { size(sum / count).max(LEAST) } else { 1.0 }
    };
    complex.cells_around.par_iter().with_min_len(4096).map(of_node).collect()
}

/// `[vertices]` size reached over size asked of a state, > 0, 1 = reached. `asked`: `[vertices]` importance, > 0. For
/// [`Looks::fidelity`](super::Looks::fidelity).
pub fn reached(body: &Body, state: &[Vec3A], asked: &[f32]) -> Vec<f32> {
    let sizes = sizes(&body.complex, state);
    let binding = &body.binding;
    let at = |vertex: usize| -> f32 {
        let carried = binding.nodes[vertex].iter().zip(&binding.weights[vertex]);
        let logarithm: f32 = carried
            .map(|(&node, &weight)| {
                let [a, b, ..] = binding.ends(node).map(|end| sizes[end as usize].ln());
                0.5 * weight * (a + b)
            })
            .sum();
        logarithm.exp() / asked.get(vertex).copied().filter(|f| *f > 0.0).unwrap_or(1.0)
    };
    (0..binding.nodes.len()).into_par_iter().with_min_len(4096).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{boundary::Boundary, voxel::voxelize};
    use glam::DVec3;
    use std::sync::Arc;

    #[test]
    fn a_uniform_growth_is_its_own_size_everywhere() {
        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let boundary = Boundary::from_triangles("corner", positions, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]);
        let complex = voxelize(&boundary, 6).expect("a complex");
        let body = Body::new(Arc::new(boundary), Arc::new(complex));
        let state: Vec<Vec3A> = body.complex.rest.iter().map(|p| 2.0 * *p).collect();
        assert!(sizes(&body.complex, &state).iter().all(|s| (s - 2.0).abs() < 1e-4));
        let reached = reached(&body, &state, &[2.0, 4.0, 1.0, 2.0]);
        for (r, expected) in reached.iter().zip([1.0, 0.5, 2.0, 1.0]) {
            assert!((r - expected).abs() < 1e-4, "{reached:?}");
        }
    }
}
