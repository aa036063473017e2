//! The tables of a PLY with more vertices and faces than it had: long triangles are in pieces.

use std::ops::Range;

use crate::boundary::ply_table::{Element, PlyTable, Property, Scalar};
use crate::boundary::source::{Added, Polygons, Source};
use crate::boundary::{LIST_NAMES, colour_scale};

/// Adds rows of vertices, and gives the faces of the file the rows of their pieces. Strips become faces.
pub(super) fn in_pieces(source: &Source, table: &mut PlyTable) {
    let (added, polygons) = (&source.added, &source.polygons);
    let ranges = added.ranges();
    let mut own = 0;
    if let Some(vertex) = table.elements.iter_mut().find(|e| e.name == "vertex") {
        own = vertex.count;
        more_vertices(vertex, &added.ends);
    }
    let mut next = 0;
    if let Some(face) = table.elements.iter_mut().find(|e| e.name == "face") {
        next = faces(face, &ranges, &Pieces { polygons, added, own });
    }
    let strips: Vec<usize> = ranges.get(next..).unwrap_or_default().iter().flat_map(Range::clone).collect();
    if !strips.is_empty() {
        table.elements.retain(|element| element.name != "tristrips");
        if !table.elements.iter().any(|e| e.name == "face") {
            let list = Property { length: Some(Scalar::U8), starts: vec![0], ..index_list() };
            table.elements.push(Element { name: "face".into(), count: 0, properties: vec![list] });
        }
        if let Some(face) = table.elements.iter_mut().find(|e| e.name == "face") {
            strips.iter().for_each(|&polygon| triangle(face, &polygons.corners[polygons.range(polygon)]));
        }
    }
    // Few vertices may have had short numbers.
    let count = (own + added.ends.len()) as f64;
    for element in &mut table.elements {
        let lists =
            element.properties.iter_mut().filter(|p| p.length.is_some() && LIST_NAMES.contains(&p.name.as_str()));
        for list in lists.filter(|list| list.scalar.largest().is_some_and(|largest| largest < count)) {
            list.scalar = Scalar::U32;
        }
    }
}

fn index_list() -> Property {
    Property::column(LIST_NAMES[0], Scalar::I32, Vec::new())
}

fn more_vertices(vertex: &mut Element, ends: &[[u32; 2]]) {
    vertex.count += ends.len();
    for property in &mut vertex.properties {
        let is_whole = property.scalar.largest().is_some();
        let is_label = is_whole && colour_scale(property) == 1.0;
        for &[a, b] in ends {
            if property.length.is_some() {
                let list = property.list(a as usize).to_vec();
                property.values.extend(list);
                property.starts.push(property.values.len());
                continue;
            }
            let [a, b] = [a, b].map(|end| property.values.get(end as usize).copied().unwrap_or(0.0));
            property.values.push(match (is_label, is_whole) {
                (true, _) => a,
                (false, true) => (0.5 * (a + b)).round(),
                (false, false) => 0.5 * a + 0.5 * b,
            });
        }
    }
}

/// What the faces of the file became.
struct Pieces<'a> {
    polygons: &'a Polygons,
    added: &'a Added,
    /// Vertices of the file.
    own: usize,
}

impl Pieces<'_> {
    /// Adds a value that corners of a face have, weighted, at a vertex in it: `visit` is given corners of the file and weights.
    fn blend(&self, vertex: u32, weight: f64, visit: &mut impl FnMut(u32, f64)) {
        match (vertex as usize).checked_sub(self.own).and_then(|v| self.added.ends.get(v)) {
            Some(ends) => ends.iter().for_each(|&end| self.blend(end, 0.5 * weight, visit)),
            None => visit(vertex, weight),
        }
    }

    /// `width` numbers for each corner of a face, of one of its pieces.
    fn of_corners(&self, piece: &[u32], face: &[f64], values: &[f64], width: usize) -> Vec<f64> {
        let mut blended = vec![0.0; width * piece.len()];
        for (&vertex, blended) in piece.iter().zip(blended.chunks_exact_mut(width)) {
            self.blend(vertex, 1.0, &mut |end, weight| {
                let corner = face.iter().position(|&v| v == f64::from(end)).unwrap_or(0);
                let values = values.get(width * corner..).unwrap_or_default();
                blended.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
            });
        }
        blended
    }
}

/// Rewrites the rows of an element of faces; how many faces of the file it has, which are those with three corners at least.
fn faces(element: &mut Element, ranges: &[Range<usize>], pieces: &Pieces) -> usize {
    let name = LIST_NAMES.iter().find(|&&name| element.property(name).is_some()).copied();
    let Some(lists) = name.and_then(|name| element.property(name)).cloned() else { return 0 };
    // The rows after it: pieces of a row, or the row as it was.
    let mut face = 0;
    let mut rows: Vec<(usize, Option<usize>)> = Vec::new();
    for row in 0..element.count {
        let range = if lists.list(row).len() < 3 { None } else { ranges.get(face).cloned() };
        face += usize::from(lists.list(row).len() >= 3);
        match range.filter(|range| range.len() > 1) {
            Some(range) => rows.extend(range.map(|polygon| (row, Some(polygon)))),
            None => rows.push((row, None)),
        }
    }
    for property in &mut element.properties {
        let old = std::mem::replace(property, Property { values: Vec::new(), starts: Vec::new(), ..property.clone() });
        if old.length.is_none() {
            property.values = rows.iter().filter_map(|&(row, _)| old.values.get(row).copied()).collect();
            continue;
        }
        property.starts.push(0);
        for &(row, polygon) in &rows {
            let (own, corners) = (old.list(row), lists.list(row));
            let width = own.len() / corners.len().max(1);
            let is_of_corners = old.scalar.largest().is_none() && width > 0 && own.len() == width * corners.len();
            match polygon.map(|polygon| &pieces.polygons.corners[pieces.polygons.range(polygon)]) {
                Some(piece) if old.name == lists.name => property.values.extend(piece.iter().map(|&v| f64::from(v))),
                Some(piece) if is_of_corners => {
                    property.values.extend(pieces.of_corners(piece, corners, own, width));
                }
                _ => property.values.extend_from_slice(own),
            }
            property.starts.push(property.values.len());
        }
    }
    element.count = rows.len();
    face
}

/// Appends a face that has nothing but its corners.
fn triangle(element: &mut Element, corners: &[u32]) {
    for property in &mut element.properties {
        match property.length {
            Some(_) => {
                if LIST_NAMES.contains(&property.name.as_str()) {
                    property.values.extend(corners.iter().map(|&v| f64::from(v)));
                }
                property.starts.push(property.values.len());
            }
            None => property.values.push(0.0),
        }
    }
    element.count += 1;
}
