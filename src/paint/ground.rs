//! What is painted on in a picture: a mesh fine enough for any brush, and the way from its vertices to the pixels.
//!
//! # Theory
//! Strokes belong to a picture, not to the resolution it is solved with, so they are kept at the vertices of a mesh of their
//! own. What the hand adds to ln f there is read between them linearly along both axes, and multiplies what the layers say of
//! each pixel: pixels keep all their detail, as vertices do on bodies. The engine, the report and the command line are
//! given pixels, painted or not.

use std::sync::{Arc, OnceLock};

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::boundary::{Boundary, Regions};
use crate::importance::{Field, Stack};
use crate::picture::Picture;
use crate::transfer::flat_boundary;
use crate::voxel::{Complex, Flat, Grid};
use crate::{Error, Result};

/// Cells along the longest side of the mesh that is painted on; its vertices are half a cell apart. A brush is at least ten
/// times as wide, and the finest lattice has cells of that size.
const CELLS: u32 = 256;

/// A picture that is painted on.
#[derive(Debug, Clone)]
pub struct Ground {
    /// Its pixels and its body.
    pub picture: Arc<Picture>,
    /// Importance that a built-in picture brings, where no layer says otherwise.
    pub own: Option<Arc<Field>>,
    /// What the layers say of each pixel.
    pub field: Arc<Field>,
    /// Picture and field as the engine takes them.
    pub flat: Arc<Flat>,
    /// The mesh that strokes are kept on, with the regions of the field.
    pub mesh: Arc<Boundary>,
    vertices: Arc<Vertices>,
    /// Made when it is first drawn.
    texture: Arc<OnceLock<Vec<u8>>>,
}

/// Where the mesh's vertices are.
#[derive(Debug)]
struct Vertices {
    /// Of the mesh's cells.
    grid: Grid,
    columns: usize,
    rows: usize,
    /// `[rows × columns]` vertex of the halved lattice, the nearest one where none is.
    at: Vec<u32>,
}

/// A picture with what was painted on it.
#[derive(Debug, Clone)]
pub struct PaintedPicture {
    /// What is under the paint.
    pub ground: Ground,
    /// `[vertices]` of the ground's mesh: what the hand added to ln f. Empty for nothing.
    pub differences: Vec<f64>,
}

impl Ground {
    /// Prepares a picture with what its layers say.
    ///
    /// # Errors
    /// A picture without a body.
    pub fn new(name: &str, picture: Picture, own: Option<Arc<Field>>, field: Field) -> Result<Self> {
        let size = picture.size;
        let bare = Flat { name: name.into(), size, inside: picture.domain.clone(), ..Flat::default() };
        let complex = bare.lattice(CELLS.min(size.max_element()))?;
        let mesh = Arc::new(flat_boundary(name, &complex, size));
        let vertices = Arc::new(Vertices::of(&complex, &mesh)?);
        let nothing = Field { values: Vec::new(), regions: None, ..field.clone() };
        let (picture, flat) = (Arc::new(picture), Arc::new(bare));
        let ground = Self { picture, own, field: Arc::new(nothing), flat, mesh, vertices, texture: Arc::default() };
        Ok(ground.with_field(field))
    }

    /// What is drawn of the picture, PNG.
    ///
    /// # Errors
    /// A fault where its pixels cannot be encoded.
    pub fn texture(&self) -> Result<&[u8]> {
        if let Some(made) = self.texture.get() {
            return Ok(made);
        }
        let png = self.picture.body_png()?;
        Ok(self.texture.get_or_init(|| png))
    }

    /// The same picture with other layers.
    #[must_use]
    pub fn with_field(&self, field: Field) -> Self {
        let regions = field.regions.as_ref().map(|r| Regions { names: r.names.clone(), of_vertex: r.of_pixel.clone() });
        let at_vertices = regions.as_ref().map(|regions| {
            let of_vertex = self.mesh.positions.iter().map(|&p| regions.of_vertex[self.pixel(p)]).collect();
            Regions { names: regions.names.clone(), of_vertex }
        });
        let same = |a: &Regions, b: &Regions| a.names == b.names && a.of_vertex == b.of_vertex;
        let is_same = match (&self.mesh.regions, &at_vertices) {
            (Some(a), Some(b)) => same(a, b),
            (None, None) => true,
            _ => false,
        };
        // The same mesh stays the same `Arc`, by which others know that nothing else changed.
        let mesh = if is_same {
            self.mesh.clone()
        } else {
            Arc::new(Boundary { regions: at_vertices, ..(*self.mesh).clone() })
        };
        let flat = Flat { importance: field.values.clone(), regions, ..(*self.flat).clone() };
        Self { field: Arc::new(field), flat: Arc::new(flat), mesh, ..self.clone() }
    }

