//! glTF 2.0: `.glb`, `.gltf` with its buffers and images beside it or in data URIs.
//!
//! The `gltf` crate takes the container apart, knows the schema and decodes the accessors. It panics on what breaks the schema,
//! so [`checked`] makes sure of every index before it, and [`accessor`] of every byte range. What the export writes again word for
//! word (materials, textures, samplers and their extensions) stays JSON and never passes through its types.
//!
//! # What is read
//!
//! The default scene, as a viewer shows it before any animation: node transforms, skins at their rest pose and default morph
//! weights are baked. Points and lines are left out. Vertices are in order of the scene's nodes, depth first, then of primitives;
//! primitives of one node that share their accessors share their vertices.

mod accessor;
mod checked;
mod material;
mod primitive;
mod scene;

use std::borrow::Cow;
use std::path::Path;

use gltf::binary::{Error as Broken, Glb};
use serde_json::Value;

use super::Boundary;
use crate::error::Error;
use accessor::Buffers;

/// Geometry in these is packed by codecs that this program does not have.
const PACKED: [&str; 3] = ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"];

/// Reads a glTF.
pub(super) fn read(path: &Path, bytes: &[u8]) -> Result<Boundary, Error> {
    parse(path, bytes).map_err(|sentence| Error::in_file(path, sentence))
}

fn parse(path: &Path, bytes: &[u8]) -> Result<Boundary, String> {
    let whole = with_own_length(bytes)?;
    let container = if bytes.starts_with(b"glTF") { Some(Glb::from_slice(&whole).map_err(broken)?) } else { None };
    let (text, binary) = container.as_ref().map_or((bytes, None), |glb| (&*glb.json, glb.bin.as_deref()));
    let text = super::format::text(text);
    let mut root: Value =
        serde_json::from_str(text.trim_end_matches(['\0', ' ', '\n', '\r', '\t'])).map_err(|why| malformed(&why))?;
    let mut materials = material::take(&mut root);
    let document = checked::document(root, materials.materials.len())?;
    if let Some(packed) = PACKED.iter().find(|&&name| document.extensions_required().any(|required| required == name)) {
        return Err(format!("its geometry is packed with {packed}; export it without mesh compression"));
    }
    let mut buffers = Buffers::new(path, &document, binary, bytes.len());
    let mut boundary = scene::read(&document, &mut buffers)?;
    materials.images = material::images(&document, &mut buffers, &mut boundary.warnings);
    boundary.source.materials = materials;
    if boundary.regions.is_none() {
        boundary.regions_from_parts();
    }
    Ok(boundary)
}

/// A GLB whose header says how long the file is. Some writers leave that out; the lengths of the chunks say it as well.
fn with_own_length(bytes: &[u8]) -> Result<Cow<'_, [u8]>, String> {
    let mut whole = Cow::Borrowed(bytes);
    if bytes.starts_with(b"glTF") {
        let length = (bytes.len() as u32).to_le_bytes();
        let said = bytes.get(8..12).ok_or("the GLB ends in its header; get the whole file again")?;
        if said != length {
            whole.to_mut()[8..12].copy_from_slice(&length);
        }
    }
    Ok(whole)
}

/// A sentence about a GLB that cannot be taken apart.
fn broken(why: gltf::Error) -> String {
    match why {
        gltf::Error::Binary(Broken::Version(version)) => {
            format!("it is a GLB of version {version}; export it as glTF 2.0")
        }
        gltf::Error::Binary(Broken::ChunkLength { length, length_read, .. }) => {
            format!("a chunk of {length} bytes is cut off after {length_read}; get the whole file again")
        }
        gltf::Error::Binary(Broken::ChunkType(_) | Broken::UnknownChunkType(_)) => {
            "the GLB is not one JSON chunk and one binary chunk; export the scene again".into()
        }
        _ => "the GLB ends within the header of a chunk; get the whole file again".into(),
    }
}

/// A sentence about JSON that is none, or not that of a glTF. It may quote the file at any length.
fn malformed(why: &serde_json::Error) -> String {
    let why: String = why.to_string().chars().take(200).collect();
    format!("its JSON is malformed ({why}); export the scene again")
}

/// A sentence about an index that is out of range.
fn no_such(what: &str, index: usize, count: usize) -> String {
    format!("it refers to {what} {index}, but there are {count}; export the scene again")
}
