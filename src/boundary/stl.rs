//! STL, text and binary: a soup, each corner a vertex as in the file.

use std::path::Path;

use glam::DVec3;

use super::source::{NONE, Object, Original, Part};
use super::{Boundary, format};
use crate::error::{Error, Result};

/// The flavour of an STL.
#[derive(Debug, Clone)]
pub(crate) enum StlKind {
    /// Text; the names of its solids are objects.
    Ascii,
    /// Binary.
    Binary {
        /// The 80 bytes before the count.
        header: Vec<u8>,
        /// `[triangles]` the two bytes after each triangle, colours in some dialects.
        extras: Vec<[u8; 2]>,
    },
}

/// Reads an STL.
pub(crate) fn read(path: &Path, bytes: &[u8]) -> Result<Boundary> {
    let claimed = bytes.get(80..84).map(|c| u32::from_le_bytes([c[0], c[1], c[2], c[3]]) as usize);
    let has_length_of_binary = claimed.is_some_and(|count| bytes.len() as u64 == 84 + 50 * count as u64);
    let head = bytes.trim_ascii_start();
    let is_wide = bytes.starts_with(&[0xFF, 0xFE]) || bytes.starts_with(&[0xFE, 0xFF]);
    let says_solid = head.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    let is_text = is_wide || says_solid && !head[..head.len().min(512)].contains(&0);
    if is_text && !has_length_of_binary {
        return ascii(&format::text(bytes)).map_err(|sentence| Error::in_file(path, sentence));
    }
    let count = claimed.ok_or_else(|| {
        Error::in_file(path, format!("{} bytes are too few for an STL; get the whole file again", bytes.len()))
    })?;
    binary(bytes, count).map_err(|sentence| Error::in_file(path, sentence))
}

fn binary(bytes: &[u8], count: usize) -> Result<Boundary, String> {
    let body = &bytes[84..];
    if count > body.len() / 50 {
        let there = body.len() / 50;
        return Err(format!("it claims {count} triangles but holds {there}; get the whole file again"));
    }
    let mut boundary = Boundary::default();
    let mut extras = Vec::with_capacity(count);
    for triangle in body.chunks_exact(50).take(count) {
        let number = |at: usize| {
            f64::from(f32::from_le_bytes([triangle[at], triangle[at + 1], triangle[at + 2], triangle[at + 3]]))
        };
        let first = boundary.positions.len() as u32;
        boundary.positions.extend([12, 24, 36].map(|at| DVec3::new(number(at), number(at + 4), number(at + 8))));
        boundary.triangles.push([first, first + 1, first + 2]);
        extras.push([triangle[48], triangle[49]]);
    }
    if body.len() > count * 50 {
        boundary.warnings.push(format!("{} bytes after the last triangle are left out", body.len() - count * 50));
    }
    boundary.source.original = Original::Stl(StlKind::Binary { header: bytes[..80].to_vec(), extras });
    Ok(boundary)
}

fn ascii(text: &str) -> Result<Boundary, String> {
    let mut boundary = Boundary::default();
    let mut in_facet = 0;
    boundary.source.parts.push(Part { object: NONE, material: NONE, extensions: None });
    for (number, line) in (1..).zip(text.lines().map(str::trim)) {
        let mut words = line.split_whitespace();
        match words.next().map(str::to_ascii_lowercase).as_deref() {
            Some("solid") => {
                let name = line[5..].trim().to_owned();
                boundary.source.objects.push(Object { name, extras: None });
                let object = boundary.source.objects.len() as u32 - 1;
                boundary.source.parts.push(Part { object, material: NONE, extensions: None });
            }
            Some("facet") => in_facet = 0,
            Some("vertex") => {
                let values: Vec<f64> = words.map_while(|word| word.parse().ok()).collect();
                let &[x, y, z] = values.as_slice() else {
                    return Err(format!("line {number}: \"{line}\" does not place a vertex; give three numbers"));
                };
                boundary.positions.push(DVec3::new(x, y, z));
                in_facet += 1;
            }
            Some("endfacet") if in_facet != 3 => {
                return Err(format!(
                    "line {number}: a facet has {in_facet} vertices; an STL has triangles only, so repair that facet"
                ));
            }
            Some("endfacet") => {
                let next = boundary.positions.len() as u32;
                boundary.triangles.push([next - 3, next - 2, next - 1]);
                boundary.source.polygons.push(&[next - 3, next - 2, next - 1]);
                boundary.source.triangle_corners.push([next - 3, next - 2, next - 1]);
                boundary.source.polygon_parts.push(boundary.source.parts.len() as u32 - 1);
            }
            _ => {}
        }
    }
    if boundary.positions.len() != 3 * boundary.triangles.len() {
        return Err(format!("it ends within facet {}; get the whole file again", boundary.triangles.len()));
    }
    boundary.regions_from_parts();
    boundary.source.original = Original::Stl(StlKind::Ascii);
    Ok(boundary)
}
