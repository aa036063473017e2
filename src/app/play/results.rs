//! What the export dialog writes: the same files as the command line.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::app::flat::Drawn;
use crate::boundary::Boundary;
use crate::export::report::{self, Report};
use crate::export::{self, GrowthFrame};
use crate::importance::{self, Stack};
use crate::paint::PaintedPicture;
use crate::panel::{Asked, Choice};
use crate::scene::Scene;
use crate::schedule::{Outcome, Settings};
use crate::session::Snapshot;
use crate::view::Orbit;
use crate::{Error, Result};

/// What to write, of what, where.
pub(super) struct Order {
    pub asked: Asked,
    pub path: PathBuf,
    pub scene: Scene,
    pub stack: Arc<Stack>,
    /// What is drawn: of a picture the mesh that carries it.
    pub boundary: Arc<Boundary>,
    /// The picture with what was painted on it, if it is one.
    pub picture: Option<PaintedPicture>,
    pub outcome: Arc<Outcome>,
    pub snapshot: Arc<Snapshot>,
    pub warnings: Vec<String>,
    pub choice: Choice,
    pub seen_from: Orbit,
    /// Set when it is to stop.
    pub stop: Arc<AtomicBool>,
}

/// Writes it; where.
pub(super) fn write(order: &Order) -> Result<PathBuf> {
    let Order { boundary, outcome, path, .. } = order;
    let export = &order.choice.export;
    if order.scene.files().iter().any(|file| is_same(file, path)) {
        return Err(Error::in_file(path, "it is an input of this scene; give the result another name"));
    }
    let colours = importance::colours(&outcome.importance);
    let colours = |wanted: bool| wanted.then_some(colours.as_slice());
    if let Some(picture) = &order.picture
        && matches!(order.asked, Asked::ExportMesh | Asked::ExportGrowth)
    {
        let drawn = Drawn::new(&picture.ground.picture, boundary, &outcome.frames);
        let scale = f64::from(export.scale);
        match (order.asked, extension(path).as_str()) {
            (Asked::ExportMesh, "png") => drawn.write_picture(path, scale, &[])?,
            (Asked::ExportMesh, _) => return Err(Error::in_file(path, "a warped picture is written as .png")),
            (_, "gif" | "apng" | "png" | "glb") => {
                let stopped = || order.stop.load(Ordering::Relaxed);
                // Colours would hide the picture: the growth is the picture's own.
                drawn.write_growth(path, scale, export.seconds, None, &stopped)?;
            }
            _ => return Err(Error::in_file(path, "the growth of a picture is written as .gif, .apng or .glb")),
        }
        return Ok(path.clone());
    }
    match order.asked {
        Asked::ExportMesh => {
            let last = outcome.frames.last().ok_or_else(|| Error::Fault("the film is empty".into()))?;
            export::mesh(boundary, &last.positions, colours(export.colour_mesh), path)?;
        }
        Asked::ExportGrowth => {
            let frames: Vec<_> =
                outcome.frames.iter().map(|f| GrowthFrame { lambda: f.lambda, positions: &f.positions }).collect();
            export::growth(boundary, &frames, colours(export.colour_growth), export.seconds, path)?;
        }
        Asked::ExportReport => report::write(&order.report(), path)?,
        #[cfg(feature = "record")]
        Asked::ExportFilm => film::write(order)?,
        _ => return Err(Error::in_file(path, "this program was built without what writes it")),
    }
    Ok(path.clone())
}

fn extension(path: &Path) -> String {
    path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default()
}

fn is_same(a: &Path, b: &Path) -> bool {
    a.canonicalize().ok().zip(b.canonicalize().ok()).is_some_and(|(a, b)| a == b)
}

