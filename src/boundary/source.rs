//! What a file says beyond positions and triangles, kept so that the same file can be written with other positions.

use std::path::PathBuf;

use glam::{Vec2, Vec3};
use serde_json::{Map, Value};

use super::obj::ObjText;
use super::off::OffText;
use super::ply_table::PlyTable;
use super::stl::StlKind;

/// Marks a corner without texture coordinate or normal, or a polygon without material.
pub(crate) const NONE: u32 = u32::MAX;

/// Names of colour channels, as the readers give them: linear (glTF), then sRGB (OBJ, PLY, OFF).
pub(crate) const COLOUR_CHANNELS: [[&str; 4]; 2] =
    [["COLOR_0.r", "COLOR_0.g", "COLOR_0.b", "COLOR_0.a"], ["red", "green", "blue", "alpha"]];

/// Everything the export needs; empty for a boundary made of bare triangles.
#[derive(Debug, Clone, Default)]
pub(crate) struct Source {
    /// The folder the file came from, where its textures and material library lie.
    pub folder: Option<PathBuf>,
    /// Faces as in the file; empty where they are the triangles.
    pub polygons: Polygons,
    /// The polygon each triangle came from. `[triangles]`, empty where polygons are the triangles.
    pub triangle_corners: Vec<[u32; 3]>,
    /// Texture coordinates, glTF convention (v downwards).
    pub uvs: Vec<Vec2>,
    /// `[corners]` index into `uvs` or [`NONE`]; empty without texture coordinates.
    pub corner_uvs: Vec<u32>,
    /// Normals of the file at rest: only told apart, never written.
    pub normals: Vec<Vec3>,
    /// `[corners]` index into `normals` or [`NONE`]; empty without normals.
    pub corner_normals: Vec<u32>,
    /// `[polygons]` index into `parts`; empty for one part.
    pub polygon_parts: Vec<u32>,
    /// Runs of faces with one object and one material.
    pub parts: Vec<Part>,
    /// Objects the parts belong to.
    pub objects: Vec<Object>,
    /// Materials, textures and images.
    pub materials: Materials,
    /// The file itself where it is text that is written again line by line, or a table.
    pub original: Original,
    /// What there is beyond the file; empty for a boundary as it was read.
    pub added: Added,
}

/// What a boundary has beyond its file since its long triangles are in pieces.
#[derive(Debug, Clone, Default)]
pub(crate) struct Added {
    /// `[vertices after those of the file]` the two each lies between, with smaller indices; names go over from the first.
    pub ends: Vec<[u32; 2]>,
    /// `[polygons]`, or `[triangles]` where these are the faces: the face of the file each is or is a part of. Empty where
    /// nothing was split.
    pub faces: Vec<u32>,
}

/// Faces with any number of corners, flattened.
#[derive(Debug, Clone, Default)]
pub(crate) struct Polygons {
    /// `[polygons + 1]` first corner of each polygon, then the number of corners; or empty.
    pub starts: Vec<u32>,
    /// `[corners]` index into the boundary's positions.
    pub corners: Vec<u32>,
}

/// Faces with one object and one material.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Part {
    /// Index into [`Source::objects`], or [`NONE`].
    pub object: u32,
    /// Index into [`Materials::materials`], or [`NONE`].
    pub material: u32,
    /// glTF `extensions` of the primitive that still hold after baking (material variants).
    pub extensions: Option<Value>,
}

/// A named object: glTF node and mesh, OBJ `o`/`g`, STL solid.
#[derive(Debug, Clone, Default)]
pub(crate) struct Object {
    /// Its name, may be empty.
    pub name: String,
    /// glTF `extras` of the node.
    pub extras: Option<Value>,
}

/// Materials in glTF terms; those of an OBJ are translated.
#[derive(Debug, Clone, Default)]
pub(crate) struct Materials {
    /// glTF material objects, word for word.
    pub materials: Vec<Value>,
    /// glTF texture objects.
    pub textures: Vec<Value>,
    /// glTF sampler objects.
    pub samplers: Vec<Value>,
    /// The images, with their bytes.
    pub images: Vec<Image>,
    /// glTF `extensionsUsed` that materials may need.
    pub extensions_used: Vec<String>,
    /// glTF `extensionsRequired` that materials may need.
    pub extensions_required: Vec<String>,
    /// glTF root `extensions` that materials refer to.
    pub root_extensions: Map<String, Value>,
}

