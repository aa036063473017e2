//! Wavefront OBJ: polygons, texture coordinates, normals and groups; colours after the coordinates.
//!
//! The text is kept: the export writes it again with other numbers in its `v` lines, so comments, groups, smoothing,
//! `mtllib` and whatever else a line may say survive.
//!
//! Own code, line by line as it is written again. Why not a crate: `tobj` renumbers the vertices of each object in the order its
//! faces use them (`f 4 3 1` makes vertex 4 the first), `obj` keeps the order but passes over the colours in `v 4 -3 0 1 0 0`,
//! and `wavefront_obj` refuses such a line. Of these only `tobj` can read double precision.

use std::borrow::Cow;
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3};

use super::source::{COLOUR_CHANNELS, NONE, Object, Original, Part};
use super::{Attribute, Boundary, Regions, format, mtl};
use crate::error::{Error, Result};

/// The text of an OBJ.
#[derive(Debug, Clone)]
pub(crate) struct ObjText(Arc<str>);

impl ObjText {
    /// Lines with their number, from 1; lines joined by a backslash are one.
    pub fn lines(&self) -> impl Iterator<Item = (usize, Cow<'_, str>)> {
        logical_lines(&self.0)
    }
}

fn logical_lines(text: &str) -> impl Iterator<Item = (usize, Cow<'_, str>)> {
    let mut lines = text.lines().enumerate();
    std::iter::from_fn(move || {
        let (index, line) = lines.next()?;
        let Some(start) = line.strip_suffix('\\') else { return Some((index + 1, Cow::Borrowed(line))) };
        let mut joined = start.to_owned();
        for (_, next) in lines.by_ref() {
            joined.push(' ');
            match next.strip_suffix('\\') {
                Some(part) => joined.push_str(part),
                None => {
                    joined.push_str(next);
                    break;
                }
            }
        }
        Some((index + 1, Cow::Owned(joined)))
    })
}

/// One corner of a face, as in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Corner {
    vertex: i64,
    uv: Option<i64>,
    normal: Option<i64>,
}

/// The corners of an `f` line that has at least three; `None` for any other line.
pub(crate) fn face_corners(line: &str) -> Option<impl Iterator<Item = &str>> {
    let words = || line.split_whitespace().take_while(|word| !word.starts_with('#'));
    (words().next() == Some("f") && words().count() >= 4).then(|| words().skip(1))
}

/// `7`, `7/1`, `7//2`, `7/1/2`, each also negative.
fn corner(word: &str) -> Option<Corner> {
    let mut indices = word.split('/');
    let vertex = indices.next()?.parse().ok()?;
    let mut optional = || match indices.next() {
        None | Some("") => Some(None),
        Some(index) => index.parse().ok().map(Some),
    };
    Some(Corner { vertex, uv: optional()?, normal: optional()? })
}

/// Absolute index from 0, for an index from 1 or, negative, from the end of what was read so far.
fn absolute(index: i64, so_far: usize) -> Option<u32> {
    let zero_based = if index < 0 { index.checked_add(so_far as i64)? } else { index - 1 };
    u32::try_from(zero_based).ok().filter(|&i| i != NONE)
}

/// A face before its indices are checked.
struct Face {
    line: usize,
    corners: std::ops::Range<usize>,
}

#[derive(Default)]
struct Reader {
    boundary: Boundary,
    colours: Vec<[f32; 4]>,
    faces: Vec<Face>,
    vertex_of: Vec<u32>,
    uv_of: Vec<u32>,
    normal_of: Vec<u32>,
    object: u32,
    material: u32,
    part_of: HashMap<(u32, u32), u32>,
    objects: HashMap<String, u32>,
    materials: HashMap<String, u32>,
    libraries: Vec<String>,
    short_faces: usize,
}

/// Reads an OBJ.
pub(crate) fn read(path: &Path, bytes: &[u8]) -> Result<Boundary> {
    let text = ObjText(format::text(bytes).into());
    let mut reader = Reader { object: NONE, material: NONE, ..Reader::default() };
    for (number, line) in text.lines() {
        reader.line(&line).map_err(|sentence| Error::in_file(path, format!("line {number}: {sentence}")))?;
        if let Some(face) = reader.faces.last_mut().filter(|face| face.line == 0) {
            face.line = number;
        }
    }
    reader.finish(path, text)
}