impl Order {
    fn report(&self) -> Report {
        let scene = &self.scene;
        let settings =
            Settings { resolution: scene.resolution, fidelity: scene.fidelity, keys: scene.keys, reference: None };
        let mut report = Report::of(scene, &settings, self.stack.clamped(), &self.outcome, self.warnings.clone());
        if let Some((picture, lattice)) = self.picture.as_ref().zip(self.snapshot.lattice.as_ref()) {
            let drawn = Drawn::new(&picture.ground.picture, &self.boundary, &self.outcome.frames);
            report.take_areas(drawn.areas(&picture.field(), lattice.complex.grid.cell_size));
        }
        report
    }
}

/// The film as the view shows it.
#[cfg(feature = "record")]
mod film {
    use super::{Order, Ordering};
    use crate::collision::Shell;
    use crate::film::{Film, Keyframe};
    use crate::panel::{Compare, Easing, Repeat};
    use crate::record::{self, Camera, Draft, Ease, Settings, Subject, View};
    use crate::schedule::{Observer, Outcome, Progress, Solved};
    use crate::view::Mode;
    use crate::{Error, Result};

    /// Stops a film.
    struct Stop<'a>(&'a Order);

    impl Observer for Stop<'_> {
        fn progress(&self, _: &Progress) {}

        fn cancelled(&self) -> bool {
            self.0.stop.load(Ordering::Relaxed)
        }
    }

    pub(super) fn write(order: &Order) -> Result<()> {
        let settings = settings(order)?;
        let (mut subject, _) = Subject::new(order.boundary.clone(), solved(order)?);
        let take = record::shoot(&mut subject, &settings, &order.path, &Stop(order), |_| {})?;
        let beside = serde_json::json!({
            "film": order.path.file_name().map(|name| name.to_string_lossy()),
            "version": env!("CARGO_PKG_VERSION"),
            "seed": null,
            "scene": &*order.scene,
            "recording": &take.account,
            "report": order.report(),
        });
        take.keep(&beside).map(drop)
    }

    fn settings(order: &Order) -> Result<Settings> {
        let (choice, from) = (&order.choice, &order.seen_from);
        let [width, height] = choice.export.film_size;
        let is_picture = order.picture.is_some();
        let turn = from.yaw.to_degrees().rem_euclid(360.0);
        Settings::new(Draft {
            seconds: choice.export.film_seconds.into(),
            width,
            height,
            ease: if choice.player.easing == Easing::Linear { Ease::Linear } else { Ease::InOut },
            ping_pong: choice.player.repeat == Repeat::PingPong,
            turntable: if choice.turntable && !is_picture { 1.0 } else { 0.0 },
            camera: Camera { yaw: turn, pitch: from.pitch.to_degrees().clamp(-89.0, 89.0), zoom: 1.0 },
            view: match (choice.compare, choice.mode) {
                (Compare::SideBySide | Compare::Wipe, _) => View::Compare,
                (_, Mode::Voxels(_)) => View::Voxels,
                (_, Mode::Plain) => View::Plain,
                _ => View::Importance,
            },
            legend: choice.export.film_legend,
            ..Draft::default()
        })
    }

    /// The session's result as the recorder takes it.
    fn solved(order: &Order) -> Result<Solved> {
        let snapshot = &order.snapshot;
        let parts = snapshot.lattice.as_ref().zip(snapshot.linear.as_ref()).zip(snapshot.importance.as_ref());
        let Some(((lattice, linear), importance)) = parts else {
            return Err(Error::Fault("a solve that is done lacks its lattice".into()));
        };
        let (complex, binding) = (lattice.complex.clone(), lattice.binding.clone());
        let shells = vec![Shell::skin(&complex), Shell::boundary(&order.boundary, (*binding).clone(), &complex)];
        let mut film = Film::default();
        for state in &snapshot.film {
            let (positions, certificate) = ((*state.positions).clone(), state.certificate.clone());
            film.push(Keyframe { lambda: state.lambda, positions, certificate, way_is_clear: false });
        }
        let (linear, importance) = ((**linear).clone(), (**importance).clone());
        let (boundary, outcome) = (order.boundary.clone(), Outcome::clone(&order.outcome));
        Ok(Solved { boundary, complex, binding, shells, film, linear, importance, outcome })
    }
}
