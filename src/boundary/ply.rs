//! Stanford PLY: polygons, colours, normals, texture coordinates, and any other number per vertex.

use std::path::Path;

use glam::{DVec3, Vec2, Vec3};
use serde_json::json;

use super::ply_table::{Element, PlyTable, Property};
use super::source::{NONE, Original, Part};
use super::{Attribute, Boundary, format, mtl};
use crate::error::{Error, Result};

/// Names of texture coordinates in use among writers.
pub(crate) const UV_NAMES: [[&str; 2]; 4] =
    [["s", "t"], ["u", "v"], ["texture_u", "texture_v"], ["texture_s", "texture_t"]];

/// Names of the list of a face's corners.
pub(crate) const LIST_NAMES: [&str; 2] = ["vertex_indices", "vertex_index"];

/// Reads a PLY.
pub(crate) fn read(path: &Path, bytes: &[u8]) -> Result<Boundary> {
    let table = PlyTable::parse(bytes).map_err(|sentence| Error::in_file(path, sentence))?;
    let mut boundary = Boundary::default();
    let vertex = table
        .element("vertex")
        .ok_or_else(|| Error::in_file(path, "the header has no element vertex; export the mesh again"))?;
    vertices(vertex, &mut boundary).map_err(|sentence| Error::in_file(path, sentence))?;
    for (name, is_strip) in [("face", false), ("tristrips", true)] {
        if let Some(element) = table.element(name) {
            faces(element, is_strip, &mut boundary).map_err(|sentence| Error::in_file(path, sentence))?;
        }
    }
    let mut corner_uvs = std::mem::take(&mut boundary.source.corner_uvs);
    corner_uvs.resize(boundary.source.polygons.corners.len(), NONE);
    if corner_uvs.iter().any(|&i| i != NONE) {
        boundary.source.corner_uvs = corner_uvs;
    } else if !boundary.source.uvs.is_empty() {
        boundary.source.corner_uvs = boundary.source.polygons.corners.clone();
    }
    if !boundary.source.normals.is_empty() {
        boundary.source.corner_normals = boundary.source.polygons.corners.clone();
    }
    texture(path, &table, &mut boundary);
    boundary.triangulate_polygons();
    boundary.source.original = Original::Ply(table);
    Ok(boundary)
}

fn vertices(vertex: &Element, boundary: &mut Boundary) -> Result<(), String> {
    let column = |name: &str| vertex.property(name).filter(|p| p.length.is_none());
    let (Some(x), Some(y), Some(z)) = (column("x"), column("y"), column("z")) else {
        return Err("its vertices lack one of the properties x, y and z; export the mesh again".into());
    };
    boundary.positions = (0..vertex.count).map(|i| DVec3::new(x.values[i], y.values[i], z.values[i])).collect();
    let mut known = vec!["x", "y", "z"];
    if let (Some(x), Some(y), Some(z)) = (column("nx"), column("ny"), column("nz")) {
        boundary.source.normals =
            (0..vertex.count).map(|i| Vec3::new(x.values[i] as f32, y.values[i] as f32, z.values[i] as f32)).collect();
        known.extend(["nx", "ny", "nz"]);
    }
    for [u, v] in UV_NAMES {
        if let (Some(us), Some(vs), true) = (column(u), column(v), boundary.source.uvs.is_empty()) {
            boundary.source.uvs =
                us.values.iter().zip(&vs.values).map(|(&u, &v)| Vec2::new(u as f32, 1.0 - v as f32)).collect();
            known.extend([u, v]);
        }
    }
    for property in vertex.properties.iter().filter(|p| p.length.is_none() && !known.contains(&p.name.as_str())) {
        let scale = colour_scale(property);
        let values = property.values.iter().map(|&value| (value / scale) as f32).collect();
        boundary.attributes.push(Attribute { name: property.name.clone(), values });
    }
    Ok(())
}

/// What a colour channel is divided by to be in 0..=1; 1 for what is no colour.
pub(crate) fn colour_scale(property: &Property) -> f64 {
    let is_colour = ["red", "green", "blue", "alpha"].iter().any(|c| property.name.ends_with(c));
    if is_colour { property.scalar.largest().unwrap_or(1.0) } else { 1.0 }
}

/// Appends the faces of an element, with their own texture coordinates where they have some.
fn faces(element: &Element, is_strip: bool, boundary: &mut Boundary) -> Result<(), String> {
    let name = &element.name;
    let lists = LIST_NAMES.iter().find_map(|n| element.property(n)).filter(|p| p.length.is_some());
    let lists = lists.ok_or_else(|| format!("its element {name} has no list vertex_indices; export the mesh again"))?;
    let texcoords = element.property("texcoord").filter(|p| p.length.is_some() && !is_strip);
    let count = boundary.positions.len();
    let source = &mut boundary.source;
    let mut short = 0;
    let mut corners = Vec::new();
    for row in 0..element.count {
        corners.clear();
        for &index in lists.list(row) {
            if index == -1.0 && is_strip {
                corners.push(NONE);
            } else if index >= 0.0 && index < count as f64 && index.fract() == 0.0 {
                corners.push(index as u32);
            } else {
                return Err(format!(
                    "{name} {row} refers to vertex {index}, but there are {count}; repair or remove that {name}"
                ));
            }
        }
        if is_strip {
            corners.split(|&v| v == NONE).for_each(|strip| {
                let turned = |(i, t): (usize, &[u32])| if i % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] };
                strip.windows(3).enumerate().map(turned).for_each(|triangle| source.polygons.push(&triangle));
            });
            continue;
        }
        if corners.len() < 3 {
            short += 1;
            continue;
        }
        source.polygons.push(&corners);
        let Some(texcoords) = texcoords else { continue };
        let pairs = texcoords.list(row);
        for corner in 0..corners.len() {
            source.corner_uvs.push(match pairs.get(2 * corner..2 * corner + 2) {
                Some(&[u, v]) => {
                    source.uvs.push(Vec2::new(u as f32, 1.0 - v as f32));
                    source.uvs.len() as u32 - 1
                }
                _ => NONE,
            });
        }
    }
    if short > 0 {
        boundary.warnings.push(format!("{short} faces with fewer than three corners are left out"));
    }
    Ok(())
}

/// The texture that MeshLab names in a comment.
fn texture(path: &Path, table: &PlyTable, boundary: &mut Boundary) {
    let file = table.comments.iter().find_map(|comment| comment.strip_prefix("comment TextureFile "));
    let Some(file) = file.map(str::trim).filter(|_| !boundary.source.uvs.is_empty()) else { return };
    let image = mtl::load_image(path.parent().unwrap_or(Path::new("")), file, &mut boundary.warnings);
    let source = &mut boundary.source;
    source.materials.images.push(image);
    source.materials.textures.push(json!({ "source": 0 }));
    let pbr = json!({ "baseColorTexture": { "index": 0 }, "metallicFactor": 0.0, "roughnessFactor": 0.8 });
    source
        .materials
        .materials
        .push(json!({ "name": format::text(file.as_bytes()), "pbrMetallicRoughness": pbr, "doubleSided": true }));
    source.parts.push(Part { object: NONE, material: 0, extensions: None });
    source.polygon_parts = vec![0; source.polygons.len()];
}
