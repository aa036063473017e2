//! `homunculus warp`: from a scene to certified files.

use super::load::{self, Loaded, only_of_pictures};
use super::options::WarpOrder;
use super::outputs::{self, Outputs};
use super::{Verdict, cancel, say};
use crate::subject::{self, Grown};
use crate::{Error, Result};

/// Warps, writes and says how it went.
pub(super) fn run(order: &WarpOrder) -> Result<Verdict> {
    let options = &order.options;
    let scene = order.scene()?;
    load::begin(&options.scene)?;
    let found = subject::find(&scene.source)?;
    let of_pictures = options.scale.is_some() || scene.background.is_some();
    only_of_pictures(found.kind(), "--scale and --background", of_pictures)?;
    let outputs = Outputs::of(options, &scene, found.kind())?;
    let loaded = Loaded::new(&scene, &options.scene, found)?;
    let solved = loaded.solve()?;
    if cancel::asked() {
        return Err(Error::Cancelled);
    }
    let grown = Grown::from(&solved);
    let report = loaded.report(&scene, &grown);
    let written = outputs.write(&*loaded.subject, &grown, &options.look(), &scene, &report)?;
    if !options.scene.quiet {
        say(&outputs::summary(&report, &written));
    }
    Ok(if report.certified() { Verdict::Done } else { Verdict::NotCertified })
}
