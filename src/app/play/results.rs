//! What the export dialog writes: the same files as the command line.

use std::path::PathBuf;
use std::sync::Arc;

use crate::boundary::Boundary;
use crate::export::report::{self, Report};
use crate::export::{self, GrowthFrame};
use crate::importance::{self, Stack};
use crate::panel::{Asked, ExportChoice};
use crate::scene::Scene;
use crate::schedule::{Outcome, Settings};
use crate::{Error, Result};

/// What to write, of what, where.
pub(super) struct Order {
    pub asked: Asked,
    pub path: PathBuf,
    pub scene: Scene,
    pub stack: Arc<Stack>,
    pub boundary: Arc<Boundary>,
    pub outcome: Arc<Outcome>,
    pub warnings: Vec<String>,
    pub export: ExportChoice,
}

/// Writes it; where.
pub(super) fn write(order: &Order) -> Result<PathBuf> {
    let Order { boundary, outcome, path, export, .. } = order;
    if order.scene.files().iter().any(|file| same(file, path)) {
        return Err(Error::in_file(path, "it is an input of this scene; give the result another name"));
    }
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
        Asked::ExportReport => {
            let settings = Settings {
                resolution: order.scene.resolution,
                fidelity: order.scene.fidelity,
                keys: order.scene.keys,
                reference: None,
            };
            report::write(
                &Report::of(&order.scene, &settings, order.stack.clamped(), outcome, order.warnings.clone()),
                path,
            )?;
        }
        _ => return Err(Error::Fault("nothing is written for this dialog".into())),
    }
    Ok(path.clone())
}

fn same(a: &std::path::Path, b: &std::path::Path) -> bool {
    a.canonicalize().ok().zip(b.canonicalize().ok()).is_some_and(|(a, b)| a == b)
}
