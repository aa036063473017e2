//! Primitives of meshes, gathered into one boundary.

use std::collections::HashMap;

use glam::{DMat4, DVec3, Vec2, Vec3};

use gltf::accessor::Dimensions;
use gltf::mesh::{Mode, Semantic};
use gltf::{Accessor, Mesh, Node, Primitive};

use super::accessor::{Buffers, Numbers};
use super::scene::{Joint, moved};
use crate::boundary::source::{NONE, Object, Part};
use crate::boundary::{Attribute, Boundary, Regions};

/// The boundary so far.
#[derive(Default)]
pub(super) struct Gatherer {
    boundary: Boundary,
    attribute_of: HashMap<String, usize>,
    has_uvs: bool,
    has_normals: bool,
    /// `[vertices]`
    uvs: Vec<Option<Vec2>>,
    /// `[vertices]`
    normals: Vec<Option<Vec3>>,
    /// `[vertices]` name of the joint with most weight.
    bones: Vec<u32>,
    bone_names: Vec<String>,
    left_out: usize,
}

impl Gatherer {
    /// Adds what hangs at one node.
    pub fn node<'a>(
        &mut self,
        node: &Node<'a>,
        mesh: &Mesh<'a>,
        world: DMat4,
        joints: &[Joint],
        buffers: &mut Buffers<'a>,
    ) -> Result<(), String> {
        let name = node.name().or(mesh.name()).unwrap_or_default().to_owned();
        let extras = node.extras().as_ref().and_then(|extras| serde_json::from_str(extras.get()).ok());
        self.boundary.source.objects.push(Object { name, extras });
        let object = self.boundary.source.objects.len() as u32 - 1;
        let weights = node.weights().or(mesh.weights()).unwrap_or_default();
        let mut shared: HashMap<Vec<(Option<Semantic>, usize)>, u32> = HashMap::new();
        for (index, primitive) in mesh.primitives().enumerate() {
            let mode = primitive.mode();
            if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
                self.left_out += 1;
                continue;
            }
            let in_primitive = |sentence: String| format!("primitive {index}: {sentence}");
            let attributes = primitive.attributes().map(|(name, accessor)| (Some(name), accessor.index()));
            let targets = primitive.morph_targets().filter_map(|target| target.positions());
            let key: Vec<_> = attributes.chain(targets.map(|accessor| (None, accessor.index()))).collect();
            let first = match shared.get(&key) {
                Some(&first) => first,
                None => {
                    let first = self.vertices(&primitive, weights, world, joints, buffers).map_err(in_primitive)?;
                    shared.insert(key, first);
                    first
                }
            };
            let part = Part {
                object,
                material: primitive.material().index().map_or(NONE, |m| m as u32),
                extensions: variants(&primitive),
            };
            let is_mirrored = joints.is_empty() && world.determinant() < 0.0;
            self.triangles(&primitive, mode, first, part, is_mirrored, buffers).map_err(in_primitive)?;
        }
        Ok(())
    }

    /// Appends the vertices of a primitive; the index of the first.
    fn vertices<'a>(
        &mut self,
        primitive: &Primitive<'a>,
        weights: &[f32],
        world: DMat4,
        joints: &[Joint],
        buffers: &mut Buffers<'a>,
    ) -> Result<u32, String> {
        let first = self.boundary.positions.len();
        let position = primitive.get(&Semantic::Positions).ok_or("it has no POSITION; export the mesh again")?;
        let mut places = triples(buffers.numbers(&position)?)?;
        let count = places.len();
        for (target, &weight) in primitive.morph_targets().zip(weights).filter(|(_, weight)| **weight != 0.0) {
            let Some(accessor) = target.positions() else { continue };
            let offsets = triples(buffers.numbers(&accessor)?)?;
            places.iter_mut().zip(offsets).for_each(|(place, offset)| *place += f64::from(weight) * offset);
        }
        let influences = influences(primitive, count, joints, buffers)?;
        let is_identity = world == DMat4::IDENTITY;
        for (vertex, &place) in places.iter().enumerate() {
            let own: &[(usize, f64)] = influences.get(vertex).map_or(&[], Vec::as_slice);
            let total: f64 = own.iter().map(|(_, weight)| weight).sum();
            let at_rest = match total {
                _ if total > 0.0 => own
                    .iter()
                    .map(|&(joint, weight)| weight / total * moved(&joints[joint].world_from_mesh, place))
                    .sum(),
                _ if is_identity => place,
                _ => moved(&world, place),
            };
            self.boundary.positions.push(at_rest);
            let heaviest = own.iter().max_by(|a, b| a.1.total_cmp(&b.1)).map(|&(joint, _)| joint);
            let bone = heaviest.filter(|&j| !joints[j].name.is_empty()).map_or(NONE, |j| self.bone(&joints[j].name));
            self.bones.push(bone);
        }
        self.uvs.resize(first + count, None);
        self.normals.resize(first + count, None);
        let mut attributes: Vec<_> = primitive.attributes().map(|(name, values)| (name.to_string(), values)).collect();
        attributes.sort_by(|(a, _), (b, _)| a.cmp(b));
        for (name, accessor) in &attributes {
            self.attribute(name, accessor, first, count, buffers)?;
        }
        u32::try_from(first).map_err(|_| "the scene has more vertices than fit; export a part of it".into())
    }

    fn bone(&mut self, name: &str) -> u32 {
        let known = self.bone_names.iter().position(|n| n == name);
        known.unwrap_or_else(|| {
            self.bone_names.push(name.into());
            self.bone_names.len() - 1
        }) as u32
    }

    /// Keeps one attribute of a primitive whose vertices start at `first`.
    fn attribute<'a>(
        &mut self,
        name: &str,
        accessor: &Accessor<'a>,
        first: usize,
        count: usize,
        buffers: &mut Buffers<'a>,
    ) -> Result<(), String> {
        let is_kept =
            name == "NORMAL" || name.starts_with("TEXCOORD_") || name.starts_with("COLOR_") || name.starts_with('_');
        if !is_kept {
            return Ok(());
        }
        if matches!(buffers.shape(accessor)?, Dimensions::Mat2 | Dimensions::Mat3 | Dimensions::Mat4) {
            self.boundary.warnings.push(format!("the attribute {name} has matrices, which are left out"));
            return Ok(());
        }
        let numbers = buffers.numbers(accessor)?;
        if numbers.count() != count {
            return Err(format!("{name} has {} elements for {count} vertices; export the mesh again", numbers.count()));
        }
        let single = |&value: &f64| value as f32;
        match (name, numbers.width) {
            ("NORMAL", 3) => {
                self.has_normals = true;
                let triples =
                    numbers.values.chunks_exact(3).map(|n| Some(Vec3::new(n[0] as f32, n[1] as f32, n[2] as f32)));
                self.normals.splice(first.., triples);
            }
            ("TEXCOORD_0", 2) => {
                self.has_uvs = true;
                self.uvs.splice(
                    first..,
                    numbers.values.chunks_exact(2).map(|uv| Some(Vec2::new(uv[0] as f32, uv[1] as f32))),
                );
            }
            ("NORMAL" | "TEXCOORD_0", _) => {
                return Err(format!("{name} has {} numbers for each vertex; export the mesh again", numbers.width));
            }
            (_, 1) => self.channel(name.into(), 0.0, first, numbers.values.iter().map(single)),
            (_, width) => {
                let is_colour = name.starts_with("COLOR_");
                let letters = if is_colour { ["r", "g", "b", "a"] } else { ["x", "y", "z", "w"] };
                for (i, letter) in letters.iter().enumerate().take(width) {
                    let default = if is_colour { 1.0 } else { 0.0 };
                    self.channel(
                        format!("{name}.{letter}"),
                        default,
                        first,
                        numbers.values.iter().skip(i).step_by(width).map(single),
                    );
                }
            }
        }
        Ok(())
    }

    /// Values of a named scalar from vertex `first` on; vertices without it get the default.
    fn channel(&mut self, name: String, default: f32, first: usize, values: impl Iterator<Item = f32>) {
        let attributes = &mut self.boundary.attributes;
        let index = *self.attribute_of.entry(name.clone()).or_insert_with(|| {
            attributes.push(Attribute { name, values: Vec::new() });
            attributes.len() - 1
        });
        let slot = &mut attributes[index].values;
        slot.resize(first, default);
        slot.extend(values);
    }

    /// Appends the triangles of a primitive whose vertices start at `first`.
    fn triangles<'a>(
        &mut self,
        primitive: &Primitive<'a>,
        mode: Mode,
        first: u32,
        part: Part,
        is_mirrored: bool,
        buffers: &mut Buffers<'a>,
    ) -> Result<(), String> {
        let count = primitive.get(&Semantic::Positions).map_or(0, |position| position.count());
        buffers.spend(3 * count)?;
        let indices: Vec<u32> = match primitive.indices() {
            None => (0..count as u32).collect(),
            Some(accessor) => {
                let numbers = buffers.numbers(&accessor)?.values;
                if let Some((at, index)) = numbers.iter().enumerate().find(|&(_, &i)| !(i >= 0.0 && i < count as f64)) {
                    return Err(format!(
                        "index {at} refers to vertex {index}, but there are {count}; export the mesh again"
                    ));
                }
                numbers.into_iter().map(|i| i as u32).collect()
            }
        };
        let corners: Vec<[u32; 3]> = match mode {
            Mode::TriangleStrip => indices
                .windows(3)
                .enumerate()
                .map(|(i, t)| if i % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] })
                .collect(),
            Mode::TriangleFan => indices.windows(2).skip(1).map(|t| [indices[0], t[0], t[1]]).collect(),
            _ => indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
        };
        buffers.spend(9 * corners.len())?;
        let source = &mut self.boundary.source;
        source.parts.push(part);
        for [a, b, c] in corners {
            let triangle = if is_mirrored { [a, c, b] } else { [a, b, c] }.map(|v| v + first);
            source.polygons.push(&triangle);
            source.polygon_parts.push(source.parts.len() as u32 - 1);
            let end = source.polygons.corners.len() as u32;
            source.triangle_corners.push([end - 3, end - 2, end - 1]);
            self.boundary.triangles.push(triangle);
        }
        Ok(())
    }

    /// The boundary, with all arrays of one length.
    pub fn finish(self) -> Boundary {
        let mut boundary = self.boundary;
        let count = boundary.positions.len();
        for attribute in &mut boundary.attributes {
            let default = if attribute.name.starts_with("COLOR_") { 1.0 } else { 0.0 };
            attribute.values.resize(count, default);
        }
        let source = &mut boundary.source;
        let corners = &source.polygons.corners;
        if self.has_uvs {
            source.corner_uvs =
                corners.iter().map(|&v| if self.uvs[v as usize].is_some() { v } else { NONE }).collect();
            source.uvs = self.uvs.iter().map(|uv| uv.unwrap_or_default()).collect();
        }
        if self.has_normals {
            source.corner_normals =
                corners.iter().map(|&v| if self.normals[v as usize].is_some() { v } else { NONE }).collect();
            source.normals = self.normals.iter().map(|n| n.unwrap_or_default()).collect();
        }
        if self.left_out > 0 {
            boundary.warnings.push(format!("{} primitives of points or lines are left out", self.left_out));
        }
        if self.bone_names.len() > 1 {
            boundary.regions = Some(Regions { names: self.bone_names, of_vertex: self.bones });
        }
        boundary
    }
}

