//! What a file says beyond places, carried over to the pieces.

use super::rounds::{Corner, Work};
use crate::boundary::source::{Added, NONE, Original, Polygons, Source};
use crate::boundary::{Attribute, Boundary, Regions, colour_scale};

impl Boundary {
    /// The same surface in pieces.
    pub(super) fn with_pieces(&self, work: Work) -> Self {
        let attribute = |attribute: &Attribute| Attribute {
            name: attribute.name.clone(),
            values: if self.is_label(&attribute.name) {
                carried(&attribute.values, &work.ends, |&first, _| first)
            } else {
                carried(&attribute.values, &work.ends, |&a, &b| a * 0.5 + b * 0.5)
            },
        };
        let regions = |regions: &Regions| Regions {
            names: regions.names.clone(),
            of_vertex: carried(&regions.of_vertex, &work.ends, |&first, _| first),
        };
        Self {
            name: self.name.clone(),
            triangles: work.pieces.iter().map(|piece| piece.corners.map(|corner| corner.vertex)).collect(),
            attributes: self.attributes.iter().map(attribute).collect(),
            regions: self.regions.as_ref().map(regions),
            warnings: self.warnings.clone(),
            source: self.source.with_pieces(&work),
            positions: work.positions,
        }
    }

    /// Whether values are names of something and not quantities: whole numbers of a PLY that are no colours.
    fn is_label(&self, name: &str) -> bool {
        let Original::Ply(table) = &self.source.original else { return false };
        let property = table.element("vertex").and_then(|vertex| vertex.property(name));
        property.is_some_and(|property| property.scalar.largest().is_some() && colour_scale(property) == 1.0)
    }
}

/// Values with those of added vertices after them.
fn carried<T: Clone>(values: &[T], ends: &[[u32; 2]], middle: impl Fn(&T, &T) -> T) -> Vec<T> {
    let mut carried = Vec::with_capacity(values.len() + ends.len());
    carried.extend_from_slice(values);
    for &[a, b] in ends {
        let value = middle(&carried[a as usize], &carried[b as usize]);
        carried.push(value);
    }
    carried
}

impl Source {
    fn with_pieces(&self, work: &Work) -> Self {
        let mut source = Self {
            polygons: Polygons::default(),
            triangle_corners: Vec::new(),
            corner_uvs: Vec::new(),
            corner_normals: Vec::new(),
            polygon_parts: Vec::new(),
            uvs: work.uvs.clone(),
            normals: work.normals.clone(),
            added: Added { ends: self.added.ends.clone(), faces: Vec::new() },
            ..self.clone()
        };
        source.added.ends.extend(&work.ends);
        let face = |index: u32| self.added.faces.get(index as usize).copied().unwrap_or(index);
        if self.triangle_corners.is_empty() {
            source.added.faces = work.pieces.iter().map(|piece| face(piece.parent)).collect();
            return source;
        }
        let polygon_of = self.polygons_of_triangles();
        let mut is_cut = vec![false; self.polygons.len()];
        for pair in work.pieces.windows(2).filter(|pair| pair[0].parent == pair[1].parent) {
            is_cut[polygon_of[pair[0].parent as usize] as usize] = true;
        }
        // Where the corners of a polygon that stays whole have gone.
        let mut moved_to = vec![NONE; self.polygons.len()];
        for piece in &work.pieces {
            let polygon = polygon_of[piece.parent as usize] as usize;
            let start = self.polygons.range(polygon).start as u32;
            if is_cut[polygon] {
                let first = source.put(piece.corners.iter().copied(), self, polygon);
                source.triangle_corners.push([first, first + 1, first + 2]);
                source.added.faces.push(face(polygon as u32));
                continue;
            }
            if moved_to[polygon] == NONE {
                moved_to[polygon] = source.put(self.corners_of(polygon), self, polygon);
                source.added.faces.push(face(polygon as u32));
            }
            let first = moved_to[polygon];
            source.triangle_corners.push(self.triangle_corners[piece.parent as usize].map(|c| c - start + first));
        }
        source
    }

    /// Appends a polygon with the material of an old one; where its corners begin.
    fn put(&mut self, corners: impl Iterator<Item = Corner>, old: &Self, polygon: usize) -> u32 {
        let first = self.polygons.corners.len() as u32;
        let corners: Vec<Corner> = corners.collect();
        self.polygons.push(&corners.iter().map(|corner| corner.vertex).collect::<Vec<_>>());
        if !old.corner_uvs.is_empty() {
            self.corner_uvs.extend(corners.iter().map(|corner| corner.uv));
        }
        if !old.corner_normals.is_empty() {
            self.corner_normals.extend(corners.iter().map(|corner| corner.normal));
        }
        self.polygon_parts.extend(old.polygon_parts.get(polygon));
        first
    }

    fn corners_of(&self, polygon: usize) -> impl Iterator<Item = Corner> {
        self.polygons.range(polygon).map(|corner| Corner {
            vertex: self.polygons.corners[corner],
            uv: self.corner_uvs.get(corner).copied().unwrap_or(NONE),
            normal: self.corner_normals.get(corner).copied().unwrap_or(NONE),
            weights: [0.0; 3],
        })
    }

    /// `[triangles]` the polygon each came from.
    pub fn polygons_of_triangles(&self) -> Vec<u32> {
        let of_corner = (0..self.polygons.len()).flat_map(|p| self.polygons.range(p).map(move |_| p as u32));
        let of_corner: Vec<u32> = of_corner.collect();
        self.triangle_corners.iter().map(|corners| of_corner[corners[0] as usize]).collect()
    }
}
