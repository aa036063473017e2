//! STL: binary, or text where the input was.

use std::fmt::Write as _;
use std::path::Path;

use glam::DVec3;

use super::normals::unit_normal;
use super::{Surface, number};
use crate::boundary::StlKind;
use crate::boundary::source::Original;
use crate::error::{Error, Result};

/// The mesh as an STL.
pub(super) fn write(surface: &Surface, path: &Path) -> Result<Vec<u8>> {
    match &surface.boundary.source.original {
        Original::Stl(StlKind::Ascii) => Ok(ascii(surface)),
        Original::Stl(StlKind::Binary { header, extras }) => binary(surface, header, extras, path),
        _ => binary(surface, b"homunculus", &[], path),
    }
}

fn binary(surface: &Surface, header: &[u8], extras: &[[u8; 2]], path: &Path) -> Result<Vec<u8>> {
    surface.check_single(DVec3::ZERO, path)?;
    let faces = &surface.boundary.source.added.faces;
    let triangles = &surface.boundary.triangles;
    let count = u32::try_from(triangles.len())
        .map_err(|_| Error::in_file(path, "it has more triangles than an STL can; write .ply instead"))?;
    let mut out = header.to_vec();
    out.resize(80, 0);
    out.extend(count.to_le_bytes());
    for (index, triangle) in triangles.iter().enumerate() {
        let corners = triangle.map(|v| surface.positions[v as usize]);
        for vector in [unit_normal(triangle, surface.positions)].iter().chain(&corners) {
            out.extend(vector.as_vec3().to_array().into_iter().flat_map(f32::to_le_bytes));
        }
        let face = faces.get(index).map_or(index, |&face| face as usize);
        out.extend(extras.get(face).copied().unwrap_or_default());
    }
    Ok(out)
}

fn ascii(surface: &Surface) -> Vec<u8> {
    let boundary = surface.boundary;
    let source = &boundary.source;
    let name_of = |triangle: usize| {
        let part = source.polygon_parts.get(triangle).and_then(|&part| source.parts.get(part as usize));
        part.and_then(|part| source.objects.get(part.object as usize)).map_or("", |object| object.name.as_str())
    };
    let part_of = |triangle: usize| source.polygon_parts.get(triangle).copied().unwrap_or(0);
    let mut out = String::new();
    for (index, triangle) in boundary.triangles.iter().enumerate() {
        if index == 0 || part_of(index) != part_of(index - 1) {
            if index > 0 {
                let _ = writeln!(out, "endsolid {}", name_of(index - 1));
            }
            let _ = writeln!(out, "solid {}", name_of(index));
        }
        let [x, y, z] = unit_normal(triangle, surface.positions).as_vec3().to_array();
        let _ = writeln!(out, "  facet normal {x} {y} {z}\n    outer loop");
        for &vertex in triangle {
            let [x, y, z] = surface.positions[vertex as usize].to_array().map(number);
            let _ = writeln!(out, "      vertex {x} {y} {z}");
        }
        out.push_str("    endloop\n  endfacet\n");
    }
    let _ = writeln!(out, "endsolid {}", name_of(boundary.triangles.len().saturating_sub(1)));
    out.into_bytes()
}
