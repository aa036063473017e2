//! GLB: buffers, accessors, materials; the mesh at one moment.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

use glam::{DVec3, Vec3};
use serde_json::{Map, Value, json};

use super::Surface;
use super::normals::Smoothing;
use super::table::{Slice, Table};
use crate::boundary::Boundary;
use crate::boundary::source::{COLOUR_CHANNELS, NONE, Original};
use crate::error::{Error, Result};

/// Single precision.
const FLOAT: u32 = 5126;
/// Purpose of a buffer view: vertices.
const ARRAY_BUFFER: u32 = 34962;
/// Purpose of a buffer view: indices.
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// A GLB being put together.
#[derive(Default)]
pub(super) struct Glb {
    binary: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    /// Other top-level members.
    pub root: Map<String, Value>,
}

/// Vertex data in a buffer view, of which windows become accessors.
pub(super) struct Column {
    view: usize,
    width: usize,
    values: Vec<f32>,
    is_position: bool,
}

impl Glb {
    fn view(&mut self, bytes: &[u8], members: Value) -> usize {
        let mut view = json!({ "buffer": 0, "byteOffset": self.binary.len(), "byteLength": bytes.len() });
        if let (Value::Object(view), Value::Object(members)) = (&mut view, members) {
            view.extend(members);
        }
        self.binary.extend_from_slice(bytes);
        // Accessors start at multiples of their component's size, four bytes at most.
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        self.views.push(view);
        self.views.len() - 1
    }

    /// Vertex data with `width` numbers for each vertex; positions get bounds.
    pub fn column(&mut self, values: Vec<f32>, width: usize, is_position: bool) -> Column {
        let view = self.view(&le_bytes(&values), json!({ "byteStride": 4 * width, "target": ARRAY_BUFFER }));
        Column { view, width, values, is_position }
    }

    /// An accessor of some rows of a column.
    pub fn window(&mut self, column: &Column, rows: &Range<usize>) -> usize {
        let width = column.width;
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][width.clamp(1, 4) - 1];
        let mut accessor = json!({
            "bufferView": column.view, "byteOffset": 4 * width * rows.start,
            "componentType": FLOAT, "count": rows.len(), "type": kind,
        });
        if column.is_position {
            let (min, max) = bounds(&column.values[width * rows.start..width * rows.end], width);
            accessor["min"] = json!(min);
            accessor["max"] = json!(max);
        }
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// An accessor of plain numbers (times, weights), with bounds.
    pub fn scalars(&mut self, values: &[f32]) -> usize {
        let view = self.view(&le_bytes(values), json!({}));
        let (min, max) = bounds(values, 1);
        self.accessors.push(json!({
            "bufferView": view, "componentType": FLOAT, "count": values.len(), "type": "SCALAR", "min": min, "max": max,
        }));
        self.accessors.len() - 1
    }

    /// An accessor of indices relative to the first row of a window, in two bytes where they fit.
    fn indices(&mut self, slice: &Slice) -> usize {
        let start = slice.window.start as u32;
        let indices = || slice.triangles.iter().flatten().map(|&row| row - start);
        // The largest number of each type is reserved for primitive restart.
        let is_short = slice.window.len() < usize::from(u16::MAX);
        let bytes: Vec<u8> = if is_short {
            indices().flat_map(|i| (i as u16).to_le_bytes()).collect()
        } else {
            indices().flat_map(u32::to_le_bytes).collect()
        };
        let view = self.view(&bytes, json!({ "target": ELEMENT_ARRAY_BUFFER }));
        let component = if is_short { 5123 } else { 5125 };
        self.accessors.push(json!({ "bufferView": view, "componentType": component, "count": 3 * slice.triangles.len(), "type": "SCALAR" }));
        self.accessors.len() - 1
    }