/// An image file in memory.
#[derive(Debug, Clone)]
pub(crate) struct Image {
    /// Its file name or glTF name.
    pub name: String,
    /// `image/png`, `image/jpeg` or another.
    pub mime: String,
    /// The bytes of the file.
    pub bytes: Vec<u8>,
}

/// The file itself, where the export writes it again.
#[derive(Debug, Clone, Default)]
pub(crate) enum Original {
    /// Written from the parts above.
    #[default]
    None,
    /// The lines of an OBJ.
    Obj(ObjText),
    /// The lines of an OFF.
    Off(OffText),
    /// The elements of a PLY.
    Ply(PlyTable),
    /// The flavour of an STL.
    Stl(StlKind),
}

impl Polygons {
    /// How many.
    pub fn len(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// The range of corners of one polygon.
    pub fn range(&self, polygon: usize) -> std::ops::Range<usize> {
        self.starts[polygon] as usize..self.starts[polygon + 1] as usize
    }

    /// Adds one polygon.
    pub fn push(&mut self, corners: &[u32]) {
        if self.starts.is_empty() {
            self.starts.push(0);
        }
        self.corners.extend_from_slice(corners);
        self.starts.push(self.corners.len() as u32);
    }
}

impl Added {
    /// How many faces of a file became how many: `[faces of the file]` the range of those that each is now.
    pub fn ranges(&self) -> Vec<std::ops::Range<usize>> {
        let mut ranges: Vec<std::ops::Range<usize>> = Vec::new();
        for (index, &face) in self.faces.iter().enumerate() {
            ranges.resize((face as usize + 1).max(ranges.len()), index..index);
            ranges[face as usize].end = index + 1;
        }
        ranges
    }
}

impl Source {
    /// Whether all indices are in range, for a boundary of so many vertices and triangles.
    pub fn is_sound(&self, vertices: usize, triangles: usize) -> bool {
        let below = |indices: &[u32], count: usize| indices.iter().all(|&i| i == NONE || (i as usize) < count);
        let corners = self.polygons.corners.len();
        let optional = |len: usize, full: usize| len == 0 || len == full;
        let faces = if self.polygons.len() == 0 { triangles } else { self.polygons.len() };
        let own = vertices.checked_sub(self.added.ends.len());
        self.polygons.corners.iter().all(|&v| (v as usize) < vertices)
            && optional(self.corner_uvs.len(), corners)
            && optional(self.corner_normals.len(), corners)
            && optional(self.polygon_parts.len(), self.polygons.len())
            && optional(self.triangle_corners.len(), triangles)
            && optional(self.added.faces.len(), faces)
            && own.is_some_and(|own| {
                (own..).zip(&self.added.ends).all(|(v, ends)| ends.iter().all(|&e| (e as usize) < v))
            })
            && self.triangle_corners.iter().flatten().all(|&c| (c as usize) < corners)
            && below(&self.corner_uvs, self.uvs.len())
            && below(&self.corner_normals, self.normals.len())
            && self.polygon_parts.iter().all(|&p| (p as usize) < self.parts.len())
            && self
                .parts
                .iter()
                .all(|p| below(&[p.object], self.objects.len()) && below(&[p.material], self.materials.materials.len()))
    }
}

/// sRGB transfer function, IEC 61966-2-1. Both in 0..=1.
pub(crate) fn linear_from_srgb(value: f32) -> f32 {
    if value <= 0.040_45 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

/// Inverse of [`linear_from_srgb`]; in double precision, so that white stays 1 exactly.
pub(crate) fn srgb_from_linear(value: f32) -> f32 {
    let value = f64::from(value);
    (if value <= 0.003_130_8 { value * 12.92 } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 }) as f32
}
