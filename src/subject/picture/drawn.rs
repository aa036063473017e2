//! A picture in the states of its growth, drawn and written.

use std::io;
use std::path::Path;
use std::time::Duration;

use glam::{DVec2, DVec3, Vec3A};
use image::Rgba;

use super::super::{Grown, Stopped};
use crate::certificate::Shell;
use crate::export::report::AreaReport;
use crate::file::write_atomically;
use crate::importance::{Field, areas};
use crate::picture::animate::{self, Frame};
use crate::picture::render::{Canvas, Painter, mark};
use crate::picture::{FlatMesh, Picture};
use crate::voxel::{Complex, blend_places};
use crate::{Error, Result};

/// Frames of an animated picture in each second: smooth enough for growth, and half the size of a film's.
const FRAMES_PER_SECOND: f32 = 15.0;

/// How long the grown picture stands before the animation begins again, as a part of the growing time.
const HOLD: f32 = 0.25;

/// Where a picture crosses itself, in every look at it.
pub(super) const CROSSING: Rgba<u8> = Rgba([230, 0, 0, 255]);

/// A picture in the states of its growth, to be written.
pub(super) struct Drawn<'a> {
    picture: &'a Picture,
    /// What it is drawn on, in pixels with y downwards.
    pub mesh: FlatMesh,
    /// By rising λ, in pixels with y downwards.
    states: Vec<(f32, Vec<DVec2>)>,
}

impl<'a> Drawn<'a> {
    /// Of the mesh the engine drew it on, and its states.
    pub fn new(picture: &'a Picture, grown: &Grown) -> Self {
        let height = f64::from(picture.size.y);
        let places = |positions: &[DVec3]| positions.iter().map(|p| DVec2::new(p.x, height - p.y)).collect();
        let boundary = grown.boundary;
        let mesh = FlatMesh { rest: places(&boundary.positions), triangles: boundary.triangles.clone() };
        let states = grown.outcome.frames.iter().map(|frame| (frame.lambda, places(&frame.positions))).collect();
        Self { picture, mesh, states }
    }

    /// The last state.
    pub fn last(&self) -> &[DVec2] {
        self.states.last().map_or(&self.mesh.rest, |(_, places)| places)
    }

    /// The state at a λ in 0..=1, between two frames their blend.
    fn at(&self, lambda: f32) -> Vec<DVec2> {
        let after = self.states.iter().position(|(l, _)| *l >= lambda).unwrap_or(self.states.len() - 1);
        let (to, places) = &self.states[after];
        match after.checked_sub(1).map(|before| &self.states[before]) {
            Some((from, before)) if to > from => blend_places(before, places, f64::from((lambda - from) / (to - from))),
            _ => places.clone(),
        }
    }

    /// Asked and achieved areas of the field's regions; `cell_size` in pixels.
    pub fn areas(&self, field: &Field, cell_size: f64) -> Option<AreaReport> {
        let areas = areas(field, self.picture, &self.mesh, self.last());
        AreaReport::of(&areas, field, &self.picture.domain, cell_size.powi(2))
    }

    /// The warped picture, `scale` times as fine as it was; `crossings` are marked.
    pub fn write_picture(&self, path: &Path, scale: f64, crossings: &[(DVec2, DVec2)]) -> Result<()> {
        let canvas = Canvas::around(self.picture, &self.mesh, [self.last()], scale)?;
        let mut pixels = Painter::new(self.picture, &self.mesh).render(self.last(), &canvas);
        // Thick enough to be seen in a large picture.
        let width = f64::from(canvas.size.max_element()) / 250.0;
        mark(&mut pixels, &canvas, crossings, width.max(2.0), CROSSING);
        write_atomically(path, |file| pixels.write_png(file, self.picture.profile.as_deref()))
    }

    /// The growth in `seconds` as an animated picture, GIF or APNG. Ends early, and leaves nothing, when `stopped` says so.
    pub fn write_animation(&self, path: &Path, is_gif: bool, scale: f64, seconds: f32, stopped: Stopped) -> Result<()> {
        let states = self.states.iter().map(|(_, places)| places.as_slice());
        let canvas = Canvas::around(self.picture, &self.mesh, states, scale)?;
        let painter = Painter::new(self.picture, &self.mesh);
        let steps = (seconds * FRAMES_PER_SECOND).round().max(1.0) as u32;
        let seconds = f64::from(seconds);
        let frame = |k: u32| {
            if stopped() {
                return Err(io::Error::new(io::ErrorKind::Interrupted, "cancelled"));
            }
            let places = self.at(k as f32 / steps as f32);
            let pixels = painter.render(&places, &canvas).into_eight();
            let time = if k == steps { seconds * f64::from(HOLD) } else { seconds / f64::from(steps) };
            Ok(Frame { pixels, delay: Duration::from_secs_f64(time) })
        };
        let written = write_atomically(path, |file| {
            if !is_gif {
                return animate::apng(file, steps + 1, (0..=steps).map(frame));
            }
            let samples = [0, steps / 2, steps].map(|k| frame(k).map(|f| f.pixels));
            let samples = samples.into_iter().collect::<io::Result<Vec<_>>>()?;
            animate::gif(file, &samples.iter().collect::<Vec<_>>(), (0..=steps).map(frame))
        });
        if stopped() { Err(Error::Cancelled) } else { written }
    }
}

/// Edges of the outline that cross another one in a state of the nodes, in pixels with y downwards.
pub(super) fn crossings(complex: &Complex, nodes: &[Vec3A], height: f64) -> Vec<(DVec2, DVec2)> {
    if nodes.len() != complex.nodes() {
        return Vec::new();
    }
    let skin = Shell::skin(complex);
    let place = |node: u32| {
        let p = complex.grid.source_from_lattice(nodes[node as usize].as_dvec3());
        DVec2::new(p.x, height - p.y)
    };
    let edges = skin.crossings(nodes).into_iter().flat_map(|(s, t)| [s, t]);
    edges
        .map(|face| {
            let [a, b, _] = complex.faces[face as usize];
            (place(a), place(b))
        })
        .collect()
}
