//! Geomview OFF, with the variants COFF, NOFF, STOFF and their combinations, comments anywhere.
//!
//! Line by line: one vertex or face in a line, as every writer does it. Colours after the coordinates are read even where the
//! header does not announce them.
//!
//! Own code. Why not `off-rs`: it refuses every file whose first line is not `OFF` alone, so `COFF`, `NOFF`
//! and `OFF 3 1 0`, and reads single precision.

use std::path::Path;
use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3};

use super::obj::colour_attributes;
use super::source::Original;
use super::{Boundary, format};
use crate::error::{Error, Result};

/// The text of an OFF, and where its vertices are.
#[derive(Debug, Clone)]
pub(crate) struct OffText {
    /// All of it.
    pub text: Arc<str>,
    /// How many lines with content come before the first vertex.
    pub before: usize,
    /// How many vertices there are.
    pub vertices: usize,
    /// How many lines of faces there are, those with fewer than three corners included.
    pub faces: usize,
    /// Whether normals follow the coordinates.
    pub normals: bool,
}

/// The part of a line before its comment, without space around it.
pub(crate) fn content(line: &str) -> &str {
    line.split('#').next().unwrap_or("").trim()
}

/// Reads an OFF.
pub(crate) fn read(path: &Path, bytes: &[u8]) -> Result<Boundary> {
    let text: Arc<str> = format::text(bytes).into();
    parse(&text).map_err(|sentence| Error::in_file(path, sentence))
}

fn parse(text: &Arc<str>) -> Result<Boundary, String> {
    let mut lines =
        text.lines().enumerate().map(|(i, line)| (i + 1, content(line))).filter(|(_, line)| !line.is_empty());
    let mut before = 1;
    let (mut number, first) = lines.next().ok_or("there is only a comment in it; export the mesh again")?;
    let (keyword, mut counts) = match first.split_once("OFF") {
        Some((keyword, counts)) => (keyword, counts.trim()),
        None => ("", first),
    };
    if keyword.contains('4') || counts.starts_with(['n', 'B']) {
        return Err(format!(
            "line {number}: \"{first}\" announces more than three dimensions or binary numbers; save it as plain OFF"
        ));
    }
    if counts.is_empty() {
        (number, counts) = lines.next().ok_or("it ends after its first line; get the whole file again")?;
        before += 1;
    }
    let (normals, colours, uvs) = (keyword.contains('N'), keyword.contains('C'), keyword.contains("ST"));
    let mut claims = counts.split_whitespace().map(|word| word.parse::<usize>());
    let (Some(Ok(vertices)), Some(Ok(faces))) = (claims.next(), claims.next()) else {
        return Err(format!(
            "line {number}: \"{counts}\" should say how many vertices and faces there are; repair that line"
        ));
    };
    // A vertex takes six characters at least ("0 0 0\n"), a face two.
    if vertices.saturating_mul(6).saturating_add(faces.saturating_mul(2)) > text.len() + 2 {
        let length = text.len();
        return Err(format!(
            "line {number}: it claims {vertices} vertices and {faces} faces, which {length} bytes cannot hold; get the whole file again"
        ));
    }

    let mut boundary = Boundary::default();
    let mut tints = Vec::new();
    for vertex in 0..vertices {
        let (number, line) = lines
            .next()
            .ok_or_else(|| format!("it ends at vertex {vertex} of {vertices}; get the whole file again"))?;
        let values: Vec<f64> = line.split_whitespace().map_while(|word| word.parse().ok()).collect();
        let expected = 3 + if normals { 3 } else { 0 };
        if values.len() < expected {
            return Err(format!(
                "line {number}: vertex {vertex} should have {expected} numbers, not \"{line}\"; repair that line"
            ));
        }
        boundary.positions.push(DVec3::new(values[0], values[1], values[2]));
        if normals {
            boundary.source.normals.push(Vec3::new(values[3] as f32, values[4] as f32, values[5] as f32));
        }
        let mut rest = &values[expected..];
        if let (true, Some((start, &[u, v]))) = (uvs, rest.split_last_chunk::<2>()) {
            boundary.source.uvs.push(Vec2::new(u as f32, 1.0 - v as f32));
            rest = start;
        }
        if let (&[r, g, b, ref alpha @ ..], true) = (rest, colours || !uvs) {
            tints.resize(vertex, [1.0; 4]);
            tints.push([r as f32, g as f32, b as f32, alpha.first().map_or(1.0, |&a| a as f32)]);
        }
    }
    if boundary.source.uvs.len() != vertices {
        boundary.source.uvs.clear();
    }
    if !tints.is_empty() {
        tints.resize(vertices, [1.0; 4]);
        boundary.attributes = colour_attributes(&tints);
    }
    let mut short = 0;
    let mut corners = Vec::new();
    for face in 0..faces {
        let (number, line) =
            lines.next().ok_or_else(|| format!("it ends at face {face} of {faces}; get the whole file again"))?;
        let mut words = line.split_whitespace();
        let sides: usize = words.next().and_then(|word| word.parse().ok()).ok_or_else(|| {
            format!("line {number}: face {face} should start with its number of corners; repair that line")
        })?;
        corners.clear();
        for _ in 0..sides {
            let word = words.next().ok_or_else(|| {
                format!("line {number}: face {face} claims {sides} corners but has fewer; repair that line")
            })?;
            let index = word.parse::<usize>().ok().filter(|&i| i < vertices).ok_or_else(|| {
                format!("line {number}: face {face} refers to vertex {word}, but there are {vertices}, counted from 0; repair that line")
            })?;
            corners.push(index as u32);
        }
        if sides < 3 {
            short += 1;
            continue;
        }
        boundary.source.polygons.push(&corners);
    }
    if short > 0 {
        boundary.warnings.push(format!("{short} faces with fewer than three corners are left out"));
    }
    if !boundary.source.uvs.is_empty() {
        boundary.source.corner_uvs = boundary.source.polygons.corners.clone();
    }
    if normals {
        boundary.source.corner_normals = boundary.source.polygons.corners.clone();
    }
    boundary.triangulate_polygons();
    boundary.source.original = Original::Off(OffText { text: text.clone(), before, vertices, faces, normals });
    Ok(boundary)
}
