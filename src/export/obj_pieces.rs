//! The lines of an OBJ again, with more vertices and faces than it had: long triangles are in pieces.
//!
//! All `v` and `vt` lines come before the first face then, those of the file first, so that no face refers to what comes after
//! it; indices count from the start. All other lines stay in their order: groups, materials, smoothing, comments.

use std::borrow::Cow;
use std::fmt::Write as _;
use std::ops::Range;
use std::path::Path;

use super::obj::{CornerNormals, put_colour, put_vertex};
use super::{Surface, library, number};
use crate::boundary::source::NONE;
use crate::boundary::{ObjText, face_corners};
use crate::error::Result;

/// What is written, and what of it was.
struct Lines<'a> {
    surface: &'a Surface<'a>,
    /// Colours that replace those of the file.
    tints: Option<Vec<[f32; 4]>>,
    normals: Option<CornerNormals>,
    /// `[vertices]` what comes after the coordinates.
    extras: Vec<Cow<'a, str>>,
    /// The `vt` lines of the file.
    uvs: Vec<&'a str>,
    out: String,
    /// How many `v` and `vt` lines are written.
    written: [usize; 2],
    /// How many `v`, `vt` and `vn` lines of the file have been passed.
    passed: [usize; 3],
}

/// The file.
pub(super) fn again(surface: &Surface, original: &ObjText, path: &Path) -> Result<Vec<u8>> {
    let file: Vec<Cow<str>> = original.lines().map(|(_, line)| line).collect();
    let pieces_of = surface.boundary.source.added.ranges();
    let mut lines = Lines::new(surface, &file);
    let mut face = 0;
    for line in &file {
        let keyword = keyword(line);
        match keyword {
            "v" => {
                lines.vertices(lines.passed[0] + 1);
                lines.passed[0] += 1;
            }
            "vt" => {
                lines.texture_coordinates(lines.passed[1] + 1);
                lines.passed[1] += 1;
            }
            "vn" => {
                lines.passed[2] += 1;
                if lines.normals.is_none() {
                    lines.keep(line);
                }
            }
            "mtllib" => {
                let rest = line.trim_start()[keyword.len()..].trim();
                let _ = writeln!(lines.out, "mtllib {}", library::bring_along(surface.boundary, rest, path)?);
            }
            "f" | "l" | "p" => {
                lines.all_before_faces();
                if face_corners(line).is_some() {
                    lines.faces(pieces_of.get(face).cloned().unwrap_or_default());
                    face += 1;
                } else {
                    lines.absolute(line);
                }
            }
            _ => lines.keep(line),
        }
    }
    Ok(lines.out.into_bytes())
}

fn keyword(line: &str) -> &str {
    line.split_whitespace().next().unwrap_or("")
}

impl<'a> Lines<'a> {
    fn new(surface: &'a Surface<'a>, file: &'a [Cow<'a, str>]) -> Self {
        let of = |wanted: &'static str| file.iter().map(|line| &**line).filter(move |line| keyword(line) == wanted);
        let words = |line: &'a str| line.split_whitespace().skip(4);
        let mut numbers: Vec<Vec<f64>> =
            of("v").map(|line| words(line).map_while(|word| word.parse().ok()).collect()).collect();
        let mut extras: Vec<Cow<str>> =
            of("v").map(|line| words(line).map(|word| format!(" {word}")).collect::<String>().into()).collect();
        for ends in &surface.boundary.source.added.ends {
            let [a, b] = ends.map(|end| numbers.get(end as usize).map_or(&[][..], Vec::as_slice));
            let mean: Vec<f64> = a.iter().zip(b).map(|(a, b)| 0.5 * (a + b)).collect();
            extras.push(mean.iter().map(|&value| format!(" {}", number(value))).collect::<String>().into());
            numbers.push(mean);
        }
        Self {
            surface,
            tints: surface.colours.is_some().then(|| surface.tints()).flatten(),
            normals: CornerNormals::new(surface),
            extras,
            uvs: of("vt").collect(),
            out: String::new(),
            written: [0; 2],
            passed: [0; 3],
        }
    }

    fn keep(&mut self, line: &str) {
        self.out.push_str(line);
        self.out.push('\n');
    }

    /// Vertices up to one, those that are not written yet.
    fn vertices(&mut self, end: usize) {
        for vertex in self.written[0]..end {
            put_vertex(&mut self.out, self.surface, vertex);
            match &self.tints {
                Some(tints) => put_colour(&mut self.out, tints[vertex]),
                None => self.out.push_str(self.extras.get(vertex).map_or("", |extra| extra)),
            }
            self.out.push('\n');
        }
        self.written[0] = self.written[0].max(end);
    }

    /// Texture coordinates up to one, those that are not written yet.
    fn texture_coordinates(&mut self, end: usize) {
        for index in self.written[1]..end {
            let _ = match (self.uvs.get(index), self.surface.boundary.source.uvs.get(index)) {
                (Some(line), _) => writeln!(self.out, "{line}"),
                (None, Some(uv)) => writeln!(self.out, "vt {} {}", uv.x, 1.0 - uv.y),
                (None, None) => Ok(()),
            };
        }
        self.written[1] = self.written[1].max(end);
    }

    /// What faces refer to.
    fn all_before_faces(&mut self) {
        let is_first = self.written[0] < self.surface.positions.len();
        self.vertices(self.surface.positions.len());
        self.texture_coordinates(self.uvs.len().max(self.surface.boundary.source.uvs.len()));
        if let Some(normals) = self.normals.as_ref().filter(|_| is_first) {
            normals.put_table(&mut self.out);
        }
    }

    /// The faces that one of the file is now.
    fn faces(&mut self, polygons: Range<usize>) {
        let source = &self.surface.boundary.source;
        for polygon in polygons {
            self.out.push('f');
            for corner in source.polygons.range(polygon) {
                let vertex = source.polygons.corners[corner] + 1;
                let uv = source.corner_uvs.get(corner).copied().filter(|&uv| uv != NONE).map(|uv| uv + 1);
                let _ = match (uv, &self.normals) {
                    (None, None) => write!(self.out, " {vertex}"),
                    (Some(uv), None) => write!(self.out, " {vertex}/{uv}"),
                    (None, Some(normals)) => write!(self.out, " {vertex}//{}", normals.index(corner)),
                    (Some(uv), Some(normals)) => write!(self.out, " {vertex}/{uv}/{}", normals.index(corner)),
                };
            }
            self.out.push('\n');
        }
    }

    /// A line of points or edges, whose indices may count backwards from where it stood; without normals where these are new.
    fn absolute(&mut self, line: &str) {
        let mut words = line.split_whitespace();
        self.out.push_str(words.next().unwrap_or(""));
        let kinds = if self.normals.is_some() { 2 } else { 3 };
        for word in words {
            let from_start = |(index, passed): (&str, &usize)| match index.parse::<i64>() {
                Ok(back) if back < 0 => (*passed as i64 + back + 1).to_string(),
                _ => index.to_owned(),
            };
            let indices: Vec<String> = word.split('/').zip(&self.passed).take(kinds).map(from_start).collect();
            let _ = write!(self.out, " {}", indices.join("/").trim_end_matches('/'));
        }
        self.out.push('\n');
    }
}
