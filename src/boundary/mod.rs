//! 3.1  **B**, the boundary: meshes in.
//!
//! [`read`] takes glTF (`.gltf`, `.glb`), OBJ, PLY, STL and OFF. The format is recognised by what the file says,
//! and by its extension only where the content leaves it open.
//!
//! # What is promised
//!
//! - Vertices keep the order of the file, triangles the order of the file's faces; nothing is merged, dropped or reordered.
//!   An STL stays a soup: three vertices for each triangle.
//! - Positions are what the file says, in its units. glTF scenes are taken as a viewer shows them at rest: node transforms,
//!   skins and default morph weights are baked into world positions.
//! - No file makes this panic, hang or allocate much more than its own size: a header's claims are checked against the
//!   length of the file before anything is reserved.
//! - Whatever [`crate::export`] needs to write the same file with other positions is kept in a private part of [`Boundary`].

pub(crate) mod format;
mod gltf;
pub(crate) mod mtl;
mod obj;
mod off;
mod ply;
pub(crate) mod ply_table;
pub(crate) mod precision;
mod soup;
pub(crate) mod source;
mod split;
mod stl;
mod triangulate;

use std::path::Path;

use glam::{DVec3, Vec2};

use crate::error::{Error, Result};
pub(crate) use format::Kind;
pub(crate) use obj::{ObjText, face_corners};
pub(crate) use off::{OffText, content as off_content};
pub(crate) use ply::{LIST_NAMES, colour_scale};
pub(crate) use soup::Sets;
pub(crate) use source::Source;
pub use split::{Split, split_edges, split_long};
pub(crate) use stl::StlKind;

/// The boundary surface B: what was read from a file or modelled by the gallery.
///
/// Vertices keep the order of the file; the surface may be a soup: open, non-manifold, self-intersecting.
#[derive(Debug, Clone, Default)]
pub struct Boundary {
    /// What to call it: the file's stem or the scene's name.
    pub name: String,
    /// `[vertices]` positions in source units, finite.
    pub positions: Vec<DVec3>,
    /// `[triangles]` indices into `positions`, all in range; polygons are triangulated.
    pub triangles: Vec<[u32; 3]>,
    /// Named per-vertex values (PLY properties, glTF attributes and colour channels).
    pub attributes: Vec<Attribute>,
    /// Named sets of vertices, with a region index or `u32::MAX` for each vertex.
    pub regions: Option<Regions>,
    /// What was read otherwise than the file says (a texture that is missing, …): one sentence each.
    pub warnings: Vec<String>,
    /// What the export needs beyond the above: polygons, corners, materials, the original text.
    pub(crate) source: Source,
}

/// One named per-vertex scalar.
#[derive(Debug, Clone)]
pub struct Attribute {
    /// Its name in the file, for example `quality`, `_PRESSURE`, `red`, `COLOR_0.r`.
    pub name: String,
    /// `[vertices]`, as in the file (colours as 0..=1); not a number where the file says so.
    pub values: Vec<f32>,
}

/// A partition of (some of) the vertices into named regions.
#[derive(Debug, Clone, Default)]
pub struct Regions {
    /// Names, in order of first appearance.
    pub names: Vec<String>,
    /// `[vertices]` index into `names`, `u32::MAX` where a vertex belongs to none.
    pub of_vertex: Vec<u32>,
}

/// Reads a boundary from a mesh file.
///
/// # Errors
///
/// [`Error::File`] where the system refuses, [`Error::Input`] where the content cannot be used: one sentence with the file,
/// the line or element, and what to do. A file whose triangles all have zero area is refused too.
pub fn read(path: &Path) -> Result<Boundary> {
    let bytes = format::load(path)?;
    let mut boundary = match format::recognise(path, &bytes)? {
        Kind::Gltf => gltf::read(path, &bytes)?,
        Kind::Obj => obj::read(path, &bytes)?,
        Kind::Ply => ply::read(path, &bytes)?,
        Kind::Stl => stl::read(path, &bytes)?,
        Kind::Off => off::read(path, &bytes)?,
    };
    boundary.name = path.file_stem().map_or_else(|| "mesh".into(), |stem| stem.to_string_lossy().into_owned());
    boundary.source.folder = path.parent().map(Path::to_path_buf);
    boundary.check(path)?;
    Ok(boundary)
}

