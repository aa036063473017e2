//! Importance of a surface: layers over a base value, read and checked for one boundary.

use std::fmt::Debug;
use std::path::Path;
use std::sync::Arc;

use glam::{DVec3, Vec2};
use rayon::prelude::*;

use super::Layer;
use super::admission::Reading;
use crate::Result;
use crate::boundary::{Boundary, Regions};

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
    layers: Vec<Arc<dyn OnSurface>>,
    regions: Option<Regions>,
    clamped: usize,
    warnings: Vec<String>,
}

/// A layer with everything it needs in memory.
pub(super) trait OnSurface: Debug + Send + Sync {
    /// ln f at a place where it is `below` without this layer.
    fn over(&self, below: f64, boundary: &Boundary, place: &Place) -> f64;
}

/// A surface while layers are read for it.
pub(super) struct Surface<'a> {
    pub boundary: &'a Boundary,
    /// The regions of the last layer that has some.
    pub regions: Option<Regions>,
    pub reading: Reading,
}

/// `[vertices]` ln f, `None` where what is below stays.
#[derive(Debug)]
pub(super) struct OfVertices(Vec<Option<f64>>);

/// `[vertices]` what is added to ln f by hand.
#[derive(Debug)]
struct Painted(Vec<f64>);

/// Where importance is asked for, resolved.
pub(super) struct Place {
    pub position: DVec3,
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
        let (reading, ln_base) = Reading::new(base, clamp)?;
        let mut surface = Surface { boundary, regions: None, reading };
        let read = |layer: &Layer| layer.within(scene_dir).on_surface(&mut surface);
        let layers = layers.iter().map(read).collect::<Result<_>>()?;
        let (warnings, clamped) = surface.reading.finish();
        Ok(Self { ln_base, layers, regions: surface.regions, clamped, warnings })
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
        let values = OfVertices::new(importance.iter().copied().map(Some));
        Self { layers: vec![Arc::new(values)], warnings, clamped, ..Self::default() }
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
        self.layers.push(Arc::new(Painted(differences)));
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
        self.clamped
    }

    /// Importance at one place: the layers from the bottom up, in ln f.
    fn at(&self, boundary: &Boundary, place: &Place) -> f32 {
        self.layers.iter().fold(self.ln_base, |below, layer| layer.over(below, boundary, place)).exp() as f32
    }
}

impl OfVertices {
    /// Of `[vertices]` importance, > 0; `None` where what is below stays.
    pub fn new(importance: impl IntoIterator<Item = Option<f32>>) -> Self {
        Self(importance.into_iter().map(|value| value.map(|value| f64::from(value).ln())).collect())
    }
}

impl OnSurface for OfVertices {
    fn over(&self, below: f64, _: &Boundary, place: &Place) -> f64 {
        place.mean(|vertex| self.0.get(vertex).copied().flatten().unwrap_or(below)).unwrap_or(below)
    }
}

impl OnSurface for Painted {
    fn over(&self, below: f64, _: &Boundary, place: &Place) -> f64 {
        place.mean(|vertex| self.0.get(vertex).copied().unwrap_or(0.0)).map_or(below, |added| below + added)
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

    /// The weighted mean of what vertices have; `None` at a place of no vertex.
    fn mean(&self, of: impl Fn(usize) -> f64) -> Option<f64> {
        let total: f64 = self.corners.iter().map(|(_, weight)| weight).sum();
        (total > 0.0).then(|| self.corners.iter().map(|(vertex, weight)| weight * of(*vertex)).sum::<f64>() / total)
    }

    /// Texture coordinates, of `[triangles]` those of their corners.
    pub fn uv(&self, boundary: &Boundary, corner_uvs: &[Option<[Vec2; 3]>]) -> Option<Vec2> {
        debug_assert_eq!(corner_uvs.len(), boundary.triangles.len());
        let uvs = (*corner_uvs.get(self.triangle?)?)?;
        Some(uvs.iter().zip(self.corners).map(|(uv, (_, weight))| *uv * weight as f32).sum())
    }
}