impl Reader {
    fn line(&mut self, line: &str) -> Result<(), String> {
        let mut words = line.split_whitespace();
        let Some(keyword) = words.next() else { return Ok(()) };
        let rest = line.trim_start()[keyword.len()..].trim();
        match keyword {
            "v" => self.vertex(rest)?,
            "vt" => {
                let [u, v] = numbers::<2>(rest, 1)?;
                self.boundary.source.uvs.push(Vec2::new(u as f32, 1.0 - v as f32));
            }
            "vn" => {
                let [x, y, z] = numbers::<3>(rest, 3)?;
                self.boundary.source.normals.push(Vec3::new(x as f32, y as f32, z as f32));
            }
            "f" => match face_corners(line) {
                Some(corners) => self.face(corners)?,
                None => self.short_faces += 1,
            },
            "o" | "g" => self.object = self.named_object(rest),
            "usemtl" => self.material = self.named_material(rest),
            "mtllib" => self.libraries.push(rest.to_owned()),
            _ => {}
        }
        Ok(())
    }

    fn vertex(&mut self, rest: &str) -> Result<(), String> {
        let values: Vec<f64> = rest.split_whitespace().map_while(|word| word.parse().ok()).collect();
        let &[x, y, z, ..] = values.as_slice() else {
            return Err(format!("\"v {rest}\" does not place a vertex; give three numbers"));
        };
        let position = DVec3::new(x, y, z);
        if !position.is_finite() {
            return Err(format!(
                "vertex {} is at \"{rest}\", which is no place; repair or remove it",
                self.boundary.positions.len() + 1
            ));
        }
        if let Some(&[r, g, b]) = values.get(3..6) {
            self.colours.resize(self.boundary.positions.len(), [1.0; 4]);
            self.colours.push([r as f32, g as f32, b as f32, values.get(6).map_or(1.0, |&a| a as f32)]);
        }
        self.boundary.positions.push(position);
        Ok(())
    }

    fn face<'a>(&mut self, corners: impl Iterator<Item = &'a str>) -> Result<(), String> {
        let source = &self.boundary.source;
        let start = self.vertex_of.len();
        for word in corners {
            let corner = corner(word)
                .ok_or_else(|| format!("\"{word}\" is no corner of a face; write it as 1, 1/1, 1//1 or 1/1/1"))?;
            let vertex = absolute(corner.vertex, self.boundary.positions.len()).ok_or_else(|| {
                format!(
                    "a face refers to vertex {}, but vertices count from 1, or from -1 backwards; repair that face",
                    corner.vertex
                )
            })?;
            self.vertex_of.push(vertex);
            self.uv_of.push(corner.uv.and_then(|i| absolute(i, source.uvs.len())).unwrap_or(NONE));
            self.normal_of.push(corner.normal.and_then(|i| absolute(i, source.normals.len())).unwrap_or(NONE));
        }
        self.faces.push(Face { line: 0, corners: start..self.vertex_of.len() });
        let parts = &mut self.boundary.source.parts;
        let part = *self.part_of.entry((self.object, self.material)).or_insert_with(|| {
            parts.push(Part { object: self.object, material: self.material, extensions: None });
            parts.len() as u32 - 1
        });
        self.boundary.source.polygon_parts.push(part);
        Ok(())
    }

    fn named_object(&mut self, name: &str) -> u32 {
        let objects = &mut self.boundary.source.objects;
        *self.objects.entry(name.to_owned()).or_insert_with(|| {
            objects.push(Object { name: name.to_owned(), extras: None });
            objects.len() as u32 - 1
        })
    }

    fn named_material(&mut self, name: &str) -> u32 {
        let next = self.materials.len() as u32;
        *self.materials.entry(name.to_owned()).or_insert(next)
    }

    /// Checks the indices, triangulates, fills attributes, regions and materials.
    fn finish(mut self, path: &Path, text: ObjText) -> Result<Boundary> {
        let count = self.boundary.positions.len();
        let (uvs, normals) = (self.boundary.source.uvs.len(), self.boundary.source.normals.len());
        for face in &self.faces {
            if let Some(vertex) = self.vertex_of[face.corners.clone()].iter().find(|&&v| v as usize >= count) {
                let sentence = format!(
                    "a face refers to vertex {}, but the file has {count}; repair or remove that face",
                    u64::from(*vertex) + 1
                );
                return Err(Error::in_file(path, format!("line {}: {sentence}", face.line)));
            }
        }
        let strays = forget_strays(&mut self.uv_of, uvs) + forget_strays(&mut self.normal_of, normals);
        for face in &self.faces {
            self.boundary.source.polygons.push(&self.vertex_of[face.corners.clone()]);
        }
        let mut boundary = self.boundary;
        let source = &mut boundary.source;
        if self.uv_of.iter().any(|&i| i != NONE) {
            source.corner_uvs = self.uv_of;
        } else {
            source.uvs.clear();
        }
        if self.normal_of.iter().any(|&i| i != NONE) {
            source.corner_normals = self.normal_of;
        } else {
            source.normals.clear();
        }
        if !self.colours.is_empty() {
            self.colours.resize(count, [1.0; 4]);
            boundary.attributes = colour_attributes(&self.colours);
        }
        let mut names: Vec<(String, u32)> = self.materials.into_iter().collect();
        names.sort_by_key(|&(_, index)| index);
        let names: Vec<String> = names.into_iter().map(|(name, _)| name).collect();
        source.materials = mtl::materials(path, &self.libraries, &names, &mut boundary.warnings);
        source.original = Original::Obj(text);
        if self.short_faces > 0 {
            boundary.warnings.push(format!("{} faces with fewer than three corners are left out", self.short_faces));
        }
        if strays > 0 {
            boundary
                .warnings
                .push(format!("{strays} corners refer to texture coordinates or normals that the file does not have"));
        }
        boundary.triangulate_polygons();
        boundary.regions_from_parts();
        Ok(boundary)
    }
}

