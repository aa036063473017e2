//! 3.2  **F**, the importance: the linear size factor asked for, > 0, 1 = keep.
//!
//! # Theory
//! The paper paints importance with a brush or reads it from a data set, on the boundary. Here it is a [`Stack`] of
//! [`Layer`]s over a base value, and a function of the boundary's surface: what a user can say in one way can be
//! corrected in another by a layer above. Everything blends in ln f, as "twice" and "half" are equally far from "keep".
//!
//! # Changes from the paper
//! The paper's importance is a value per boundary vertex. Meshes with large triangles have few vertices and the lattice
//! many cells, so spheres and pictures are evaluated at any [`Sample`] of the surface, and only what is known
//! per vertex is interpolated.
//!
//! # Practice
//! [`Stack::load`] reads and checks every file once; [`Stack::evaluate`] is a pure function of each sample, so its
//! result is the same for any number of threads.

mod admission;
mod areas;
mod colour;
pub mod field;
mod layer;
mod picture;
pub mod plugin;
mod sphere;
mod spread;
mod table;

use std::path::Path;

use glam::{DVec3, Vec2};
use rayon::prelude::*;

use crate::boundary::{Boundary, Regions};
use crate::{Error, Result};
use admission::Admission;
use picture::Picture;
use sphere::Sphere;

pub use areas::{RegionArea, areas, median_error, worst};
pub use colour::colours;
pub use layer::{CLAMP_MAX, CLAMP_MIN, IMAGE_RANGE, Layer, Range};
pub use sphere::falloff;
pub use spread::{Sampling, Spread, asked_sizes, cell_importance, node_importance, smoothed};

/// A point on the boundary's surface where importance is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Index into [`Boundary::triangles`](crate::boundary::Boundary::triangles).
    pub triangle: u32,
    /// Barycentric weights of the triangle's three corners, each in 0..=1, summing to 1.
    pub weights: [f32; 3],
}

/// Layers of importance over a base value, read and checked for one boundary.
#[derive(Debug, Clone, Default)]
pub struct Stack {
    /// ln of the importance below all layers.
    ln_base: f64,
    layers: Vec<Ready>,
    regions: Option<Regions>,
    admission: Admission,
    warnings: Vec<String>,
}

/// A layer with everything it needs in memory.
#[derive(Debug, Clone)]
enum Ready {
    Sphere(Sphere),
    /// `[vertices]` ln f, `None` where what is below stays.
    Vertices(Vec<Option<f64>>),
    /// `[vertices]` what is added to ln f by hand.
    Painted(Vec<f64>),
    Picture {
        picture: Picture,
        /// `[triangles]`
        corner_uvs: Vec<Option<[Vec2; 3]>>,
        range: (f64, f64),
    },
}

/// Where importance is asked for, resolved.
struct Place {
    position: DVec3,
    /// Vertices around and their weights.
    corners: [(usize, f64); 3],
    /// The triangle, for texture coordinates; `None` for a vertex of no triangle.
    triangle: Option<usize>,
}

impl Stack {
    /// Reads and checks all that the layers need. Relative paths are taken from `scene_dir`.
    ///
    /// # Errors
    /// Names the file, the row or vertex, the value and what to do about it: values that are ≤ 0 or not finite (unless
    /// `clamp`), tables with unknown or repeated vertices or regions, attributes or textures the boundary does not have.
    pub fn load(layers: &[Layer], base: f32, clamp: bool, boundary: &Boundary, scene_dir: &Path) -> Result<Self> {
        let mut admission = Admission { clamp, ..Admission::default() };
        let base = admission.admit(base, &base.to_string(), || "base".into())?.unwrap_or(1.0);
        let mut stack = Self {
            ln_base: f64::from(base).ln(),
            layers: Vec::with_capacity(layers.len()),
            regions: None,
            admission,
            warnings: Vec::new(),
        };
        for layer in layers {
            let ready = stack.prepare(layer, boundary, scene_dir)?;
            stack.layers.push(ready);
        }
        stack.warnings.extend(stack.admission.warnings());
        Ok(stack)
    }

    /// The same importance everywhere.
    ///
    /// # Errors
    /// If `base` is not > 0 and finite.
    pub fn uniform(base: f32) -> Result<Self> {
        Self::load(&[], base, false, &Boundary::default(), Path::new(""))
    }

    /// What is known at `[vertices]` alone, > 0; with what is to be told of how it was read.
    pub fn of_vertices(importance: &[f32], warnings: Vec<String>, clamped: usize) -> Self {
        let values = importance.iter().map(|&value| Some(ln(value))).collect();
        let admission = Admission { clamped, ..Admission::default() };
        Self { layers: vec![Ready::Vertices(values)], warnings, admission, ..Self::default() }
    }

