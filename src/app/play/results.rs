//! What the export dialog writes: the same files as the command line.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::boundary::Boundary;
use crate::export::report::{self, Report};
use crate::export::{self, GrowthFrame};
use crate::importance::{self, Stack};
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
    pub boundary: Arc<Boundary>,
    pub outcome: Arc<Outcome>,
    pub snapshot: Arc<Snapshot>,
    pub warnings: Vec<String>,
    pub choice: Choice,
    pub seen_from: Orbit,
}

/// Writes it; where.
pub(super) fn write(order: &Order) -> Result<PathBuf> {
    let Order { boundary, outcome, path, .. } = order;
    let export = &order.choice.export;
    order.check()?;
    let colours = importance::colours(&outcome.importance);
    let colours = |wanted: bool| wanted.then_some(colours.as_slice());
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
        let scene = &self.scene;
        let settings =
            Settings { resolution: scene.resolution, fidelity: scene.fidelity, keys: scene.keys, reference: None };
        Report::of(scene, &settings, self.stack.clamped(), &self.outcome, self.warnings.clone())
    }
}
