//! What the export dialog writes: the same files as the command line.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::export::report::{self, Report};
use crate::panel::{Asked, Choice};
use crate::run::Outcome;
use crate::scene::Scene;
use crate::session::{Lattice, Snapshot};
use crate::subject::{self, Grown, Look, Subject};
use crate::{Error, Result};

/// What to write, of what, where.
pub(super) struct Order {
    pub asked: Asked,
    pub path: PathBuf,
    pub scene: Scene,
    /// What was solved, with what was painted on it.
    pub subject: Arc<dyn Subject>,
    pub lattice: Lattice,
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
    order.check()?;
    let (subject, grown, path) = (&order.subject, order.grown(), &order.path);
    let stopped = || order.stop.load(Ordering::Relaxed);
    match order.asked {
        Asked::ExportMesh => subject.write_result(&grown, &order.look(order.choice.export.colour_mesh), path)?,
        Asked::ExportGrowth => {
            subject.write_growth(&grown, &order.look(order.choice.export.colour_growth), path, &stopped)?;
        }
        Asked::ExportReport => report::write(&order.report(), path)?,
        _ => return Err(Error::in_file(path, "this program was built without what writes it")),
    }
    Ok(path.clone())
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
        let (scene, warnings) = (&self.scene, self.warnings.clone());
        subject::report(&*self.subject, scene, &scene.settings(), &self.grown(), warnings)
    }

    fn grown(&self) -> Grown<'_> {
        let last = self.snapshot.film.last().map_or(&[][..], |last| &last.positions);
        Grown { boundary: &self.lattice.boundary, outcome: &self.outcome, complex: &self.lattice.complex, last }
    }

    /// How it is to look. Colours are chosen for bodies alone: a picture has its own.
    fn look(&self, coloured: bool) -> Look {
        let export = &self.choice.export;
        let coloured = (!self.subject.kind().is_flat()).then_some(coloured);
        Look { scale: f64::from(export.scale), seconds: export.seconds, coloured }
    }
}
