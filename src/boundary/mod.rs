//! 3.1  **B**, the boundary: meshes in.

use glam::{DVec3, Vec2};

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
}

/// One named per-vertex scalar.
#[derive(Debug, Clone)]
pub struct Attribute {
    /// Its name in the file, for example `quality`, `_PRESSURE`, `red`, `COLOR_0.r`.
    pub name: String,
    /// `[vertices]`, as in the file (colours as 0..=1).
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

impl Boundary {
    /// A boundary from bare triangles (gallery models, tests).
    pub fn from_triangles(name: &str, positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Self {
        Self { name: name.into(), positions, triangles, ..Self::default() }
    }

    /// `[vertices]` texture coordinates: the first one used by each vertex, `None` where it has none.
    pub fn vertex_uvs(&self) -> Option<Vec<Option<Vec2>>> {
        None
    }
}
