//! What is drawn of a body: rows (vertices of the GPU), the nodes that carry them, and meshes.

use bevy::{
    asset::RenderAssetUsages,
    mesh::{Indices, PrimitiveTopology},
    prelude::*,
    render::render_resource::ShaderType,
};
use glam::{Mat3A, Vec3A};
use rayon::prelude::*;

use super::{Body, ViewFrame, normals, openness};
use crate::{
    boundary::source::NONE,
    export::{normals::Smoothing, table::Table},
    voxel::{Complex, Dimension},
};

/// Rows per parallel task.
const ROWS_PER_TASK: usize = 4096;

/// Nodes and weights of one row. `Carrier` of the shader.
#[derive(ShaderType, Debug, Clone, Copy)]
pub(super) struct Carrier {
    pub nodes: UVec4,
    pub weights: Vec4,
}

/// One mesh: rows with one material.
pub(super) struct Part {
    /// Index into the file's materials, or [`NONE`].
    pub material: u32,
    /// Where its rows begin.
    pub first_row: u32,
    pub mesh: Mesh,
}

/// The rows of a body, of its surface or of its complex.
pub(super) struct Rows {
    /// `[rows]` vertex of the boundary (surface) or node of the complex (blocks).
    pub origin: Vec<u32>,
    /// `[rows]` nodes as indices into `used`.
    pub carriers: Vec<Carrier>,
    /// Nodes that carry something: of the halved lattice (surface) or of the complex (blocks).
    pub used: Vec<u32>,
    /// `[rows]` unit normals at rest; empty for blocks, whose normals the shader finds.
    normals: Vec<Vec3A>,
}

