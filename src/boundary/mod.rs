//! 3.1  **B**, the boundary: meshes in.

use std::path::Path;

use glam::{DVec3, Vec2};

use crate::{Error, Result};

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
    /// What was read otherwise than the file says: one sentence each.
    pub warnings: Vec<String>,
    /// STUB
    uvs: Option<Vec<Option<Vec2>>>,
}

/// STUB: a little OBJ.
///
/// # Errors
/// Bad files.
pub fn read(path: &Path) -> Result<Boundary> {
    let text = std::fs::read_to_string(path).map_err(|e| Error::reading(path, e))?;
    let name = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    let mut b = Boundary { name, ..Default::default() };
    let mut vts = Vec::new();
    let mut of = std::collections::BTreeMap::new();
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        let number = |i: usize| words.get(i).and_then(|w| w.parse::<f64>().ok()).unwrap_or(0.0);
        match words.first() {
            Some(&"v") => b.positions.push(DVec3::new(number(1), number(2), number(3))),
            Some(&"vt") => vts.push(Vec2::new(number(1) as f32, 1.0 - number(2) as f32)),
            Some(&"f") => {
                let corners: Vec<Vec<u32>> =
                    words[1..].iter().map(|w| w.split('/').filter_map(|i| i.parse().ok()).collect()).collect();
                for c in &corners {
                    if c.len() > 1 {
                        of.entry(c[0] - 1).or_insert(vts[c[1] as usize - 1]);
                    }
                }
                for i in 1..corners.len() - 1 {
                    b.triangles.push([corners[0][0] - 1, corners[i][0] - 1, corners[i + 1][0] - 1]);
                }
            }
            _ => {}
        }
    }
    if b.triangles.is_empty() {
        return Err(Error::in_file(path, "no faces"));
    }
    if !of.is_empty() {
        b.uvs = Some((0..b.positions.len() as u32).map(|v| of.get(&v).copied()).collect());
    }
    Ok(b)
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
        self.uvs.clone()
    }

    /// STUB
    pub fn base_colours(&self) -> Option<Vec<[f32; 4]>> {
        None
    }
}
