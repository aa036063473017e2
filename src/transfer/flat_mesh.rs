//! The flat mesh that a picture is drawn on: the halved lattice itself.

use glam::{DVec3, Vec2, Vec3A};

use super::Refinement;
use crate::{
    boundary::Boundary,
    voxel::{Complex, Dimension},
};

/// The triangles of the halved lattice of a flat complex as a boundary in source units, with texture coordinates for a
/// picture of `size` pixels. Vertices are the nodes of the complex, then the middles of its edges.
pub fn flat_boundary(name: &str, complex: &Complex, size: glam::UVec2) -> Boundary {
    let refinement = Refinement::new(complex);
    let positions: Vec<DVec3> = refinement
        .all()
        .apply(&complex.rest)
        .into_iter()
        .map(|p: Vec3A| complex.grid.source_from_lattice(p.as_dvec3()))
        .collect();
    let mut triangles = Vec::with_capacity(8 * complex.cells.len());
    for corners in &complex.corners {
        for quarter in 0..4 {
            for element in Dimension::Two.elements() {
                triangles.push([0, 1, 2].map(|k| {
                    let corner = element[k];
                    let at = std::array::from_fn(|axis| (quarter >> axis & 1) + (corner >> axis & 1));
                    refinement.node_in_cell(corners, at)
                }));
            }
        }
    }
    let (width, height) = (size.x as f32, size.y as f32);
    let uvs = positions.iter().map(|p| Vec2::new(p.x as f32 / width, 1.0 - p.y as f32 / height)).collect();
    Boundary::textured(name, positions, triangles, uvs)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::voxel::Grid;
    use glam::{UVec2, UVec3};

    #[test]
    fn the_mesh_covers_the_cells_once() {
        let grid = Grid { origin: DVec3::ZERO, cell_size: 2.0, cells: UVec3::new(2, 2, 1) };
        let complex = Complex::from_flat_cells(grid, &[true, true, false, true]);
        let boundary = flat_boundary("test", &complex, UVec2::splat(4));
        let area: f64 = boundary
            .triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|v| boundary.positions[v as usize]);
                let twice = (b - a).cross(c - a).z;
                assert!(twice > 0.0);
                twice / 2.0
            })
            .sum();
        assert_eq!((area, boundary.triangles.len()), (12.0, 24));
        assert!(boundary.is_sound());
    }
}