    /// What the layers say at the mesh's vertices, to be painted over.
    pub fn stack(&self) -> Stack {
        let spacing = 0.25 * self.vertices.grid.cell_size;
        let height = f64::from(self.picture.size.y);
        let near = |p: &DVec3| {
            let p = DVec2::new(p.x, height - p.y);
            // Cells stand out beyond the body: there what is nearest counts.
            let reach = (0..8).map(|k| spacing * f64::from(1 << k));
            reach.map(|r| self.field.over(&self.picture.domain, p - r, p + r)).find_map(|value| value).unwrap_or(1.0)
        };
        let values: Vec<f32> = self.mesh.positions.par_iter().with_min_len(1024).map(near).collect();
        Stack::of_vertices(&values, self.field.warnings.clone(), self.field.clamped)
    }

    /// `[vertices]` of another mesh of this picture: values of this mesh's vertices, read between them.
    pub fn carried(&self, values: &[f64], to: &Boundary) -> Vec<f64> {
        to.positions.par_iter().with_min_len(1024).map(|p| self.vertices.read(values, p.truncate())).collect()
    }

    /// The vertex nearest to a place, source units.
    pub fn vertex_at(&self, place: DVec3) -> u32 {
        self.vertices.nearest(place.truncate())
    }

    /// The pixel at a place, the nearest one beyond the picture.
    fn pixel(&self, place: DVec3) -> usize {
        let size = self.picture.size;
        let at = |v: f64, most: u32| (v.max(0.0) as u32).min(most - 1) as usize;
        at(f64::from(size.y) - place.y, size.y) * size.x as usize + at(place.x, size.x)
    }
}

impl PaintedPicture {
    /// Picture and importance as the engine takes them.
    pub fn flat(&self) -> Arc<Flat> {
        let flat = &self.ground.flat;
        if self.differences.is_empty() {
            return flat.clone();
        }
        let (width, height) = (flat.size.x as usize, flat.size.y as usize);
        let mut importance = flat.importance.clone();
        importance.par_chunks_mut(width).zip(flat.inside.par_chunks(width)).enumerate().for_each(
            |(row, (line, seen))| {
                let y = (height - row) as f64 - 0.5;
                for (column, (f, _)) in line.iter_mut().zip(seen).enumerate().filter(|(_, (_, seen))| **seen) {
                    let added = self.ground.vertices.read(&self.differences, DVec2::new(column as f64 + 0.5, y));
                    if added != 0.0 {
                        *f *= added.exp() as f32;
                    }
                }
            },
        );
        let Flat { name, size, inside, regions, .. } = &**flat;
        let (name, inside, regions) = (name.clone(), inside.clone(), regions.clone());
        Arc::new(Flat { name, size: *size, inside, importance, regions })
    }

    /// The same as importance of pixels.
    pub fn field(&self) -> Field {
        let field = (*self.ground.field).clone();
        if self.differences.is_empty() { field } else { Field { values: self.flat().importance.clone(), ..field } }
    }
}

impl Vertices {
    fn of(complex: &Complex, mesh: &Boundary) -> Result<Self> {
        let grid = complex.grid;
        let [columns, rows] = [grid.cells.x, grid.cells.y].map(|cells| 2 * cells as usize + 1);
        let mut at = vec![u32::MAX; columns * rows];
        let mut front = Vec::with_capacity(mesh.positions.len());
        for (vertex, &p) in (0..).zip(&mesh.positions) {
            let place = (2.0 * grid.lattice_from_source(p)).round().as_usizevec3();
            at[place.y * columns + place.x] = vertex;
            front.push(place.y * columns + place.x);
        }
        if front.is_empty() {
            return Err(Error::Fault("a picture's mesh has no vertices".into()));
        }
        // From place to place, until all know the nearest vertex.
        while !front.is_empty() {
            let mut next = Vec::new();
            for &place in &front {
                let (x, y) = (place % columns, place / columns);
                let around = [
                    (x > 0, place.wrapping_sub(1)),
                    (x + 1 < columns, place + 1),
                    (y > 0, place.wrapping_sub(columns)),
                    (y + 1 < rows, place + columns),
                ];
                for (_, other) in around.into_iter().filter(|(is_there, _)| *is_there) {
                    if at[other] == u32::MAX {
                        at[other] = at[place];
                        next.push(other);
                    }
                }
            }
            front = next;
        }
        Ok(Self { grid, columns, rows, at })
    }