    /// The materials of the input, images within; or one neutral white.
    fn materials(&mut self, boundary: &Boundary, is_neutral: bool) {
        let source = &boundary.source.materials;
        if is_neutral {
            let pbr = json!({ "baseColorFactor": [1.0, 1.0, 1.0, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.8 });
            self.root.insert(
                "materials".into(),
                json!([{ "name": "neutral", "pbrMetallicRoughness": pbr, "doubleSided": true }]),
            );
            return;
        }
        let images: Vec<Value> = source
            .images
            .iter()
            .map(|image| {
                let view = self.view(&image.bytes, json!({}));
                json!({ "name": image.name, "mimeType": image.mime, "bufferView": view })
            })
            .collect();
        let arrays = [
            ("materials", &source.materials),
            ("textures", &source.textures),
            ("samplers", &source.samplers),
            ("images", &images),
        ];
        for (name, array) in arrays.into_iter().filter(|(_, array)| !array.is_empty()) {
            self.root.insert(name.into(), json!(array));
        }
        for (name, list) in
            [("extensionsUsed", &source.extensions_used), ("extensionsRequired", &source.extensions_required)]
        {
            if !list.is_empty() {
                self.root.insert(name.into(), json!(list));
            }
        }
        if !source.root_extensions.is_empty() {
            self.root.insert("extensions".into(), json!(source.root_extensions));
        }
    }

    /// The file.
    pub fn finish(mut self, path: &Path) -> Result<Vec<u8>> {
        let mut root =
            json!({ "asset": { "version": "2.0", "generator": concat!("homunculus ", env!("CARGO_PKG_VERSION")) } });
        if let Value::Object(root) = &mut root {
            root.append(&mut self.root);
        }
        root["accessors"] = json!(self.accessors);
        root["bufferViews"] = json!(self.views);
        root["buffers"] = json!([{ "byteLength": self.binary.len() }]);
        let mut text = root.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let total = 12 + 8 + text.len() + 8 + self.binary.len();
        let size = |length: usize| u32::try_from(length).map(u32::to_le_bytes);
        let (Ok(total), Ok(text_size), Ok(binary_size)) = (size(total), size(text.len()), size(self.binary.len()))
        else {
            return Err(Error::in_file(
                path,
                "it would be larger than the 4 GiB a GLB can be; use fewer frames or a coarser mesh",
            ));
        };
        let mut bytes = Vec::with_capacity(28 + text.len() + self.binary.len());
        bytes.extend_from_slice(b"glTF\x02\0\0\0");
        bytes.extend(total);
        bytes.extend(text_size);
        bytes.extend_from_slice(b"JSON");
        bytes.extend_from_slice(&text);
        bytes.extend(binary_size);
        bytes.extend_from_slice(b"BIN\0");
        bytes.extend_from_slice(&self.binary);
        Ok(bytes)
    }
}

/// The mesh at one moment as a GLB.
pub(super) fn write(surface: &Surface, path: &Path) -> Result<Vec<u8>> {
    surface.check_single(surface.boundary.origin(), path)?;
    let mut scene = Scene::new(surface);
    let root = scene.nodes(|_, _, _| {}, |_| {});
    scene.glb.root.extend(root);
    scene.glb.finish(path)
}

/// Columns and table of a surface within a GLB.
pub(super) struct Scene<'a> {
    surface: &'a Surface<'a>,
    /// The file.
    pub glb: Glb,
    /// Classes that share a normal.
    pub smoothing: Smoothing,
    /// Rows and parts.
    pub table: Table,
    columns: BTreeMap<String, Column>,
    is_neutral: bool,
    /// What positions are relative to; the nodes add it again.
    origin: DVec3,
}

impl<'a> Scene<'a> {
    /// Writes the vertex data and the materials.
    pub fn new(surface: &'a Surface<'a>) -> Self {
        let boundary = surface.boundary;
        let smoothing = Smoothing::new(boundary);
        let mut table = Table::new(boundary, &smoothing);
        table.gather(boundary.positions.len() - boundary.source.added.ends.len());
        let origin = boundary.origin();
        let is_gltf = matches!(boundary.source.original, Original::None) && !boundary.source.objects.is_empty();
        let is_neutral = surface.colours.is_some() || (boundary.source.materials.materials.is_empty() && !is_gltf);
        let mut scene =
            Self { surface, glb: Glb::default(), smoothing, table, columns: BTreeMap::new(), is_neutral, origin };
        let (places, normals) = scene.moment(surface.positions);
        scene.put("POSITION", places.iter().flat_map(|p| p.to_array()).collect(), 3);
        scene.put("NORMAL", normals.iter().flat_map(|n| n.to_array()).collect(), 3);
        scene.texture_coordinates();
        scene.attributes();
        scene.glb.materials(boundary, is_neutral);
        scene
    }

    /// `[rows]` positions, relative to the origin, and normals of one moment.
    pub fn moment(&self, positions: &[DVec3]) -> (Vec<Vec3>, Vec<Vec3>) {
        let by_class = self.smoothing.normals(&self.surface.boundary.triangles, positions);
        let rows = &self.table.rows;
        let places = rows.iter().map(|row| (positions[row.vertex as usize] - self.origin).as_vec3()).collect();
        (places, rows.iter().map(|row| by_class.get(row.class as usize).copied().unwrap_or(Vec3::Z)).collect())
    }

    fn put(&mut self, name: &str, values: Vec<f32>, width: usize) {
        let column = self.glb.column(values, width, name == "POSITION");
        self.columns.insert(name.into(), column);
    }

    fn texture_coordinates(&mut self) {
        let uvs = &self.surface.boundary.source.uvs;
        let source = &self.surface.boundary.source;
        // A texture without coordinates is no valid glTF; other formats show its first pixel then, and so do zeros here.
        let is_asked_for = !self.is_neutral && !source.materials.textures.is_empty();
        if source.corner_uvs.is_empty() && !is_asked_for {
            return;
        }
        let values = self
            .table
            .rows
            .iter()
            .flat_map(|row| uvs.get(row.uv as usize).copied().unwrap_or_default().to_array().map(finite))
            .collect();
        self.put("TEXCOORD_0", values, 2);
    }

