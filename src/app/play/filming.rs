//! Films of what is open, shot beside the window: frame after frame, as long as it takes.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use image::RgbaImage;

use super::results::Order;
use crate::certificate::Surfaces;
use crate::film::{Film, Keyframe};
use crate::record::{self, Actor, Camera, Draft, Settings};
use crate::run::{Observer, Outcome, Progress, Solved};
use crate::session::Lattice;
use crate::view::Orbit;
use crate::{Error, Result};

/// Longest side of the preview, pixels: what the dialog has room for, twice as fine for screens that are.
const PREVIEW: u32 = 700;

/// Longest wait for a film to let go of its file when the program ends.
const LETTING_GO: Duration = Duration::from_secs(10);

/// A film that is being shot.
pub struct Filming {
    /// Where it will lie.
    pub path: PathBuf,
    /// Frames it will have.
    pub frames: usize,
    started: Instant,
    shared: Arc<Shared>,
}

/// What its thread tells, and is told.
#[derive(Default)]
struct Shared {
    drawn: AtomicUsize,
    preview: Mutex<Option<Arc<RgbaImage>>>,
    is_stopped: AtomicBool,
    has_ended: AtomicBool,
}

/// What is left to do on a thread of its own.
pub(super) struct Shooting {
    order: Order,
    settings: Settings,
    shared: Arc<Shared>,
}

impl Filming {
    /// Checks what is wanted; the film is shot by whoever runs the second half.
    ///
    /// # Errors
    /// As [`Settings::new`] and [`Format::of`](record::encode::Format::of).
    pub(super) fn begin(order: Order, draft: &Draft) -> Result<(Self, Shooting)> {
        // A picture is looked at straight on.
        let turntable = if order.subject.kind().is_flat() { 0.0 } else { draft.turntable };
        let camera = camera(&order.seen_from);
        let settings = Settings::new(Draft { camera, turntable, still: None, ..draft.clone() })?;
        order.check()?;
        // Whether this machine can is asked where the film is shot: drivers and programs take their time to answer.
        record::encode::Format::of(&order.path, false)?;
        let shared = Arc::new(Shared::default());
        let filming = Self {
            path: order.path.clone(),
            frames: settings.frames(),
            started: Instant::now(),
            shared: shared.clone(),
        };
        Ok((filming, Shooting { order, settings, shared }))
    }

    /// Frames that are drawn.
    pub fn drawn(&self) -> usize {
        self.shared.drawn.load(Ordering::Relaxed)
    }

    /// How long it will take from here, as far as one can tell.
    pub fn left(&self) -> Option<Duration> {
        let drawn = self.drawn();
        let each = self.started.elapsed().checked_div(u32::try_from(drawn).ok()?)?;
        Some(each * u32::try_from(self.frames.saturating_sub(drawn)).ok()?)
    }

    /// The last frame, small.
    pub fn preview(&self) -> Option<Arc<RgbaImage>> {
        self.shared.preview.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Stops it after the frame that is being drawn; nothing is left of it.
    pub fn stop(&self) {
        self.shared.is_stopped.store(true, Ordering::Relaxed);
    }

    /// Waits until it has let go of its file, but not for ever.
    pub(super) fn stop_and_wait(&self) {
        self.stop();
        let start = Instant::now();
        while !self.shared.has_ended.load(Ordering::Relaxed) && start.elapsed() < LETTING_GO {
            std::thread::sleep(Duration::from_millis(5));
        }
    }
}

impl Shooting {
    /// Shoots the film; where it lies, and whether all it shows is certified.
    ///
    /// # Errors
    /// As [`record::shoot`]; [`Error::Cancelled`] if it was stopped.
    pub fn run(self) -> Result<(PathBuf, bool)> {
        let _end = End(self.shared.clone());
        self.shoot()
    }

    fn shoot(&self) -> Result<(PathBuf, bool)> {
        let order = &self.order;
        let mut actor = Actor::new(order.lattice.boundary.clone(), solved(order)?);
        let take = record::shoot(&mut actor, &self.settings, &order.path, &Watch(&self.shared), |picture| {
            let preview = Arc::new(shrunk(picture));
            *self.shared.preview.lock().unwrap_or_else(PoisonError::into_inner) = Some(preview);
            self.shared.drawn.fetch_add(1, Ordering::Relaxed);
        })?;
        let certified = take.account.certified;
        let beside = serde_json::json!({
            "film": order.path.file_name().map(|name| name.to_string_lossy()),
            "version": env!("CARGO_PKG_VERSION"),
            "seed": null,
            "scene": &*order.scene,
            "recording": &take.account,
            "report": order.report(),
        });
        take.keep(&beside)?;
        Ok((order.path.clone(), certified))
    }
}

/// Tells that a film has ended, however it did.
struct End(Arc<Shared>);

impl Drop for End {
    fn drop(&mut self) {
        self.0.has_ended.store(true, Ordering::Relaxed);
    }
}

/// Stops a film.
struct Watch<'a>(&'a Shared);

impl Observer for Watch<'_> {
    fn progress(&self, _: &Progress) {}

    fn cancelled(&self) -> bool {
        self.0.is_stopped.load(Ordering::Relaxed)
    }
}

/// From where the view stands, as the recorder says it; it fits the growth into the picture by itself.
fn camera(from: &Orbit) -> Camera {
    let turn = from.yaw.to_degrees().rem_euclid(360.0);
    Camera { yaw: turn, pitch: from.pitch.to_degrees().clamp(-89.0, 89.0), zoom: 1.0 }
}

fn shrunk(picture: &RgbaImage) -> RgbaImage {
    let (width, height) = picture.dimensions();
    let longest = width.max(height);
    if longest <= PREVIEW {
        return picture.clone();
    }
    let side = |side: u32| (side * PREVIEW / longest).max(1);
    image::imageops::thumbnail(picture, side(width), side(height))
}

/// The session's result as the recorder takes it.
fn solved(order: &Order) -> Result<Solved> {
    let snapshot = &order.snapshot;
    let Some((linear, importance)) = snapshot.linear.as_ref().zip(snapshot.importance.as_ref()) else {
        return Err(Error::Fault("a solve that is done lacks its linear solution".into()));
    };
    let Lattice { boundary, complex, binding, .. } = order.lattice.clone();
    let surfaces = Surfaces::new(&boundary, binding.clone(), &complex);
    let mut film = Film::default();
    for state in &snapshot.film {
        let (positions, certificate) = ((*state.positions).clone(), state.certificate.clone());
        film.push(Keyframe { lambda: state.lambda, positions, certificate, motion_is_proven: false });
    }
    let (linear, importance) = ((**linear).clone(), (**importance).clone());
    let outcome = Outcome::clone(&order.outcome);
    Ok(Solved { boundary, complex, binding, surfaces, film, linear, importance, outcome })
}

/// What has become of a film, in one line.
pub(super) fn told(path: &Path, certified: bool) -> String {
    let verdict = match certified {
        true => "the growth is certified in every frame",
        false => "the growth is not certified in every frame",
    };
    format!("Recorded {}: {verdict}.", path.display())
}