/// Replaces indices that are out of range; how many there were.
fn forget_strays(indices: &mut [u32], count: usize) -> usize {
    let strays = indices.iter_mut().filter(|i| **i != NONE && **i as usize >= count);
    strays.map(|i| *i = NONE).count()
}

/// `least..=N` numbers at the start of a line, zeros after them.
fn numbers<const N: usize>(rest: &str, least: usize) -> Result<[f64; N], String> {
    let mut values = [0.0; N];
    let mut found = 0;
    for (slot, value) in values.iter_mut().zip(rest.split_whitespace().map_while(|word| word.parse::<f64>().ok())) {
        *slot = value;
        found += 1;
    }
    if found < least {
        Err(format!("\"{rest}\" should start with {least} numbers; repair that line"))
    } else {
        Ok(values)
    }
}

/// Channels `red`, `green`, `blue` and, where it is ever below 1, `alpha`; 0..=255 becomes 0..=1.
pub(crate) fn colour_attributes(colours: &[[f32; 4]]) -> Vec<Attribute> {
    let scale = if colours.iter().any(|c| c.iter().any(|&v| v > 1.0)) { 255.0 } else { 1.0 };
    let scaled = |c: &[f32; 4], i: usize| if i == 3 && c[3] == 1.0 { 1.0 } else { c[i] / scale };
    let with_alpha = colours.iter().any(|c| scaled(c, 3) != 1.0);
    let channel = |i: usize| Attribute {
        name: COLOUR_CHANNELS[1][i].into(),
        values: colours.iter().map(|c| scaled(c, i)).collect(),
    };
    (0..if with_alpha { 4 } else { 3 }).map(channel).collect()
}

impl Boundary {
    /// Fills `triangles` and the corners they came from.
    pub(crate) fn triangulate_polygons(&mut self) {
        let polygons = &self.source.polygons;
        let (mut places, mut local) = (Vec::new(), Vec::new());
        for polygon in 0..polygons.len() {
            let range = polygons.range(polygon);
            places.clear();
            places.extend(polygons.corners[range.clone()].iter().map(|&v| self.positions[v as usize]));
            local.clear();
            super::triangulate::triangulate(&places, &mut local);
            for triangle in &local {
                let corners = triangle.map(|i| i + range.start as u32);
                self.source.triangle_corners.push(corners);
                self.triangles.push(corners.map(|c| polygons.corners[c as usize]));
            }
        }
    }

    /// Regions named for the objects of the parts or, where these have fewer than two names, for their materials; none where
    /// these have fewer than two as well. A vertex belongs to the first that uses it.
    pub(crate) fn regions_from_parts(&mut self) {
        let source = &self.source;
        let by_object = |part: &Part| source.objects.get(part.object as usize).map(|object| object.name.as_str());
        let by_material = |part: &Part| source.materials.materials.get(part.material as usize)?.get("name")?.as_str();
        let (objects, materials): (Vec<_>, Vec<_>) =
            source.parts.iter().map(|p| (by_object(p), by_material(p))).unzip();
        let is_told_apart = |names: &[Option<&str>]| {
            let mut named = names.iter().flatten().filter(|name| !name.is_empty());
            named.next().is_some_and(|first| named.any(|other| other != first))
        };
        let Some(names) = [objects, materials].into_iter().find(|names| is_told_apart(names)) else { return };
        let mut regions = Regions { names: Vec::new(), of_vertex: vec![NONE; self.positions.len()] };
        let mut index_of: HashMap<&str, u32> = HashMap::new();
        for (polygon, &part) in source.polygon_parts.iter().enumerate() {
            let Some(name) = names[part as usize].filter(|name| !name.is_empty()) else { continue };
            let index = *index_of.entry(name).or_insert_with(|| {
                regions.names.push(name.to_owned());
                regions.names.len() as u32 - 1
            });
            for &vertex in &source.polygons.corners[source.polygons.range(polygon)] {
                let slot = &mut regions.of_vertex[vertex as usize];
                *slot = if *slot == NONE { index } else { *slot };
            }
        }
        self.regions = Some(regions);
    }
}
