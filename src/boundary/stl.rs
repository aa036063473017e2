//! STL, text and binary: a soup, each corner a vertex as in the file.
//!
//! Binary ones are read by `stl_io`, text by own code. Why not `stl_io` for both: of a text with two solids it gives the first and
//! drops the second without a word; it refuses facets whose normal is `nan`, as writers say of slivers, and rounds coordinates to
//! single precision (500123.456 becomes 500123.47).

use std::borrow::Cow;
use std::io::Cursor;
use std::path::Path;

use glam::{DVec3, Vec3};

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
    let mut whole = Cow::Borrowed(bytes);
    if bytes.starts_with(b"solid") {
        // The word of a text, which the crate would take it for.
        whole.to_mut()[..5].fill(b' ');
    }
    let mut cursor = Cursor::new(&*whole);
    let unreadable = |why: std::io::Error| format!("it cannot be read as binary STL ({why}); export the mesh again");
    let mut boundary = Boundary::default();
    for triangle in stl_io::create_stl_reader(&mut cursor).map_err(unreadable)? {
        let first = boundary.positions.len() as u32;
        let corners = triangle.map_err(unreadable)?.vertices;
        boundary.positions.extend(corners.map(|corner| Vec3::from_array(corner.0).as_dvec3()));
        boundary.triangles.push([first, first + 1, first + 2]);
    }
    // The crate passes over these.
    let extras = body.chunks_exact(50).take(count).map(|triangle| [triangle[48], triangle[49]]).collect();
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
