//! `homunculus warp` of a picture: from a scene to a warped picture and its growth.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use glam::{DVec2, Vec3A};
use image::Rgba;

use super::load::LoadedPicture;
use super::options::{Colour, WarpOptions};
use super::outputs::Outputs;
use super::{Verdict, cancel, progress, say, warp};
use crate::boundary::Boundary;
use crate::export::report::{AreaReport, Report};
use crate::export::{self, GrowthFrame, write_atomically};
use crate::film::blend_places;
use crate::importance;
use crate::picture::animate::{self, Frame};
use crate::picture::render::{Canvas, Painter, mark};
use crate::picture::{FlatMesh, Picture, areas};
use crate::scene::Scene;
use crate::schedule::{self, Domain, Solved};
use crate::{Error, Result};

/// Frames of an animated picture in each second: smooth enough for growth, and half the size of a film's.
const FRAMES_PER_SECOND: f32 = 15.0;

/// How long the grown picture stands before the animation begins again, as a part of the growing time.
const HOLD: f32 = 0.25;

/// Where a picture crosses itself, in every look at it.
pub(super) const CROSSING: Rgba<u8> = Rgba([230, 0, 0, 255]);

/// Warps, writes and says how it went.
pub(super) fn run(options: &WarpOptions, scene: &Scene, outputs: &Outputs, loaded: LoadedPicture) -> Result<Verdict> {
    let LoadedPicture { picture, field, flat, settings, warnings } = loaded;
    let watcher = progress::watcher(options.scene.quiet);
    let solved = schedule::solve_domain(Domain::picture(Arc::new(flat), settings.clone()), &watcher);
    watcher.finish();
    let solved = solved?;
    if cancel::asked() {
        return Err(Error::Cancelled);
    }
    let drawn = Drawn::new(&picture, &solved);
    let areas = areas(&field, &picture, &drawn.mesh, drawn.last());
    let cell = solved.complex.grid.cell_size.powi(2);
    let area_report = AreaReport::of(&areas, &field, &picture.domain, cell);
    let mut report = Report::of(scene, &settings, field.clamped, &solved.outcome, warnings);
    report.take_areas(area_report);
    let written = write(options, scene, outputs, &picture, &solved, &drawn, &report)?;
    if !options.scene.quiet {
        say(&warp::summary(&report, &written));
    }
    Ok(if report.certified() { Verdict::Done } else { Verdict::NotCertified })
}

/// The mesh a picture is drawn on, and its states, in pixels with y downwards.
pub(super) struct Drawn {
    pub mesh: FlatMesh,
    /// By rising λ.
    states: Vec<(f32, Vec<DVec2>)>,
    pub height: f64,
}

impl Drawn {
    pub fn new(picture: &Picture, solved: &Solved) -> Self {
        let height = f64::from(picture.size.y);
        let places = |positions: &[glam::DVec3]| positions.iter().map(|p| DVec2::new(p.x, height - p.y)).collect();
        let Boundary { positions, triangles, .. } = &*solved.boundary;
        let frames = solved.outcome.frames.iter();
        Self {
            mesh: FlatMesh { rest: places(positions), triangles: triangles.clone() },
            states: frames.map(|frame| (frame.lambda, places(&frame.positions))).collect(),
            height,
        }
    }

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
}

/// Writes what was ordered, each file whole or not at all. Returns where.
fn write(
    options: &WarpOptions,
    scene: &Scene,
    outputs: &Outputs,
    picture: &Picture,
    solved: &Solved,
    drawn: &Drawn,
    report: &Report,
) -> Result<Vec<PathBuf>> {
    let scale = options.scale.unwrap_or(1.0);
    let painter = Painter::new(picture, &drawn.mesh);
    let mut written = Vec::new();
    if let Some(path) = &outputs.mesh {
        let canvas = Canvas::around(picture, &drawn.mesh, [drawn.last()], scale)?;
        let mut pixels = painter.render(drawn.last(), &canvas);
        let last = solved.film.keyframes().last().map_or(&[][..], |last| &last.positions);
        let crossings = crossings(solved, last, drawn.height);
        // Thick enough to be seen in a large picture.
        let width = f64::from(canvas.size.max_element()) / 250.0;
        mark(&mut pixels, &canvas, &crossings, width.max(2.0), CROSSING);
        write_atomically(path, |file| pixels.write_png(file, picture.profile.as_deref()))?;
        written.push(path.clone());
    }
    if let Some(path) = &outputs.growth {
        growth(options, path, picture, solved, drawn, &painter)?;
        written.push(path.clone());
    }
    written.extend(outputs.write_accounts(scene, report)?);
    Ok(written)
}

/// Edges of the outline that cross another one in a state of the nodes, in pixels with y downwards.
pub(super) fn crossings(solved: &Solved, nodes: &[Vec3A], height: f64) -> Vec<(DVec2, DVec2)> {
    let Some(skin) = solved.shells.first().filter(|_| nodes.len() == solved.complex.nodes()) else { return Vec::new() };
    let place = |node: u32| {
        let p = solved.complex.grid.source_from_lattice(nodes[node as usize].as_dvec3());
        DVec2::new(p.x, height - p.y)
    };
    let edges = skin.crossings(nodes).into_iter().flat_map(|(s, t)| [s, t]);
    edges
        .map(|face| {
            let [a, b, _] = solved.complex.faces[face as usize];
            (place(a), place(b))
        })
        .collect()
}

/// The growth as a textured mesh or an animated picture, by the file's extension.
fn growth(
    options: &WarpOptions,
    path: &Path,
    picture: &Picture,
    solved: &Solved,
    drawn: &Drawn,
    painter: &Painter,
) -> Result<()> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    if extension == "glb" {
        let colours = importance::colours(&solved.outcome.importance);
        let colours = (options.colour == Some(Colour::Importance)).then_some(colours.as_slice());
        let mut texture = Vec::new();
        picture.pixels.write_png(&mut texture, picture.profile.as_deref()).map_err(|e| Error::writing(path, e))?;
        let boundary = (*solved.boundary).clone().with_texture(&picture.name, texture);
        let frames: Vec<_> =
            solved.outcome.frames.iter().map(|f| GrowthFrame { lambda: f.lambda, positions: &f.positions }).collect();
        return export::growth(&boundary, &frames, colours, options.seconds, path);
    }
    let states = drawn.states.iter().map(|(_, places)| places.as_slice());
    let canvas = Canvas::around(picture, &drawn.mesh, states, options.scale.unwrap_or(1.0))?;
    let steps = (options.seconds * FRAMES_PER_SECOND).round().max(1.0) as u32;
    let seconds = f64::from(options.seconds);
    let frame = |k: u32| {
        if cancel::asked() {
            return Err(io::Error::new(io::ErrorKind::Interrupted, "cancelled"));
        }
        let places = drawn.at(k as f32 / steps as f32);
        let pixels = painter.render(&places, &canvas).into_eight();
        let time = if k == steps { seconds * f64::from(HOLD) } else { seconds / f64::from(steps) };
        Ok(Frame { pixels, delay: Duration::from_secs_f64(time) })
    };
    let written = write_atomically(path, |file| match extension.as_str() {
        "gif" => {
            let samples = [0, steps / 2, steps].map(|k| frame(k).map(|f| f.pixels));
            let samples = samples.into_iter().collect::<io::Result<Vec<_>>>()?;
            animate::gif(file, &samples.iter().collect::<Vec<_>>(), (0..=steps).map(frame))
        }
        _ => animate::apng(file, steps + 1, (0..=steps).map(frame)),
    });
    if cancel::asked() { Err(Error::Cancelled) } else { written }
}
