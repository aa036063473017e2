//! Pictures, from a scene to a warped picture, its growth, and what is filmed of it.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use glam::{DVec2, Vec3A};
use image::Rgba;

use super::load::LoadedPicture;
#[cfg(feature = "record")]
use super::load::{self, PictureSource};
use super::options::{Colour, WarpOptions};
use super::outputs::Outputs;
#[cfg(feature = "record")]
use super::scene_options::SceneOptions;
use super::{Verdict, cancel, progress, say, warp};
use crate::boundary::Boundary;
use crate::certificate::Shell;
use crate::export::report::{AreaReport, Report};
use crate::importance;
use crate::importance::field::Field;
use crate::picture::animate::{self, Frame};
use crate::picture::render::{Canvas, Painter, mark};
use crate::scene::Scene;
use crate::voxel::Complex;
use crate::voxel::blend_places;
use crate::{Error, Result};
use crate::{
    export::{self, GrowthFrame},
    file::write_atomically,
};
use crate::{
    importance::areas,
    picture::{FlatMesh, Picture},
};
use crate::{
    run,
    run::{Domain, Solved},
};

/// Frames of an animated picture in each second: smooth enough for growth, and half the size of a film's.
const FRAMES_PER_SECOND: f32 = 15.0;

/// How long the grown picture stands before the animation begins again, as a part of the growing time.
const HOLD: f32 = 0.25;

/// Where a picture crosses itself, in every look at it.
pub(super) const CROSSING: Rgba<u8> = Rgba([230, 0, 0, 255]);

/// Warps, writes and says how it went.
pub(super) fn run(options: &WarpOptions, scene: &Scene, outputs: &Outputs, loaded: LoadedPicture) -> Result<Verdict> {
    let solved = solve(&loaded, options.scene.quiet)?;
    if cancel::asked() {
        return Err(Error::Cancelled);
    }
    let last = solved.film.keyframes().last().map_or(&[][..], |last| &last.positions);
    let crossings = crossings(&solved.complex, last, f64::from(loaded.picture.size.y));
    let drawn = Drawn::new(&loaded.picture, &solved.boundary, &solved.outcome.frames);
    let report = report(scene, &loaded, &solved, &drawn);
    let written = write(options, scene, outputs, &solved, &drawn, &crossings, &report)?;
    if !options.scene.quiet {
        say(&warp::summary(&report, &written));
    }
    Ok(if report.certified() { Verdict::Done } else { Verdict::NotCertified })
}

/// A picture that has grown, as it is filmed, and what came of it.
#[cfg(feature = "record")]
pub(super) fn subject(
    scene: &Scene,
    options: &SceneOptions,
    source: PictureSource,
) -> Result<(crate::record::Subject, Report)> {
    let loaded = load::load_picture(scene, options, source)?;
    let solved = solve(&loaded, options.quiet)?;
    let report = {
        let drawn = Drawn::new(&loaded.picture, &solved.boundary, &solved.outcome.frames);
        report(scene, &loaded, &solved, &drawn)
    };
    let boundary = (*solved.boundary).clone().with_texture(&loaded.picture.name, loaded.picture.body_png()?);
    let (subject, _) = crate::record::Subject::new(Arc::new(boundary), solved);
    Ok((subject, report))
}

fn solve(loaded: &LoadedPicture, quiet: bool) -> Result<Solved> {
    let watcher = progress::watcher(quiet);
    let domain = Domain::picture(Arc::new(loaded.flat.clone()), loaded.settings.clone());
    let solved = run::solve(domain, &watcher);
    watcher.finish();
    solved
}

fn report(scene: &Scene, loaded: &LoadedPicture, solved: &Solved, drawn: &Drawn) -> Report {
    let LoadedPicture { field, settings, warnings, .. } = loaded;
    let mut report = Report::of(scene, settings, field.clamped, &solved.outcome, warnings.clone());
    report.take_areas(drawn.areas(field, solved.complex.grid.cell_size));
    report
}

/// A picture in the states of its growth, to be written.
pub(super) struct Drawn<'a> {
    picture: &'a Picture,
    boundary: &'a Boundary,
    frames: &'a [run::Frame],
    /// What it is drawn on, in pixels with y downwards.
    pub mesh: FlatMesh,
    /// By rising λ, in pixels with y downwards.
    states: Vec<(f32, Vec<DVec2>)>,
}

impl<'a> Drawn<'a> {
    /// Of the mesh the engine drew it on, and its states.
    pub fn new(picture: &'a Picture, boundary: &'a Boundary, frames: &'a [run::Frame]) -> Self {
        let height = f64::from(picture.size.y);
        let places = |positions: &[glam::DVec3]| positions.iter().map(|p| DVec2::new(p.x, height - p.y)).collect();
        let mesh = FlatMesh { rest: places(&boundary.positions), triangles: boundary.triangles.clone() };
        let states = frames.iter().map(|frame| (frame.lambda, places(&frame.positions))).collect();
        Self { picture, boundary, frames, mesh, states }
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

    /// The growth in `seconds` as a textured mesh or an animated picture, by the file's extension. `colours`: `[vertices]`
    /// of the mesh. Ends early, and leaves nothing, when `stopped` says so.
    pub fn write_growth(
        &self,
        path: &Path,
        scale: f64,
        seconds: f32,
        colours: Option<&[[f32; 3]]>,
        stopped: &(dyn Fn() -> bool + Sync),
    ) -> Result<()> {
        let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
        if extension == "glb" {
            let boundary = self.boundary.clone().with_texture(&self.picture.name, self.picture.body_png()?);
            let frames: Vec<_> =
                self.frames.iter().map(|f| GrowthFrame { lambda: f.lambda, positions: &f.positions }).collect();
            return export::growth(&boundary, &frames, colours, seconds, path, stopped);
        }
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
        let written = write_atomically(path, |file| match extension.as_str() {
            "gif" => {
                let samples = [0, steps / 2, steps].map(|k| frame(k).map(|f| f.pixels));
                let samples = samples.into_iter().collect::<io::Result<Vec<_>>>()?;
                animate::gif(file, &samples.iter().collect::<Vec<_>>(), (0..=steps).map(frame))
            }
            _ => animate::apng(file, steps + 1, (0..=steps).map(frame)),
        });
        if stopped() { Err(Error::Cancelled) } else { written }
    }
}

/// Writes what was ordered, each file whole or not at all. Returns where.
fn write(
    options: &WarpOptions,
    scene: &Scene,
    outputs: &Outputs,
    solved: &Solved,
    drawn: &Drawn,
    crossings: &[(DVec2, DVec2)],
    report: &Report,
) -> Result<Vec<PathBuf>> {
    let scale = options.scale.unwrap_or(1.0);
    let mut written = Vec::new();
    if let Some(path) = &outputs.mesh {
        drawn.write_picture(path, scale, crossings)?;
        written.push(path.clone());
    }
    if let Some(path) = &outputs.growth {
        let colours = importance::colours(&solved.outcome.importance);
        let colours = (options.colour == Some(Colour::Importance)).then_some(colours.as_slice());
        drawn.write_growth(path, scale, options.seconds, colours, &cancel::asked)?;
        written.push(path.clone());
    }
    written.extend(outputs.write_accounts(scene, report)?);
    Ok(written)
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
