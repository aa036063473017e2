//! Baked models: a surface as a small GLB in `assets/gallery`, made by `cargo run --release --example bake_gallery`.
//!
//! Meshing and remeshing take seconds; reading them back takes milliseconds and gives the same vertices on every
//! machine. Only positions and triangles are baked: regions follow from the positions.

use glam::Vec3;

use super::implicit::Mesh;
use crate::error::{Error, Result};

/// The surface as GLB: one mesh, f32 positions, u16 or u32 indices.
pub fn to_glb(mesh: &Mesh) -> Vec<u8> {
    let positions: Vec<u8> = mesh.positions.iter().flat_map(|p| p.to_array()).flat_map(f32::to_le_bytes).collect();
    // Two bytes are enough for most models; the largest value is kept free, as the format asks.
    let short = mesh.positions.len() < usize::from(u16::MAX);
    let index = |i: &u32| i.to_le_bytes().into_iter().take(if short { 2 } else { 4 });
    let mut indices: Vec<u8> = mesh.triangles.iter().flatten().flat_map(index).collect();
    let index_bytes = indices.len();
    indices.resize(index_bytes.next_multiple_of(4), 0);
    let low = mesh.positions.iter().copied().fold(Vec3::MAX, Vec3::min).to_array();
    let high = mesh.positions.iter().copied().fold(Vec3::MIN, Vec3::max).to_array();
    let json = serde_json::json!({
        "asset": { "version": "2.0", "generator": "homunculus bake_gallery" },
        "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": mesh.positions.len(), "type": "VEC3", "min": low, "max": high },
            { "bufferView": 1, "componentType": if short { 5123 } else { 5125 }, "count": mesh.triangles.len() * 3, "type": "SCALAR" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": positions.len(), "target": 34962 },
            { "buffer": 0, "byteOffset": positions.len(), "byteLength": index_bytes, "target": 34963 },
        ],
        "buffers": [{ "byteLength": positions.len() + indices.len() }],
    });
    let mut json = json.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let body = positions.len() + indices.len();
    let words = [0x4654_6C67, 2, (12 + 8 + json.len() + 8 + body) as u32, json.len() as u32, 0x4E4F_534A];
    let mut glb: Vec<u8> = words.into_iter().flat_map(u32::to_le_bytes).collect();
    glb.extend(json);
    glb.extend([body as u32, 0x004E_4942].into_iter().flat_map(u32::to_le_bytes));
    glb.extend(positions);
    glb.extend(indices);
    glb
}

/// Reads what [`to_glb`] wrote.
///
/// # Errors
/// A fault of this program when the baked asset `name` is damaged.
pub fn from_glb(name: &str, bytes: &[u8]) -> Result<Mesh> {
    let fault = |what: &str| Error::Fault(format!("the baked model `{name}` {what}"));
    let file = gltf::Gltf::from_slice(bytes).map_err(|e| fault(&format!("cannot be read: {e}")))?;
    let blob = file.blob.as_deref().ok_or_else(|| fault("has no data"))?;
    let primitive = file.meshes().next().and_then(|m| m.primitives().next()).ok_or_else(|| fault("has no mesh"))?;
    let reader = primitive.reader(|_| Some(blob));
    let positions: Vec<Vec3> =
        reader.read_positions().ok_or_else(|| fault("has no positions"))?.map(Vec3::from).collect();
    let indices: Vec<u32> = reader.read_indices().ok_or_else(|| fault("has no triangles"))?.into_u32().collect();
    if indices.iter().any(|&i| i as usize >= positions.len()) {
        return Err(fault("names vertices that are not there"));
    }
    Ok(Mesh { positions, triangles: indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect() })
}
