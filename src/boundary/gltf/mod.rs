//! glTF 2.0: `.glb`, `.gltf` with its buffers and images beside it or in data URIs.
//!
//! Own reading of the JSON rather than through a typed crate: materials, textures and extensions which nobody here knows are
//! kept word for word for the export, and no index is believed.
//!
//! # What is read
//!
//! The default scene, as a viewer shows it before any animation: node transforms, skins at their rest pose and default morph
//! weights are baked. Points and lines are left out. Vertices are in order of the scene's nodes, depth first, then of primitives;
//! primitives of one node that share their accessors share their vertices.

mod accessor;
mod material;
mod primitive;
mod scene;

use std::path::Path;

use serde::Deserialize;
use serde_json::Value;

use super::Boundary;
use crate::error::{Error, Result};
use accessor::Buffers;

/// Geometry in these is packed by codecs that this program does not have.
const PACKED: [&str; 3] = ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"];

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
struct Document {
    scene: Option<usize>,
    scenes: Vec<Scene>,
    nodes: Vec<Node>,
    meshes: Vec<Mesh>,
    accessors: Vec<Accessor>,
    buffer_views: Vec<BufferView>,
    buffers: Vec<Buffer>,
    skins: Vec<Skin>,
    images: Vec<ImageFile>,
    extensions_required: Vec<String>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct Scene {
    nodes: Vec<usize>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct Node {
    name: Option<String>,
    children: Vec<usize>,
    mesh: Option<usize>,
    skin: Option<usize>,
    matrix: Option<[f64; 16]>,
    translation: Option<[f64; 3]>,
    rotation: Option<[f64; 4]>,
    scale: Option<[f64; 3]>,
    weights: Option<Vec<f64>>,
    extras: Option<Value>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct Mesh {
    name: Option<String>,
    primitives: Vec<Primitive>,
    weights: Option<Vec<f64>>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct Primitive {
    attributes: std::collections::BTreeMap<String, usize>,
    indices: Option<usize>,
    material: Option<usize>,
    mode: Option<u32>,
    targets: Vec<std::collections::BTreeMap<String, usize>>,
    extensions: Option<Value>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
struct Accessor {
    buffer_view: Option<usize>,
    byte_offset: usize,
    component_type: u32,
    normalized: bool,
    count: usize,
    #[serde(rename = "type")]
    shape: String,
    sparse: Option<Sparse>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct Sparse {
    count: usize,
    indices: SparsePart,
    values: SparsePart,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
struct SparsePart {
    buffer_view: usize,
    byte_offset: usize,
    component_type: u32,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
struct BufferView {
    buffer: usize,
    byte_offset: usize,
    byte_length: usize,
    byte_stride: Option<usize>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
struct Buffer {
    uri: Option<String>,
    byte_length: usize,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
struct Skin {
    inverse_bind_matrices: Option<usize>,
    joints: Vec<usize>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
struct ImageFile {
    name: Option<String>,
    uri: Option<String>,
    mime_type: Option<String>,
    buffer_view: Option<usize>,
}

/// Reads a glTF.
pub(super) fn read(path: &Path, bytes: &[u8]) -> Result<Boundary> {
    let (text, binary) = container(bytes).map_err(|sentence| Error::in_file(path, sentence))?;
    let text = super::format::text(text);
    let malformed =
        |why: serde_json::Error| Error::in_file(path, format!("its JSON is malformed ({why}); export the scene again"));
    let root: Value = serde_json::from_str(text.trim_end_matches(['\0', ' ', '\n', '\r', '\t'])).map_err(malformed)?;
    let document = Document::deserialize(&root).map_err(malformed)?;
    if let Some(packed) =
        PACKED.iter().find(|&&name| document.extensions_required.iter().any(|required| required == name))
    {
        return Err(Error::in_file(
            path,
            format!("its geometry is packed with {packed}; export it without mesh compression"),
        ));
    }
    let mut buffers = Buffers::new(path, &document, binary, bytes.len());
    let mut boundary = scene::read(&document, &mut buffers).map_err(|sentence| Error::in_file(path, sentence))?;
    boundary.source.materials = material::read(&root, &document, &mut buffers, &mut boundary.warnings);
    let materials = boundary.source.materials.materials.len();
    for part in &mut boundary.source.parts {
        part.material = if (part.material as usize) < materials { part.material } else { super::source::NONE };
    }
    if boundary.regions.is_none() {
        boundary.regions_from_parts();
    }
    Ok(boundary)
}

/// The JSON and the binary chunk of a GLB; a `.gltf` is all JSON.
fn container(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), String> {
    if !bytes.starts_with(b"glTF") {
        return Ok((bytes, None));
    }
    let word = |at: usize| bytes.get(at..at + 4).map(|w| u32::from_le_bytes([w[0], w[1], w[2], w[3]]));
    match word(4) {
        Some(2) => {}
        Some(version) => return Err(format!("it is a GLB of version {version}; export it as glTF 2.0")),
        None => return Err("the GLB ends in its header; get the whole file again".into()),
    }
    let mut chunks = [None, None];
    let mut at = 12;
    while let (Some(length), Some(kind)) = (word(at), word(at + 4)) {
        let start = at + 8;
        let chunk = start.checked_add(length as usize).and_then(|end| bytes.get(start..end));
        let chunk = chunk.ok_or_else(|| {
            format!("a chunk of {length} bytes is cut off after {}; get the whole file again", bytes.len() - start)
        })?;
        match kind {
            0x4E4F_534A => chunks[0] = chunks[0].or(Some(chunk)),
            0x004E_4942 => chunks[1] = chunks[1].or(Some(chunk)),
            _ => {}
        }
        at = start + length as usize;
    }
    Ok((chunks[0].ok_or("the GLB has no JSON chunk; get the whole file again")?, chunks[1]))
}