fn triples(numbers: Numbers) -> Result<Vec<DVec3>, String> {
    if numbers.width != 3 {
        return Err(format!("a position has {} numbers; export the mesh again", numbers.width));
    }
    Ok(numbers.values.chunks_exact(3).map(DVec3::from_slice).collect())
}

/// `[vertices]` joints and their weights; empty without a skin.
fn influences<'a>(
    primitive: &Primitive<'a>,
    count: usize,
    joints: &[Joint],
    buffers: &mut Buffers<'a>,
) -> Result<Vec<Vec<(usize, f64)>>, String> {
    let mut result = if joints.is_empty() { Vec::new() } else { vec![Vec::new(); count] };
    for set in 0.. {
        let accessors = (primitive.get(&Semantic::Joints(set)), primitive.get(&Semantic::Weights(set)));
        let (Some(of_joints), Some(of_weights), false) = (accessors.0, accessors.1, joints.is_empty()) else { break };
        let (indices, weights) = (buffers.numbers(&of_joints)?, buffers.numbers(&of_weights)?);
        if indices.values.len() != weights.values.len() || indices.count() != count {
            return Err(format!("JOINTS_{set} and WEIGHTS_{set} differ in length; export the mesh again"));
        }
        for (at, (&joint, &weight)) in
            indices.values.iter().zip(&weights.values).enumerate().filter(|(_, (_, weight))| **weight > 0.0)
        {
            let vertex = at / indices.width;
            if joint as usize >= joints.len() {
                return Err(format!(
                    "vertex {vertex} hangs at joint {joint}, but the skin has {}; export the mesh again",
                    joints.len()
                ));
            }
            result[vertex].push((joint as usize, weight));
        }
    }
    Ok(result)
}

/// The one extension of a primitive that still means something after baking.
fn variants(primitive: &Primitive) -> Option<serde_json::Value> {
    let variants = primitive.extension_value("KHR_materials_variants")?;
    Some(serde_json::json!({ "KHR_materials_variants": variants }))
}