    /// Where a place is among the vertices.
    fn place(&self, p: DVec2) -> DVec2 {
        let last = DVec2::new((self.columns - 1) as f64, (self.rows - 1) as f64);
        ((p - self.grid.origin.truncate()) * (2.0 / self.grid.cell_size)).clamp(DVec2::ZERO, last)
    }

    fn nearest(&self, p: DVec2) -> u32 {
        let place = self.place(p).round().as_usizevec2();
        self.at[place.y * self.columns + place.x]
    }

    /// Values of the vertices around a place, linear along both axes.
    fn read(&self, values: &[f64], p: DVec2) -> f64 {
        let place = self.place(p);
        let low = place.floor();
        let t = place - low;
        let (x, y) = (low.x as usize, low.y as usize);
        let (right, up) = ((x + 1).min(self.columns - 1), (y + 1).min(self.rows - 1));
        let at = |x: usize, y: usize| values[self.at[y * self.columns + x] as usize];
        let (below, above) = ((at(x, y), at(right, y)), (at(x, up), at(right, up)));
        let along = |(a, b): (f64, f64)| a + t.x * (b - a);
        along(below) + t.y * (along(above) - along(below))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::importance::Layer;
    use crate::picture::{Cut, read_bytes};
    use std::path::Path;

    /// A picture of 60 × 40 pixels whose middle third is missing.
    fn ground(layers: &[Layer]) -> Ground {
        let mut png = Vec::new();
        let pixels =
            image::RgbaImage::from_fn(60, 40, |x, _| image::Rgba([90, 90, 90, if x / 20 == 1 { 0 } else { 255 }]));
        pixels.write_to(&mut std::io::Cursor::new(&mut png), image::ImageFormat::Png).expect("a PNG");
        let picture = read_bytes("test.png", &png, &Cut::default()).expect("a picture");
        let field = Field::load(layers, 1.0, false, &picture, Path::new("")).expect("a field");
        Ground::new("test.png", picture, None, field).expect("a ground")
    }

    #[test]
    fn paint_multiplies_what_layers_say_and_leaves_the_rest_to_the_bit() {
        let ground = ground(&[Layer::Sphere { centre: [10.0, 20.0, 0.0], radius: 8.0, value: 3.0 }]);
        let nothing = PaintedPicture { ground: ground.clone(), differences: Vec::new() };
        assert_eq!(nothing.flat().importance, ground.field.values);
        // Twice as much to the right of the gap.
        let added = |p: &DVec3| if p.x > 30.0 { 2.0_f64.ln() } else { 0.0 };
        let differences: Vec<f64> = ground.mesh.positions.iter().map(added).collect();
        let painted = PaintedPicture { ground: ground.clone(), differences }.flat();
        for (k, (f, under)) in painted.importance.iter().zip(&ground.field.values).enumerate() {
            let column = k % 60;
            match column / 20 {
                0 | 1 => assert_eq!(f, under, "{k}"),
                _ => assert!((f - 2.0 * under).abs() < 1e-5, "{k}: {f} {under}"),
            }
        }
    }

    #[test]
    fn vertices_know_what_is_under_them_and_values_are_read_between_them() {
        let ground = ground(&[Layer::Sphere { centre: [10.0, 20.0, 0.0], radius: 15.0, value: 3.0 }]);
        let values = ground.stack().at_vertices(&ground.mesh);
        let middle = ground.vertex_at(DVec3::new(10.0, 20.0, 0.0)) as usize;
        assert!((values[middle] - 3.0).abs() < 0.1, "{}", values[middle]);
        assert!(values.iter().all(|f| (0.99..=3.01).contains(f)));
        // A linear function is read exactly, at the vertices of a coarser mesh too.
        let linear: Vec<f64> = ground.mesh.positions.iter().map(|p| 0.1 * p.x - 0.2 * p.y).collect();
        let coarse = ground.flat.lattice(6).expect("a lattice");
        let coarse = flat_boundary("coarse", &coarse, ground.picture.size);
        for (p, value) in coarse.positions.iter().zip(ground.carried(&linear, &coarse)) {
            let is_on_body = !(20.0..=40.0).contains(&p.x) && (0.0..=40.0).contains(&p.y);
            assert!(!is_on_body || (value - (0.1 * p.x - 0.2 * p.y)).abs() < 1e-9, "{p}: {value}");
            assert!(value.is_finite());
        }
    }

    #[test]
    fn other_layers_keep_the_mesh_where_regions_stay() {
        let before = ground(&[]);
        let field = Field { values: vec![2.0; 2400], ..(*before.field).clone() };
        let after = before.with_field(field);
        assert!(Arc::ptr_eq(&before.mesh, &after.mesh));
        assert_eq!(after.flat.importance, vec![2.0; 2400]);
    }
}