    /// `[samples]` importance at surface samples, > 0 and finite.
    pub fn evaluate(&self, boundary: &Boundary, samples: &[Sample]) -> Vec<f32> {
        samples.par_iter().map(|sample| self.at(boundary, &Place::of_sample(boundary, sample))).collect()
    }

    /// `[vertices]` importance at the boundary's vertices, > 0 and finite.
    pub fn at_vertices(&self, boundary: &Boundary) -> Vec<f32> {
        let at = |(vertex, corner): (usize, &Option<(usize, usize)>)| {
            self.at(boundary, &Place::of_vertex(boundary, vertex, *corner))
        };
        boundary.first_corners().par_iter().enumerate().map(at).collect()
    }

    /// The same with `[vertices]` painted differences of ln f over all layers.
    #[must_use]
    pub fn painted(mut self, differences: Vec<f64>) -> Self {
        self.layers.push(Ready::Painted(differences));
        self
    }

    /// The regions named by the last `Regions` layer.
    pub fn regions(&self) -> Option<&Regions> {
        self.regions.as_ref()
    }

    /// Sentences for the user about values that were let in: how many were clamped, how many are extreme.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// How many values `clamp` changed or left out.
    pub fn clamped(&self) -> usize {
        self.admission.clamped
    }

    /// Whether importance is the same everywhere, as there is no layer.
    pub fn is_uniform(&self) -> bool {
        self.layers.is_empty()
    }

    fn prepare(&mut self, layer: &Layer, boundary: &Boundary, scene_dir: &Path) -> Result<Ready> {
        let vertices = boundary.positions.len();
        match layer {
            Layer::Sphere { centre, radius, value } => {
                let centre = DVec3::from_array(*centre);
                if !(centre.is_finite() && *radius > 0.0 && radius.is_finite()) {
                    let sentence = format!("sphere at {centre}: the centre must be finite and the radius {radius} > 0");
                    return Err(Error::input(sentence));
                }
                let value = self.admit(*value, || format!("sphere at {centre}"))?;
                let sphere = Sphere { centre, radius: *radius, ln_value: ln(value) };
                if !sphere.touches(&boundary.positions, &boundary.triangles) {
                    let sentence =
                        format!("sphere at {centre}: nothing of the surface lies within its radius {radius}");
                    self.warnings.push(sentence);
                }
                Ok(Ready::Sphere(sphere))
            }
            Layer::Attribute { name, range } => self.attribute(name, *range, boundary),
            Layer::Values { path } => {
                let values = table::values(&scene_dir.join(path), vertices, &mut self.admission)?;
                Ok(Ready::Vertices(logarithms(values)))
            }
            Layer::Regions { per_area: true, .. } => {
                Err(Error::input("--per-area is for pictures, and this is a mesh; leave it out"))
            }
            Layer::Regions { regions, values, .. } => {
                let (regions, values) = (scene_dir.join(regions), scene_dir.join(values));
                let (regions, values) = table::regions(&regions, &values, vertices, &mut self.admission)?;
                self.regions = Some(regions);
                Ok(Ready::Vertices(logarithms(values)))
            }
            Layer::Image { path, range } => {
                let path = scene_dir.join(path);
                let (low, high) = self.admit_range(range.unwrap_or(IMAGE_RANGE), || path.display().to_string())?;
                let Some(corner_uvs) = picture::corner_uvs(boundary) else {
                    let sentence = format!(
                        "{} has no texture coordinates, so a picture cannot be laid on it; unwrap the mesh or use --values",
                        boundary.name
                    );
                    return Err(Error::in_file(&path, sentence));
                };
                let picture = Picture::read(&path)?;
                if corner_uvs.iter().all(Option::is_none) {
                    self.warnings.push(format!("{}: no triangle has texture coordinates", path.display()));
                }
                Ok(Ready::Picture { picture, corner_uvs, range: (low, high) })
            }
        }
    }

