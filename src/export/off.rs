//! OFF: the input's own lines with other numbers, or a new file.

use std::fmt::Write as _;

use super::{Surface, byte, number, off_pieces, srgb};
use crate::boundary::source::Original;
use crate::boundary::{OffText, off_content};

/// The mesh as an OFF.
pub(super) fn write(surface: &Surface) -> Vec<u8> {
    let is_split = !surface.boundary.source.added.faces.is_empty();
    match &surface.boundary.source.original {
        Original::Off(text) if surface.colours.is_none() && !is_split => again(surface, text),
        Original::Off(text) if surface.colours.is_none() => off_pieces::again(surface, text),
        _ => anew(surface),
    }
}

/// The same lines, with other coordinates at the start of the vertex lines.
fn again(surface: &Surface, original: &OffText) -> Vec<u8> {
    let normals = original.normals.then(|| surface.vertex_normals());
    let mut out = String::with_capacity(original.text.len());
    let mut seen = 0;
    for line in original.text.lines() {
        let words = off_content(line);
        let vertex = if words.is_empty() {
            None
        } else {
            seen += 1;
            (seen - 1usize).checked_sub(original.before)
        };
        let Some(vertex) = vertex.filter(|&v| v < original.vertices) else {
            out.push_str(line);
            out.push('\n');
            continue;
        };
        let [x, y, z] = surface.positions[vertex].to_array().map(number);
        let _ = write!(out, "{x} {y} {z}");
        if let Some(normal) = normals.as_ref().map(|normals| normals[vertex]) {
            let _ = write!(out, " {} {} {}", normal.x, normal.y, normal.z);
        }
        for word in words.split_whitespace().skip(if normals.is_some() { 6 } else { 3 }) {
            let _ = write!(out, " {word}");
        }
        out.push('\n');
    }
    out.into_bytes()
}

fn anew(surface: &Surface) -> Vec<u8> {
    let tints = surface.tints();
    let mut out = String::from(if tints.is_some() { "COFF\n" } else { "OFF\n" });
    let _ = writeln!(out, "{} {} 0", surface.positions.len(), surface.polygons().count());
    for (vertex, position) in surface.positions.iter().enumerate() {
        let [x, y, z] = position.to_array().map(number);
        let _ = write!(out, "{x} {y} {z}");
        if let Some(tints) = &tints {
            let [r, g, b, a] = srgb(tints[vertex]).map(byte);
            let _ = write!(out, " {r} {g} {b} {a}");
        }
        out.push('\n');
    }
    for polygon in surface.polygons() {
        let _ = write!(out, "{}", polygon.len());
        for vertex in polygon {
            let _ = write!(out, " {vertex}");
        }
        out.push('\n');
    }
    out.into_bytes()
}
