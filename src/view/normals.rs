//! Normals of a deformed surface that do not show the lattice.
//!
//! # Theory
//! Normals of the moved triangles jump where the piecewise linear map has kinks: lattice bands in every highlight. Here the map's
//! gradient F is taken at the nodes, from differences along the lattice's axes, averaged once with the neighbours, and carried to
//! the surface like positions are. It is continuous, and so is `n' ∝ cof(F) n` of a rest normal n: what the surface had of
//! detail and of hard edges stays, what the lattice adds goes. The cofactor needs no inverse and turns the normal over where
//! the map does.

use glam::{Mat3A, Vec3A};
use rayon::prelude::*;

use crate::voxel::{Complex, opposite};

/// Nodes per parallel task.
const NODES_PER_TASK: usize = 2048;

/// Neighbour slots of the axes; see [`crate::voxel::DIRECTIONS`].
const AXES: [usize; 3] = [0, 1, 3];

/// `[nodes]` gradient of a state, averaged with the neighbours along the axes.
pub(super) fn gradients(complex: &Complex, nodes: &[Vec3A]) -> Vec<Mat3A> {
    let raw: Vec<Mat3A> = (0..nodes.len())
        .into_par_iter()
        .with_min_len(NODES_PER_TASK)
        .map(|i| {
            Mat3A::from_cols(slope(complex, nodes, i, 0), slope(complex, nodes, i, 1), slope(complex, nodes, i, 2))
        })
        .collect();
    (0..nodes.len())
        .into_par_iter()
        .with_min_len(NODES_PER_TASK)
        .map(|i| {
            let mut sum = raw[i] * 2.0;
            let mut weight = 2.0;
            for slot in AXES.into_iter().flat_map(|slot| [slot, opposite(slot)]) {
                let j = complex.neighbours[i][slot] as usize;
                if j != i {
                    sum += raw[j];
                    weight += 1.0;
                }
            }
            sum * (1.0 / weight)
        })
        .collect()
}

/// Difference quotient along an axis: over both neighbours, or the one there is.
fn slope(complex: &Complex, nodes: &[Vec3A], i: usize, axis: usize) -> Vec3A {
    let slot = AXES[axis];
    let (next, last) = (complex.neighbours[i][slot] as usize, complex.neighbours[i][opposite(slot)] as usize);
    let span = f32::from(u8::from(next != i) + u8::from(last != i));
    if span == 0.0 { Vec3A::AXES[axis] } else { (nodes[next] - nodes[last]) / span }
}

/// `cof(F) n`, normalised; the rest normal where nothing is left of it.
pub(super) fn transformed(gradient: &Mat3A, normal: Vec3A) -> Vec3A {
    let [x, y, z] = [gradient.x_axis, gradient.y_axis, gradient.z_axis];
    (y.cross(z) * normal.x + z.cross(x) * normal.y + x.cross(y) * normal.z).try_normalize().unwrap_or(normal)
}

/// A unit vector in two signed 16-bit numbers, octahedrally (Meyer et al. 2010): within 3e-5 radians.
pub(super) fn octahedral(n: Vec3A) -> u32 {
    let n = n / n.abs().element_sum().max(f32::MIN_POSITIVE);
    let sign = |x: f32| if x < 0.0 { -1.0 } else { 1.0 };
    let (x, y) = if n.z >= 0.0 { (n.x, n.y) } else { ((1.0 - n.y.abs()) * sign(n.x), (1.0 - n.x.abs()) * sign(n.y)) };
    let pack = |v: f32| u32::from((v.clamp(-1.0, 1.0) * 32767.0).round() as i16 as u16);
    pack(x) | pack(y) << 16
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::voxel::Grid;
    use glam::{DVec3, UVec3, Vec3};

    fn unpacked(packed: u32) -> Vec3A {
        let part = |bits: u32| f32::from(bits as u16 as i16) / 32767.0;
        let (x, y) = (part(packed), part(packed >> 16));
        let z = 1.0 - x.abs() - y.abs();
        let fold = (-z).max(0.0);
        Vec3A::new(x - x.signum() * fold, y - y.signum() * fold, z).normalize()
    }

    #[test]
    fn packing_keeps_directions() {
        for k in 0..1000 {
            let (a, b) = (k as f32 * 0.731, k as f32 * 1.379);
            let n = Vec3A::new(a.sin() * b.cos(), b.sin(), a.cos() * b.cos()).normalize();
            assert!(unpacked(octahedral(n)).distance(n) < 1e-4, "{n}");
        }
        for n in [Vec3A::X, -Vec3A::X, Vec3A::Y, -Vec3A::Y, Vec3A::Z, -Vec3A::Z] {
            assert!(unpacked(octahedral(n)).distance(n) < 1e-4, "{n}");
        }
    }

    #[test]
    fn a_linear_map_turns_normals_as_it_must() {
        let grid = Grid { origin: DVec3::ZERO, cell_size: 1.0, cells: UVec3::splat(3) };
        let complex = Complex::from_cells(grid, &[true; 27]);
        let map = Mat3A::from_cols(Vec3A::new(2.0, 0.3, 0.0), Vec3A::new(0.0, 0.7, 0.4), Vec3A::new(0.5, 0.0, 1.2));
        let nodes: Vec<Vec3A> = complex.rest.iter().map(|&p| map * p).collect();
        let normal = Vec3A::new(1.0, 2.0, -1.0).normalize();
        let expected = (map.inverse().transpose() * normal).normalize();
        for gradient in gradients(&complex, &nodes) {
            assert!(transformed(&gradient, normal).abs_diff_eq(expected, 1e-5));
        }
        // Sabotage: the map itself, applied to a normal, is not it.
        assert!(!(map * normal).normalize().abs_diff_eq(expected, 1e-2));
        assert_eq!(Vec3::from(transformed(&Mat3A::ZERO, normal)), Vec3::from(normal));
    }
}