    fn attribute(&mut self, name: &str, range: Option<Range>, boundary: &Boundary) -> Result<Ready> {
        let Some(attribute) = boundary.attributes.iter().find(|a| a.name == name) else {
            let names: Vec<_> = boundary.attributes.iter().map(|a| format!("`{}`", a.name)).collect();
            let known = if names.is_empty() { "it has none".into() } else { format!("it has {}", names.join(", ")) };
            return Err(Error::input(format!("{} has no vertex attribute `{name}` ({known})", boundary.name)));
        };
        let place = |vertex: usize| format!("attribute `{name}`: vertex {vertex}");
        let Some(range) = range else {
            let values = attribute.values.iter().enumerate();
            let values =
                values.map(|(vertex, value)| self.admission.admit(*value, &value.to_string(), || place(vertex)));
            return Ok(Ready::Vertices(logarithms(values.collect::<Result<_>>()?)));
        };
        let (low, high) = self.admit_range(range, || format!("attribute `{name}`"))?;
        let finite = || attribute.values.iter().copied().filter(|v| v.is_finite()).map(f64::from);
        let (least, greatest) = (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max));
        if least >= greatest {
            self.warnings.push(format!("attribute `{name}` is {least} everywhere: taken as the middle of the range"));
        }
        let mapped = |value: f64| {
            let t = if least < greatest { (value - least) / (greatest - least) } else { 0.5 };
            (low + t * (high - low)) as f32
        };
        let values = attribute.values.iter().enumerate().map(|(vertex, value)| match value.is_finite() {
            true => Ok(Some(mapped(f64::from(*value)))),
            // NaN and infinities have no place in the range: refused, or left out and counted.
            false => self.admission.admit(f32::NAN, &value.to_string(), || place(vertex)),
        });
        Ok(Ready::Vertices(logarithms(values.collect::<Result<_>>()?)))
    }

    /// Admits a value that was written by hand; NaN keeps.
    fn admit(&mut self, value: f32, place: impl FnOnce() -> String) -> Result<f32> {
        Ok(self.admission.admit(value, &value.to_string(), place)?.unwrap_or(1.0))
    }

    fn admit_range(&mut self, (low, high): Range, place: impl Fn() -> String) -> Result<(f64, f64)> {
        Ok((f64::from(self.admit(low, &place)?), f64::from(self.admit(high, &place)?)))
    }

    /// Importance at one place: the layers from the bottom up, in ln f.
    fn at(&self, boundary: &Boundary, place: &Place) -> f32 {
        let over = |below: f64, layer: &Ready| match layer {
            Ready::Sphere(sphere) => sphere.over(below, place.position),
            Ready::Vertices(values) => {
                let corner =
                    |(vertex, weight): &(usize, f64)| weight * values.get(*vertex).copied().flatten().unwrap_or(below);
                let total: f64 = place.corners.iter().map(|(_, weight)| weight).sum();
                if total > 0.0 { place.corners.iter().map(corner).sum::<f64>() / total } else { below }
            }
            Ready::Painted(differences) => {
                let corner =
                    |(vertex, weight): &(usize, f64)| weight * differences.get(*vertex).copied().unwrap_or(0.0);
                let total: f64 = place.corners.iter().map(|(_, weight)| weight).sum();
                if total > 0.0 { below + place.corners.iter().map(corner).sum::<f64>() / total } else { below }
            }
            Ready::Picture { picture, corner_uvs, range } => {
                let Some(uv) = place.uv(boundary, corner_uvs) else { return below };
                let (luminance, opacity) = picture.at(uv);
                let value = range.0 + luminance * (range.1 - range.0);
                below + opacity * (value.ln() - below)
            }
        };
        self.layers.iter().fold(self.ln_base, over).exp() as f32
    }
}

impl Place {
    fn of_sample(boundary: &Boundary, sample: &Sample) -> Self {
        let triangle = sample.triangle as usize;
        let Some(vertices) = boundary.triangles.get(triangle) else {
            return Self { position: DVec3::INFINITY, corners: [(usize::MAX, 0.0); 3], triangle: None };
        };
        let corners = [0, 1, 2].map(|i| (vertices[i] as usize, f64::from(sample.weights[i])));
        let position = corners.iter().map(|(vertex, weight)| boundary.positions[*vertex] * *weight).sum();
        Self { position, corners, triangle: Some(triangle) }
    }

    fn of_vertex(boundary: &Boundary, vertex: usize, corner: Option<(usize, usize)>) -> Self {
        let position = boundary.positions[vertex];
        let Some((triangle, corner)) = corner else {
            return Self { position, corners: [(vertex, 1.0), (vertex, 0.0), (vertex, 0.0)], triangle: None };
        };
        let vertices = boundary.triangles[triangle];
        let corners = [0, 1, 2].map(|i| (vertices[i] as usize, if i == corner { 1.0 } else { 0.0 }));
        Self { position, corners, triangle: Some(triangle) }
    }

    fn uv(&self, boundary: &Boundary, corner_uvs: &[Option<[Vec2; 3]>]) -> Option<Vec2> {
        debug_assert_eq!(corner_uvs.len(), boundary.triangles.len());
        let uvs = (*corner_uvs.get(self.triangle?)?)?;
        Some(uvs.iter().zip(self.corners).map(|(uv, (_, weight))| *uv * weight as f32).sum())
    }
}

fn ln(value: f32) -> f64 {
    f64::from(value).ln()
}

fn logarithms(values: Vec<Option<f32>>) -> Vec<Option<f64>> {
    values.into_iter().map(|value| value.map(ln)).collect()
}