    /// Colours and named scalars; those with a common prefix (`_FLOW.x`, `_FLOW.y`) become one vector again.
    fn attributes(&mut self) {
        let rows: Vec<usize> = self.table.rows.iter().map(|row| row.vertex as usize).collect();
        if let Some(tints) = self.surface.tints() {
            self.put("COLOR_0", rows.iter().flat_map(|&v| tints[v]).collect(), 4);
        }
        let mut groups: BTreeMap<String, Vec<&[f32]>> = BTreeMap::new();
        for attribute in &self.surface.boundary.attributes {
            let name = attribute.name.as_str();
            if COLOUR_CHANNELS.iter().flatten().any(|&channel| channel == name) {
                continue;
            }
            let (stem, part) = name.rsplit_once('.').unwrap_or((name, ""));
            let stem = if ["x", "y", "z", "w", "r", "g", "b", "a"].contains(&part) { stem } else { name };
            let is_known = stem.starts_with('_') || stem.starts_with("COLOR_") || stem.starts_with("TEXCOORD_");
            let semantic = if is_known { stem.to_owned() } else { format!("_{stem}") };
            groups.entry(semantic).or_default().push(&attribute.values);
        }
        for (name, channels) in groups.into_iter().filter(|(_, channels)| channels.len() <= 4) {
            let values = rows.iter().flat_map(|&v| channels.iter().map(move |values| finite(values[v]))).collect();
            self.put(&name, values, channels.len());
        }
    }

    /// Scene, nodes and meshes: a node for each object where objects have vertices of their own, else one.
    ///
    /// `on_primitive` and `on_mesh` may add members.
    pub fn nodes(
        &mut self,
        mut on_primitive: impl FnMut(&mut Glb, &Range<usize>, &mut Value),
        mut on_mesh: impl FnMut(&mut Value),
    ) -> Map<String, Value> {
        let objects = &self.surface.boundary.source.objects;
        let is_parted = self.table.is_separable();
        let (mut nodes, mut meshes): (Vec<Value>, Vec<Value>) = (Vec::new(), Vec::new());
        let mut last = None;
        let mut windows: BTreeMap<(usize, usize), Map<String, Value>> = BTreeMap::new();
        for slice in &self.table.parts {
            let object = if is_parted { slice.part.object } else { NONE };
            if last != Some(object) {
                last = Some(object);
                let known = objects.get(object as usize);
                let name = known
                    .map(|o| o.name.as_str())
                    .filter(|name| !name.is_empty())
                    .unwrap_or(&self.surface.boundary.name);
                let mut node = json!({ "mesh": meshes.len(), "name": name });
                if self.origin != DVec3::ZERO {
                    node["translation"] = json!(self.origin.to_array());
                }
                if let Some(extras) = known.and_then(|o| o.extras.clone()) {
                    node["extras"] = extras;
                }
                nodes.push(node);
                meshes.push(json!({ "name": name, "primitives": [] }));
            }
            let (glb, columns) = (&mut self.glb, &self.columns);
            let attributes = windows.entry((slice.window.start, slice.window.end)).or_insert_with(|| {
                columns.iter().map(|(name, column)| (name.clone(), json!(glb.window(column, &slice.window)))).collect()
            });
            let mut primitive = json!({ "attributes": attributes, "indices": glb.indices(slice), "mode": 4 });
            if self.is_neutral {
                primitive["material"] = json!(0);
            } else if slice.part.material != NONE {
                primitive["material"] = json!(slice.part.material);
            }
            if let Some(extensions) = slice.part.extensions.as_ref().filter(|_| !self.is_neutral) {
                primitive["extensions"] = extensions.clone();
            }
            on_primitive(glb, &slice.window, &mut primitive);
            if let Some(Value::Array(primitives)) = meshes.last_mut().and_then(|mesh| mesh.get_mut("primitives")) {
                primitives.push(primitive);
            }
        }
        meshes.iter_mut().for_each(&mut on_mesh);
        let roots: Vec<usize> = (0..nodes.len()).collect();
        let members = json!({ "scene": 0, "scenes": [{ "nodes": roots }], "nodes": nodes, "meshes": meshes });
        members.as_object().cloned().unwrap_or_default()
    }
}

/// glTF has no numbers that are none.
fn finite(value: f32) -> f32 {
    if value.is_finite() { value } else { 0.0 }
}

fn le_bytes(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

fn bounds(values: &[f32], width: usize) -> (Vec<f32>, Vec<f32>) {
    let fold = |pick: fn(f32, f32) -> f32| {
        (0..width).map(|i| values.iter().skip(i).step_by(width).copied().reduce(pick).unwrap_or(0.0)).collect()
    };
    (fold(f32::min), fold(f32::max))
}
