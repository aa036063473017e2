//! Films of the growth, and single pictures of it.
//!
//! # Theory
//! Time is the frame's number. [`plan`] says which state each frame shows: the blend of two neighbouring keyframes of the
//! [film](crate::film), which is what the picture is drawn from and what is certified, bit for bit, blends included. Nothing is
//! solved while filming, and nothing knows a clock, so that the same scene gives the same frames.
//!
//! # Practice
//! - [`shoot`] draws without a window, frame after frame, while a thread encodes; a slow machine takes longer and drops
//!   nothing.
//! - MP4, GIF, APNG and PNG are encoded in the program (H.264 by OpenH264, BSD-2; the rest by Rust crates under MIT or
//!   Apache-2.0). WebM and others go through the program `ffmpeg` where it is installed. See [`encode`].
//! - A film takes its name when all of it is written, together with its [`sidecar`]; stopped, it leaves nothing.

mod actor;
pub mod encode;
mod lens;
mod overlay;
mod plan;
mod settings;
mod sidecar;
mod stage;
mod wall;
mod writer;

pub use actor::Actor;
pub(crate) use lens::Sight;
pub use plan::{FramePlan, Mix, plan};
pub use settings::{Camera, Draft, Ease, MAX_FRAMES, MAX_SIDE, MAX_TITLE, MIN_SIDE, Settings, View};
pub use sidecar::{Account, FrameAccount, SettingsAccount, sidecar};

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

use image::RgbaImage;
use serde::Serialize;

use crate::run::{Observer, Progress};
use crate::view::{self, Adapter};
use crate::{Error, Result};
use encode::{Format, Reel, Whole};
use stage::{Findings, Stage};
use writer::Writer;

/// A film that is complete but has no name yet. Dropped, it is gone.
pub struct Take {
    path: PathBuf,
    whole: Whole,
    /// How it was made and what it shows.
    pub account: Account,
}

/// Whether a film can be made here, asked before the solve: the format, and a driver.
///
/// # Errors
/// One sentence with what is wrong or missing.
pub fn check(settings: &Settings, path: &Path) -> Result<Adapter> {
    Format::of(path, settings.still.is_some())?.check(path, &reel(settings))?;
    let adapter = view::adapter()?;
    let (longest, most) = (settings.width.max(settings.height), adapter.largest_side);
    if longest > most {
        return Err(Error::input(format!("size {longest}: {} draws up to {most} pixels a side", adapter.name)));
    }
    Ok(adapter)
}

/// Draws and encodes a film, or a still. `preview` sees each picture.
///
/// # Errors
/// [`Error::Cancelled`] when the observer says so, [`Error::Input`] as [`check`], [`Error::File`] where the system refuses.
/// Nothing is left then.
pub fn shoot(
    actor: &mut Actor,
    settings: &Settings,
    path: &Path,
    observer: &dyn Observer,
    mut preview: impl FnMut(&RgbaImage),
) -> Result<Take> {
    let adapter = check(settings, path)?;
    let format = Format::of(path, settings.still.is_some())?;
    let (reel, keyframes) = (reel(settings), actor.lambdas());
    let plan = plan(settings, &keyframes);
    let progress = |done: usize| {
        let lambda = plan.get(done).map_or(1.0, |frame| frame.lambda);
        let fraction = done as f32 / plan.len() as f32;
        observer.progress(&Progress { stage: "record", lambda, size_error_p95: f32::NAN, fraction });
        if observer.cancelled() { Err(Error::Cancelled) } else { Ok(()) }
    };
    progress(0)?;
    let mut stage = Stage::new(actor, settings, &plan, &adapter)?;
    let mut samples = Vec::new();
    for frame in format.samples(plan.len()) {
        let findings = findings(actor, settings, &plan[frame]);
        samples.push(stage.picture(actor, &plan[frame], &findings)?);
        progress(0)?;
    }
    let mut writer = Writer::new(format.begin(path, &reel, &samples)?)?;
    drop(samples);
    let mut frames = Vec::with_capacity(plan.len());
    let mut seconds = 0.0;
    for (done, frame) in plan.iter().enumerate() {
        progress(done)?;
        let found = findings(actor, settings, frame);
        frames.push(FrameAccount::new(frame, found.growth.as_ref(), found.classic.as_ref()));
        let start = Instant::now();
        let picture = stage.picture(actor, frame, &found)?;
        seconds += start.elapsed().as_secs_f64();
        preview(&picture);
        writer.frame(picture)?;
    }
    let (whole, encoding) = writer.finish()?;
    progress(plan.len())?;
    let account = Account {
        certified: frames.iter().all(FrameAccount::certified),
        settings: settings.into(),
        adapter: adapter.name,
        render_frames_per_second: plan.len() as f64 / seconds,
        encode_frames_per_second: plan.len() as f64 / encoding,
        bytes: whole.bytes(),
        keyframes,
        frames,
    };
    Ok(Take { path: path.into(), whole, account })
}

fn reel(settings: &Settings) -> Reel {
    Reel {
        width: settings.width,
        height: settings.height,
        fps: settings.fps,
        frames: settings.frames(),
        transparent: settings.transparent,
    }
}

fn findings(actor: &mut Actor, settings: &Settings, frame: &FramePlan) -> Findings {
    let shows_classic = matches!(settings.view, View::Classic | View::Compare);
    let classic = shows_classic.then(|| actor.classic_certificate(frame.lambda));
    let is_faulty = classic.as_ref().is_some_and(|found| !found.certified());
    Findings {
        growth: (settings.view != View::Classic).then(|| actor.certificate(frame.mix)),
        classic,
        faulty: is_faulty.then(|| actor.classic_faults(frame.lambda)),
    }
}

impl Take {
    /// Gives the film its name, and writes `beside` to its [`sidecar`]. Returns both paths.
    ///
    /// # Errors
    /// [`Error::File`] where the system refuses; neither is there then.
    pub fn keep(self, beside: &impl Serialize) -> Result<[PathBuf; 2]> {
        let Self { path, whole, .. } = self;
        let sidecar = sidecar(&path);
        let mut text =
            serde_json::to_vec_pretty(beside).map_err(|e| Error::Fault(format!("the film's account to JSON: {e}")))?;
        text.push(b'\n');
        let refused = |source| Error::writing(&sidecar, source);
        // On the disk before the film takes its name: after that nothing can fail for want of room.
        let (folder, builder) = crate::file::beside(&sidecar);
        let mut temporary = builder.tempfile_in(folder).map_err(refused)?;
        temporary.write_all(&text).map_err(refused)?;
        whole.name()?;
        temporary.persist(&sidecar).map_err(|error| refused(error.error))?;
        Ok([path, sidecar])
    }
}