impl Rows {
    /// The boundary's surface, split where texture coordinates or hard edges split it, and by material.
    pub fn of_surface(body: &Body, frame: &ViewFrame) -> (Self, Vec<Part>) {
        let (boundary, complex) = (&body.boundary, &body.complex);
        let smoothing = Smoothing::new(boundary);
        let table = Table::new(boundary, &smoothing);
        let class_normals = smoothing.normals(&boundary.triangles, &boundary.positions);
        let colours = boundary.base_colours();
        let source = &boundary.source;
        let has_uvs = !source.corner_uvs.is_empty();

        let mut materials: Vec<u32> = table.parts.iter().map(|p| p.part.material).collect();
        materials.sort_unstable();
        materials.dedup();
        let mut rows: Vec<u32> = Vec::with_capacity(table.rows.len());
        let mut parts = Vec::with_capacity(materials.len());
        let mut local = vec![u32::MAX; table.rows.len()];
        for material in materials {
            let first_row = rows.len();
            let mut indices = Vec::new();
            for row in
                table.parts.iter().filter(|p| p.part.material == material).flat_map(|p| p.triangles.as_flattened())
            {
                let slot = &mut local[*row as usize];
                if *slot == u32::MAX || (*slot as usize) < first_row {
                    *slot = rows.len() as u32;
                    rows.push(*row);
                }
                indices.push(*slot - first_row as u32);
            }
            let here = &rows[first_row..];
            let at = |row: &u32| &table.rows[*row as usize];
            let positions: Vec<Vec3> =
                here.iter().map(|r| frame.world_from_source(boundary.positions[at(r).vertex as usize])).collect();
            let normals: Vec<Vec3> =
                here.iter().map(|r| class_normals.get(at(r).class as usize).copied().unwrap_or(Vec3::Z)).collect();
            let mut mesh = Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::RENDER_WORLD)
                .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
                .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals)
                .with_inserted_indices(Indices::U32(indices));
            if has_uvs {
                let uv = |r| source.uvs.get(at(r).uv as usize).copied().unwrap_or_default();
                mesh.insert_attribute(Mesh::ATTRIBUTE_UV_0, here.iter().map(uv).collect::<Vec<Vec2>>());
            }
            let place = |r| complex.grid.lattice_from_source(boundary.positions[at(r).vertex as usize]).as_vec3a();
            let normal = |r| class_normals.get(at(r).class as usize).map_or(Vec3A::Z, |&n| n.into());
            let places: Vec<(Vec3A, Vec3A)> = here.iter().map(|r| (place(r), normal(r))).collect();
            let seen = match complex.dimension {
                Dimension::Two => vec![1.0; places.len()],
                Dimension::Three => openness::openness(complex, &places),
            };
            mesh.insert_attribute(Mesh::ATTRIBUTE_UV_1, seen.iter().map(|&s| Vec2::new(s, 0.0)).collect::<Vec<Vec2>>());
            if let Some(colours) = &colours {
                let colour: Vec<[f32; 4]> = here.iter().map(|r| colours[at(r).vertex as usize]).collect();
                mesh.insert_attribute(Mesh::ATTRIBUTE_COLOR, colour);
            }
            parts.push(Part { material, first_row: first_row as u32, mesh });
        }
        let normal = |r: &u32| class_normals.get(table.rows[*r as usize].class as usize).copied().unwrap_or(Vec3::Z);
        let normals = rows.iter().map(|r| normal(r).into()).collect();
        let origin: Vec<u32> = rows.iter().map(|r| table.rows[*r as usize].vertex).collect();
        let binding = &body.binding;
        let bound = origin.iter().map(|&v| (binding.nodes[v as usize], binding.weights[v as usize]));
        let (carriers, used) = compact(bound);
        (Self { origin, carriers, used, normals }, parts)
    }

    /// The skin of the complex: one block face of four rows for each pair of its triangles.
    pub fn of_blocks(complex: &Complex, frame: &ViewFrame) -> (Self, Part) {
        let mut origin = Vec::with_capacity(2 * complex.faces.len());
        let mut indices = Vec::with_capacity(3 * complex.faces.len());
        for pair in complex.faces.chunks(2) {
            let first = origin.len() as u32;
            match quad(pair) {
                Some(corners) => {
                    origin.extend(corners);
                    indices.extend([0, 1, 2, 0, 2, 3].map(|k| first + k));
                }
                None => {
                    origin.extend(pair.as_flattened());
                    indices.extend(first..origin.len() as u32);
                }
            }
        }
        Self::of_quads(complex, frame, origin, indices)
    }

    /// The cells of a flat complex: one square of four rows for each.
    pub fn of_squares(complex: &Complex, frame: &ViewFrame) -> (Self, Part) {
        let origin: Vec<u32> = complex.corners.iter().flat_map(|c| [c[0], c[1], c[3], c[2]]).collect();
        let indices =
            (0..complex.cells.len() as u32).flat_map(|cell| [0, 1, 2, 0, 2, 3].map(|k| 4 * cell + k)).collect();
        Self::of_quads(complex, frame, origin, indices)
    }

    /// Squares of four rows each, by the nodes they hang on.
    fn of_quads(complex: &Complex, frame: &ViewFrame, origin: Vec<u32>, indices: Vec<u32>) -> (Self, Part) {
        let corner = |k: usize| [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y][k % 4];
        let uvs: Vec<Vec2> = (0..origin.len()).map(corner).collect();
        let position = |&node: &u32| {
            frame.world_from_source(complex.grid.source_from_lattice(complex.rest[node as usize].as_dvec3()))
        };
        let mesh = Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::RENDER_WORLD)
            .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, origin.iter().map(position).collect::<Vec<Vec3>>())
            .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, uvs)
            .with_inserted_indices(Indices::U32(indices));
        let (carriers, used) = compact(origin.iter().map(|&node| ([node; 4], [1.0, 0.0, 0.0, 0.0])));
        (Self { origin, carriers, used, normals: Vec::new() }, Part { material: NONE, first_row: 0, mesh })
    }

    /// `[rows]` packed normals in a state; one of no meaning for blocks.
    ///
    /// `gradients`: `[nodes]` of the complex.
    pub fn normals_in(&self, body: &Body, gradients: &[Mat3A]) -> Vec<u32> {
        if self.normals.is_empty() {
            return vec![0];
        }
        let binding = &body.binding;
        (0..self.normals.len())
            .into_par_iter()
            .with_min_len(ROWS_PER_TASK)
            .map(|row| {
                let vertex = self.origin[row] as usize;
                let mut gradient = Mat3A::ZERO;
                for (&node, &weight) in binding.nodes[vertex].iter().zip(&binding.weights[vertex]) {
                    let [a, b, ..] = binding.ends(node);
                    gradient += (gradients[a as usize] + gradients[b as usize]) * (0.5 * weight);
                }
                normals::octahedral(normals::transformed(&gradient, self.normals[row]))
            })
            .collect()
    }
}

/// The four corners of two triangles that share a diagonal, in order; `None` for anything else.
fn quad(pair: &[[u32; 3]]) -> Option<[u32; 4]> {
    let &[[a, p, q], [b, r, s]] = pair else { return None };
    match (a == b, q == r, p == s) {
        (true, true, _) => Some([a, p, q, s]),
        (true, _, true) => Some([a, r, s, q]),
        _ => None,
    }
}

/// Numbers the nodes that carry something from 0, in the order they are met.
fn compact(bound: impl Iterator<Item = ([u32; 4], [f32; 4])>) -> (Vec<Carrier>, Vec<u32>) {
    let mut used = Vec::new();
    let mut number: bevy::platform::collections::HashMap<u32, u32> = default();
    let carriers = bound
        .map(|(nodes, weights)| {
            let nodes = nodes.map(|node| {
                *number.entry(node).or_insert_with(|| {
                    used.push(node);
                    used.len() as u32 - 1
                })
            });
            Carrier { nodes: nodes.into(), weights: weights.into() }
        })
        .collect();
    (carriers, used)
}
