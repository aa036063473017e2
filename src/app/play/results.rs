//! What the export dialog writes: the same files as the command line.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::app::flat::{Drawn, crossings};
use crate::app::load::settings_of;
use crate::boundary::Boundary;
use crate::export::report::{self, Report};
use crate::export::{self, GrowthFrame};
use crate::importance::{self, Stack};
use crate::paint::PaintedPicture;
use crate::panel::{Asked, Choice};
use crate::run::Outcome;
use crate::scene::Scene;
use crate::session::Snapshot;
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
    #[cfg(feature = "record")]
    pub seen_from: crate::view::Orbit,
    /// Set when what is being written is to stop.
    pub stop: Arc<AtomicBool>,
}

/// Writes it; where.
pub(super) fn write(order: &Order) -> Result<PathBuf> {
    let Order { boundary, outcome, path, .. } = order;
    let export = &order.choice.export;
    order.check()?;
    let stopped = || order.stop.load(Ordering::Relaxed);
    let colours = importance::colours(&outcome.importance);
    let colours = |wanted: bool| wanted.then_some(colours.as_slice());
    if let Some(picture) = &order.picture
        && matches!(order.asked, Asked::ExportMesh | Asked::ExportGrowth)
    {
        let drawn = Drawn::new(&picture.ground.picture, boundary, &outcome.frames);
        let scale = f64::from(export.scale);
        match (order.asked, extension(path).as_str()) {
            (Asked::ExportMesh, "png") => {
                let last = order.snapshot.film.last().zip(order.snapshot.lattice.as_ref());
                let height = f64::from(picture.ground.picture.size.y);
                let crossings = last.map(|(last, lattice)| crossings(&lattice.complex, &last.positions, height));
                drawn.write_picture(path, scale, &crossings.unwrap_or_default())?;
            }
            (Asked::ExportMesh, _) => return Err(Error::in_file(path, "a warped picture is written as .png")),
            (_, "gif" | "apng" | "png" | "glb") => {
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
            let colours = colours(export.colour_growth);
            export::growth(boundary, &frames, colours, export.seconds, path, &stopped)?;
        }
        Asked::ExportReport => report::write(&order.report(), path)?,
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
    /// Whether it may be written there.
    pub fn check(&self) -> Result<()> {
        let Self { scene, path, .. } = self;
        if scene.files().iter().any(|file| is_same(file, path)) {
            return Err(Error::in_file(path, "it is an input of this scene; give the result another name"));
        }
        Ok(())
    }

    pub fn report(&self) -> Report {
        let scene = &self.scene;
        let settings = settings_of(scene);
        let mut report = Report::of(scene, &settings, self.stack.clamped(), &self.outcome, self.warnings.clone());
        if let Some((picture, lattice)) = self.picture.as_ref().zip(self.snapshot.lattice.as_ref()) {
            let drawn = Drawn::new(&picture.ground.picture, &self.boundary, &self.outcome.frames);
            report.take_areas(drawn.areas(&picture.field(), lattice.complex.grid.cell_size));
        }
        report
    }
}
