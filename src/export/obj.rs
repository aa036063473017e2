//! OBJ: the input's own lines with other numbers, or a new file with its material library.

use std::fmt::Write as _;
use std::path::Path;

use super::normals::Smoothing;
use super::{Surface, library, number, obj_pieces, srgb};
use crate::boundary::source::{NONE, Original};
use crate::boundary::{ObjText, face_corners};
use crate::error::Result;

/// The mesh as an OBJ; its library and textures are written beside `path`.
pub(super) fn write(surface: &Surface, path: &Path) -> Result<Vec<u8>> {
    match &surface.boundary.source.original {
        Original::Obj(text) if surface.boundary.source.added.faces.is_empty() => again(surface, text, path),
        Original::Obj(text) => obj_pieces::again(surface, text, path),
        _ => anew(surface, path),
    }
}

/// The same lines, with other coordinates and normals.
///
/// `vn` lines are left out where they stood and all come before the first face: warped faces that shared a normal no longer do.
fn again(surface: &Surface, original: &ObjText, path: &Path) -> Result<Vec<u8>> {
    let tints = surface.colours.is_some().then(|| surface.tints()).flatten();
    let normals = CornerNormals::new(surface);
    let mut out = String::new();
    let (mut vertex, mut corner) = (0, 0);
    for (_, line) in original.lines() {
        let keyword = line.split_whitespace().next().unwrap_or("");
        match keyword {
            "v" => {
                put_vertex(&mut out, surface, vertex);
                match &tints {
                    Some(tints) => put_colour(&mut out, tints[vertex]),
                    None => line.split_whitespace().skip(4).for_each(|word| {
                        let _ = write!(out, " {word}");
                    }),
                }
                vertex += 1;
                out.push('\n');
            }
            "vn" if normals.is_some() => {}
            "mtllib" => {
                let rest = line.trim_start()[keyword.len()..].trim();
                let _ = writeln!(out, "mtllib {}", library::bring_along(surface.boundary, rest, path)?);
            }
            _ => match (face_corners(&line), &normals) {
                (Some(corners), Some(normals)) => {
                    if corner == 0 {
                        normals.put_table(&mut out);
                    }
                    out.push('f');
                    for word in corners {
                        let mut parts = word.split('/');
                        let (v, vt) = (parts.next().unwrap_or(""), parts.next().unwrap_or(""));
                        let _ = write!(out, " {v}/{vt}/{}", normals.index(corner));
                        corner += 1;
                    }
                    out.push('\n');
                }
                _ => {
                    out.push_str(&line);
                    out.push('\n');
                }
            },
        }
    }
    Ok(out.into_bytes())
}

fn anew(surface: &Surface, path: &Path) -> Result<Vec<u8>> {
    let boundary = surface.boundary;
    let source = &boundary.source;
    let tints = surface.tints();
    let normals = CornerNormals::new(surface);
    let mut out = String::new();
    let materials = if surface.colours.is_none() { library::write(boundary, path)? } else { None };
    if let Some((library, _)) = &materials {
        let _ = writeln!(out, "mtllib {library}");
    }
    for vertex in 0..surface.positions.len() {
        put_vertex(&mut out, surface, vertex);
        if let Some(tints) = &tints {
            put_colour(&mut out, tints[vertex]);
        }
        out.push('\n');
    }
    for uv in &source.uvs {
        let _ = writeln!(out, "vt {} {}", uv.x, 1.0 - uv.y);
    }
    if let Some(normals) = &normals {
        normals.put_table(&mut out);
    }
    let (mut object, mut material) = (NONE, NONE);
    let mut corner = 0;
    for (index, polygon) in surface.polygons().enumerate() {
        if let Some(part) = source.polygon_parts.get(index).and_then(|&part| source.parts.get(part as usize)) {
            if let Some(named) = source.objects.get(part.object as usize).filter(|_| part.object != object) {
                let _ = writeln!(out, "o {}", one_line(&named.name));
            }
            if let (Some((_, names)), true) = (&materials, part.material != material) {
                let _ = writeln!(out, "usemtl {}", names.get(part.material as usize).map_or("none", String::as_str));
            }
            (object, material) = (part.object, part.material);
        }
        out.push('f');
        for vertex in polygon {
            let uv = source.corner_uvs.get(corner).copied().filter(|&uv| uv != NONE).map(|uv| uv + 1);
            let _ = match (uv, &normals) {
                (None, None) => write!(out, " {}", vertex + 1),
                (Some(uv), None) => write!(out, " {}/{uv}", vertex + 1),
                (None, Some(normals)) => write!(out, " {}//{}", vertex + 1, normals.index(corner)),
                (Some(uv), Some(normals)) => write!(out, " {}/{uv}/{}", vertex + 1, normals.index(corner)),
            };
            corner += 1;
        }
        out.push('\n');
    }
    Ok(out.into_bytes())
}

pub(super) fn put_vertex(out: &mut String, surface: &Surface, vertex: usize) {
    let [x, y, z] = surface.positions[vertex].to_array().map(number);
    let _ = write!(out, "v {x} {y} {z}");
}

pub(super) fn put_colour(out: &mut String, tint: [f32; 4]) {
    let [r, g, b, _] = srgb(tint);
    let _ = write!(out, " {r:.6} {g:.6} {b:.6}");
}

/// A name without line breaks.
pub(super) fn one_line(name: &str) -> String {
    name.replace(['\n', '\r'], " ")
}

/// Normals of the corners of polygons, where the input had normals.
pub(super) struct CornerNormals {
    /// `[classes]`
    normals: Vec<glam::Vec3>,
    /// `[corners]`
    class_of: Vec<u32>,
}

impl CornerNormals {
    /// `None` where the input had none.
    pub fn new(surface: &Surface) -> Option<Self> {
        let boundary = surface.boundary;
        let source = &boundary.source;
        if source.corner_normals.is_empty() {
            return None;
        }
        let smoothing = Smoothing::new(boundary);
        let mut class_of = vec![0; source.polygons.corners.len()];
        for (corners, classes) in source.triangle_corners.iter().zip(&smoothing.classes) {
            corners.iter().zip(classes).for_each(|(&corner, &class)| class_of[corner as usize] = class);
        }
        Some(Self { normals: smoothing.normals(&boundary.triangles, surface.positions), class_of })
    }

    /// The `vn` lines.
    pub fn put_table(&self, out: &mut String) {
        for normal in &self.normals {
            let _ = writeln!(out, "vn {:.5} {:.5} {:.5}", normal.x, normal.y, normal.z);
        }
    }

    /// From 1, as OBJ counts.
    pub fn index(&self, corner: usize) -> u32 {
        self.class_of[corner] + 1
    }
}

impl Surface<'_> {
    /// `[vertices]` one normal for each vertex: that of its first corner; +z where no triangle uses it.
    pub(super) fn vertex_normals(&self) -> Vec<glam::Vec3> {
        let smoothing = Smoothing::new(self.boundary);
        let by_class = smoothing.normals(&self.boundary.triangles, self.positions);
        let mut normals = vec![None; self.positions.len()];
        for (triangle, classes) in self.boundary.triangles.iter().zip(&smoothing.classes) {
            for (&vertex, &class) in triangle.iter().zip(classes) {
                let slot = &mut normals[vertex as usize];
                *slot = slot.or(Some(by_class[class as usize]));
            }
        }
        normals.into_iter().map(|normal| normal.unwrap_or(glam::Vec3::Z)).collect()
    }
}
