//! PLY: the input's own tables with other numbers, or a new binary file.

use super::{Surface, byte, ply_pieces, srgb};
use crate::boundary::ply_table::{Element, Encoding, PlyTable, Property, Scalar};
use crate::boundary::source::{COLOUR_CHANNELS, NONE, Original};

/// The mesh as a PLY.
pub(super) fn write(surface: &Surface) -> Vec<u8> {
    match &surface.boundary.source.original {
        Original::Ply(table) => again(surface, table.clone()).write(),
        _ => anew(surface).write(),
    }
}

/// The input's tables with other positions, normals and colours, and attributes that came after reading.
fn again(surface: &Surface, mut table: PlyTable) -> PlyTable {
    let is_far = surface.is_far();
    if !surface.boundary.source.added.faces.is_empty() {
        ply_pieces::in_pieces(&surface.boundary.source, &mut table);
    }
    let Some(vertex) = table.elements.iter_mut().find(|e| e.name == "vertex") else { return anew(surface) };
    for property in &mut vertex.properties {
        let axis = ["x", "y", "z"].iter().position(|&name| name == property.name);
        if let (Some(axis), None) = (axis, property.length) {
            property.values = surface.positions.iter().map(|p| p[axis]).collect();
            // Coordinates in whole numbers cannot hold a warped place, those in single precision none far from the origin.
            let is_single = || property.values.iter().all(|&value| f64::from(value as f32) == value);
            let is_too_coarse = property.scalar.largest().is_some() || is_far && !is_single();
            property.scalar = if is_too_coarse { Scalar::F64 } else { property.scalar };
        }
    }
    if ["nx", "ny", "nz"].iter().all(|name| vertex.property(name).is_some()) {
        for (axis, values) in normals(surface).into_iter().enumerate() {
            replace(vertex, Property::column(["nx", "ny", "nz"][axis], Scalar::F32, values));
        }
    }
    if surface.colours.is_some() {
        colours(surface).into_iter().for_each(|column| replace(vertex, column));
    }
    for attribute in &surface.boundary.attributes {
        if vertex.property(&attribute.name).is_none() {
            vertex.properties.push(attribute_column(attribute.name.clone(), &attribute.values));
        }
    }
    table
}

/// Puts a column in the place of the one with its name, or last.
fn replace(element: &mut Element, column: Property) {
    match element.properties.iter_mut().find(|p| p.name == column.name) {
        Some(property) => *property = column,
        None => element.properties.push(column),
    }
}

fn anew(surface: &Surface) -> PlyTable {
    let boundary = surface.boundary;
    let is_single = surface.positions.iter().all(|p| p.as_vec3().as_dvec3() == *p);
    let scalar = if is_single { Scalar::F32 } else { Scalar::F64 };
    let axis = |(name, axis): (&str, usize)| {
        Property::column(name, scalar, surface.positions.iter().map(|p| p[axis]).collect())
    };
    let mut properties: Vec<Property> = [("x", 0), ("y", 1), ("z", 2)].map(axis).into();
    if !boundary.source.corner_normals.is_empty() {
        let columns = ["nx", "ny", "nz"].into_iter().zip(normals(surface));
        properties.extend(columns.map(|(name, values)| Property::column(name, Scalar::F32, values)));
    }
    properties.extend(colours(surface));
    let (by_vertex, by_corner) = texture_coordinates(surface);
    properties.extend(by_vertex);
    let is_colour = |name: &str| COLOUR_CHANNELS.iter().flatten().any(|&channel| channel == name);
    for attribute in boundary.attributes.iter().filter(|a| !is_colour(&a.name)) {
        let name = attribute.name.replace(char::is_whitespace, "_");
        properties.push(attribute_column(name, &attribute.values));
    }
    let vertex = Element { name: "vertex".into(), count: surface.positions.len(), properties };
    let polygons: Vec<&[u32]> = surface.polygons().collect();
    let length = if polygons.iter().any(|p| p.len() > 127) { Scalar::U32 } else { Scalar::U8 };
    let mut indices = Property {
        name: "vertex_indices".into(),
        scalar: Scalar::I32,
        length: Some(length),
        values: Vec::new(),
        starts: vec![0],
    };
    for polygon in &polygons {
        indices.values.extend(polygon.iter().map(|&v| f64::from(v)));
        indices.starts.push(indices.values.len());
    }
    let properties = std::iter::once(indices).chain(by_corner.map(|values| texcoord(values, &polygons))).collect();
    let face = Element { name: "face".into(), count: polygons.len(), properties };
    PlyTable { encoding: Encoding::Little, comments: vec!["comment homunculus".into()], elements: vec![vertex, face] }
}

fn attribute_column(name: String, values: &[f32]) -> Property {
    Property::column(&name, Scalar::F32, values.iter().map(|&v| f64::from(v)).collect())
}

/// x, y and z of the normals of all vertices.
fn normals(surface: &Surface) -> [Vec<f64>; 3] {
    let normals = surface.vertex_normals();
    [0, 1, 2].map(|axis| normals.iter().map(|n| f64::from(n[axis])).collect())
}

/// `red`, `green`, `blue`, `alpha` in bytes; none where there is no colour.
fn colours(surface: &Surface) -> Vec<Property> {
    let Some(tints) = surface.tints() else { return Vec::new() };
    let channels = if tints.iter().all(|tint| tint[3] == 1.0) { 3 } else { 4 };
    let column = |i: usize| tints.iter().map(|&tint| f64::from(byte(srgb(tint)[i]))).collect();
    (0..channels).map(|i| Property::column(COLOUR_CHANNELS[1][i], Scalar::U8, column(i))).collect()
}

/// Texture coordinates as vertex properties where each vertex has one only, else for each corner of the faces.
fn texture_coordinates(surface: &Surface) -> (Vec<Property>, Option<Vec<f64>>) {
    let source = &surface.boundary.source;
    if source.corner_uvs.is_empty() {
        return (Vec::new(), None);
    }
    let pair = |uv: u32| source.uvs.get(uv as usize).map_or([0.0; 2], |uv| [f64::from(uv.x), f64::from(1.0 - uv.y)]);
    let mut of_vertex = vec![NONE; surface.positions.len()];
    let mut is_single = true;
    for (&vertex, &uv) in source.polygons.corners.iter().zip(&source.corner_uvs) {
        let slot = &mut of_vertex[vertex as usize];
        is_single &= *slot == NONE || pair(*slot) == pair(uv);
        *slot = uv;
    }
    if !is_single {
        return (Vec::new(), Some(source.corner_uvs.iter().flat_map(|&uv| pair(uv)).collect()));
    }
    let column = |i: usize| of_vertex.iter().map(|&uv| pair(uv)[i]).collect();
    (vec![Property::column("s", Scalar::F32, column(0)), Property::column("t", Scalar::F32, column(1))], None)
}

fn texcoord(values: Vec<f64>, polygons: &[&[u32]]) -> Property {
    let mut starts = vec![0];
    let mut end = 0;
    for polygon in polygons {
        end += 2 * polygon.len();
        starts.push(end);
    }
    let length = if polygons.iter().any(|p| p.len() > 127) { Scalar::U32 } else { Scalar::U8 };
    Property { name: "texcoord".into(), scalar: Scalar::F32, length: Some(length), values, starts }
}