impl Boundary {
    /// A boundary from bare triangles (gallery models, tests).
    pub fn from_triangles(name: &str, positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Self {
        Self { name: name.into(), positions, triangles, ..Self::default() }
    }

    /// A boundary from bare triangles with one texture coordinate, `(0, 0)` upper left, for each vertex.
    pub(crate) fn textured(name: &str, positions: Vec<DVec3>, triangles: Vec<[u32; 3]>, uvs: Vec<Vec2>) -> Self {
        let mut boundary = Self::from_triangles(name, positions, triangles);
        for (k, triangle) in (0_u32..).zip(&boundary.triangles) {
            boundary.source.polygons.push(triangle);
            boundary.source.triangle_corners.push([3 * k, 3 * k + 1, 3 * k + 2]);
        }
        boundary.source.corner_uvs = boundary.source.polygons.corners.clone();
        boundary.source.uvs = uvs;
        boundary
    }

    /// The same with a PNG as its texture, shown as it is (unlit), alpha included.
    pub(crate) fn with_texture(mut self, name: &str, png: Vec<u8>) -> Self {
        let materials = &mut self.source.materials;
        materials.images = vec![source::Image { name: name.into(), mime: "image/png".into(), bytes: png }];
        materials.samplers = vec![serde_json::json!({ "wrapS": 33071, "wrapT": 33071 })];
        materials.textures = vec![serde_json::json!({ "sampler": 0, "source": 0 })];
        materials.materials = vec![serde_json::json!({
            "name": name,
            "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 }, "metallicFactor": 0.0, "roughnessFactor": 1.0 },
            "alphaMode": "BLEND",
            "doubleSided": true,
            "extensions": { "KHR_materials_unlit": {} },
        })];
        materials.extensions_used = vec!["KHR_materials_unlit".into()];
        self.source.parts = vec![source::Part { object: source::NONE, material: 0, extensions: None }];
        self.source.polygon_parts = vec![0; self.source.polygons.len()];
        self
    }

    /// `[vertices]` the first triangle that has each, and as which corner; `None` for a vertex of no triangle.
    pub(crate) fn first_corners(&self) -> Vec<Option<(usize, usize)>> {
        let mut first = vec![None; self.positions.len()];
        for (triangle, corners) in self.triangles.iter().enumerate().rev() {
            for (corner, vertex) in corners.iter().enumerate() {
                if let Some(place) = first.get_mut(*vertex as usize) {
                    *place = Some((triangle, corner));
                }
            }
        }
        first
    }

    /// `[vertices]` texture coordinates: the first one used by each vertex, `None` where it has none.
    ///
    /// `(0, 0)` is the upper left corner of the image and v grows downwards, as in glTF.
    pub fn vertex_uvs(&self) -> Option<Vec<Option<Vec2>>> {
        let source = &self.source;
        if source.uvs.is_empty() {
            return None;
        }
        let mut uvs = vec![None; self.positions.len()];
        for (&vertex, &uv) in source.polygons.corners.iter().zip(&source.corner_uvs) {
            if let Some(slot) = uvs.get_mut(vertex as usize) {
                *slot = slot.or_else(|| source.uvs.get(uv as usize).copied());
            }
        }
        Some(uvs)
    }

    /// `[vertices]` linear RGBA in 0..=1 where the file has a colour for each vertex. What is not a number reads as 1.
    ///
    /// glTF colours are linear already; those of OBJ, PLY and OFF are taken as sRGB, which is what their writers mean.
    pub fn base_colours(&self) -> Option<Vec<[f32; 4]>> {
        let channel = |name: &str| self.attributes.iter().find(|a| a.name == name).map(|a| a.values.as_slice());
        let names = source::COLOUR_CHANNELS.iter().find(|names| channel(names[0]).is_some())?;
        let (red, green, blue) = (channel(names[0])?, channel(names[1])?, channel(names[2])?);
        let alpha = channel(names[3]);
        let srgb = names[0] == "red";
        let clean = |value: f32| if value.is_finite() { value.clamp(0.0, 1.0) } else { 1.0 };
        let linear = |value: f32| if srgb { source::linear_from_srgb(clean(value)) } else { clean(value) };
        let at = |values: &[f32], vertex: usize| values.get(vertex).copied().unwrap_or(1.0);
        let colour = |vertex: usize| {
            let opacity = alpha.map_or(1.0, |values| clean(at(values, vertex)));
            [linear(at(red, vertex)), linear(at(green, vertex)), linear(at(blue, vertex)), opacity]
        };
        Some((0..self.positions.len()).map(colour).collect())
    }

    /// Whether indices are in range, positions finite, and arrays of one length.
    pub fn is_sound(&self) -> bool {
        let count = self.positions.len();
        self.positions.iter().all(|p| p.is_finite())
            && self.triangles.iter().flatten().all(|&v| (v as usize) < count)
            && self.attributes.iter().all(|a| a.values.len() == count)
            && self.regions.as_ref().is_none_or(|r| {
                r.of_vertex.len() == count && r.of_vertex.iter().all(|&i| i == u32::MAX || (i as usize) < r.names.len())
            })
            && self.source.is_sound(count, self.triangles.len())
    }

    /// What no format may leave behind: nothing to warp, positions that are no numbers, broken indices.
    fn check(&self, path: &Path) -> Result<()> {
        if self.positions.is_empty() {
            return Err(Error::in_file(path, "there are no vertices in it; export the mesh again with its geometry"));
        }
        if let Some(vertex) = self.positions.iter().position(|p| !p.is_finite()) {
            let p = self.positions[vertex];
            return Err(Error::in_file(
                path,
                format!(
                    "vertex {vertex} is at ({}, {}, {}), which is no place; repair the file or remove that vertex",
                    p.x, p.y, p.z
                ),
            ));
        }
        if self.triangles.is_empty() {
            let sentence = format!(
                "it has {} vertices but no faces, so it bounds nothing; reconstruct a surface first",
                self.positions.len()
            );
            return Err(Error::in_file(path, sentence));
        }
        if !self.triangles.iter().any(|t| self.is_proper(t)) {
            let sentence = format!(
                "each of its {} triangles has zero area; check the scale and the axes it was exported with",
                self.triangles.len()
            );
            return Err(Error::in_file(path, sentence));
        }
        if !self.is_sound() {
            return Err(Error::Fault(format!("reading {} left indices out of range", path.display())));
        }
        Ok(())
    }

    /// Whether a triangle has an area that is not zero, at any scale: the sides are divided by the longest first.
    fn is_proper(&self, &[a, b, c]: &[u32; 3]) -> bool {
        let [a, b, c] = [a, b, c].map(|v| self.positions[v as usize]);
        let (ab, ac) = (b - a, c - a);
        let scale = ab.abs().max(ac.abs()).max_element();
        scale > 0.0 && scale.is_finite() && (ab / scale).cross(ac / scale) != DVec3::ZERO
    }
}
