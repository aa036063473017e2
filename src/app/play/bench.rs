//! `play --bench`: how long frames take at rest and during a solve, how soon a dab is seen, how soon the first picture.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use bevy::prelude::*;
use serde::Serialize;

use super::drawn;
use super::present::Shown;
use super::sandbox::Sandbox;
use crate::app::say;
use crate::paint::{Action, Brush, Dab};
use crate::panel::Wish;
use crate::session::Phase;
use crate::view::Unhurried;

/// What is printed. Milliseconds but where it says otherwise.
#[derive(Debug, Clone, Default, Serialize)]
struct Figures {
    adapter: String,
    triangles: usize,
    /// From the start of the program to the first frame with the body in it.
    first_picture: f64,
    /// To the certified film.
    solved_after: f64,
    /// Cells along the longest side in the frames below.
    resolution: u32,
    idle: Frames,
    /// Dabs included.
    solving: Frames,
    /// p99 of a frame during a solve over that at rest.
    p99_ratio: f64,
    dabs: Vec<Dabs>,
}

/// How soon dabs are seen at one resolution.
#[derive(Debug, Clone, Default, Serialize)]
struct Dabs {
    resolution: u32,
    cells: usize,
    /// From the order to the linear solution.
    median: f64,
    worst: f64,
    /// From the pointer to the frame that shows it, by the length of the frame before.
    shown_median: f64,
    shown_worst: f64,
}

/// Frame times.
#[derive(Debug, Clone, Default, Serialize)]
struct Frames {
    count: usize,
    median: f64,
    p99: f64,
}

impl Frames {
    fn sorted(mut milliseconds: Vec<f64>) -> Vec<f64> {
        milliseconds.sort_unstable_by(f64::total_cmp);
        milliseconds
    }

    fn of(milliseconds: Vec<f64>) -> Self {
        let milliseconds = Self::sorted(milliseconds);
        Self { count: milliseconds.len(), median: quantile(&milliseconds, 0.5), p99: quantile(&milliseconds, 0.99) }
    }
}

fn quantile(sorted: &[f64], q: f64) -> f64 {
    sorted.get(((sorted.len().max(1) - 1) as f64 * q).round() as usize).copied().unwrap_or(0.0)
}

/// What is being measured.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Stage {
    FirstPicture,
    FirstSolve,
    Idle(Instant),
    Solving(Instant),
    /// A lattice of the resolution with this index is being made.
    Refining(usize),
    /// A dab was made when so many had been answered, at the resolution with this index.
    Dab(Instant, u64, usize),
    /// Its linear solution is there, and is to be shown: it will be when so many states have been.
    Showing(Instant, usize, u64),
}

/// A measurement.
#[derive(Resource)]
pub(super) struct Bench {
    seconds: f64,
    json: bool,
    started: Instant,
    stage: Stage,
    last_frame: Option<Instant>,
    frames: Vec<f64>,
    /// Frames since the body is there: the first show nothing yet, as shaders are compiled.
    shown: u32,
    /// Whether the renderer waits for no shader.
    is_drawn: Arc<AtomicBool>,
    dabs: Vec<f64>,
    dabs_shown: Vec<f64>,
    figures: Figures,
}

/// Dabs that are made at each resolution.
const DABS: usize = 12;

/// Resolutions at which dabs are measured.
const RESOLUTIONS: [u32; 2] = [64, 128];

/// Frames after which the renderer, which is one behind, has met the body and asked for its shaders.
const UNTIL_SHOWN: u32 = 3;

impl Bench {
    pub fn new(seconds: f32, json: bool, started: Instant, adapter: String) -> Self {
        Self {
            seconds: seconds.into(),
            json,
            started,
            stage: Stage::FirstPicture,
            last_frame: None,
            frames: Vec::new(),
            shown: 0,
            is_drawn: Arc::default(),
            dabs: Vec::new(),
            dabs_shown: Vec::new(),
            figures: Figures { adapter, ..Figures::default() },
        }
    }
}

/// Measures an app with a window.
pub(super) fn build(app: &mut App, mut bench: Bench) {
    bench.is_drawn = drawn::watch(app);
    app.insert_resource(bench).add_systems(Last, measure);
}

fn measure(
    mut bench: ResMut<Bench>,
    mut sandbox: ResMut<Sandbox>,
    shown: Query<(), With<Shown>>,
    unhurried: Res<Unhurried>,
    mut exit: MessageWriter<AppExit>,
) {
    let bench = &mut *bench;
    let now = Instant::now();
    let frame = bench.last_frame.replace(now).map_or(0.0, |last| (now - last).as_secs_f64() * 1e3);
    let since = |at: Instant| (now - at).as_secs_f64();
    if let Some(problem) = &sandbox.problem {
        say(&format!("nothing was measured: {problem}"));
        exit.write(AppExit::error());
        return;
    }
    match bench.stage {
        Stage::FirstPicture => {
            bench.shown += u32::from(!shown.is_empty());
            if bench.shown > UNTIL_SHOWN && bench.is_drawn.load(Ordering::Relaxed) {
                bench.figures.first_picture = since(bench.started) * 1e3;
                bench.stage = Stage::FirstSolve;
            }
        }
        Stage::FirstSolve if sandbox.snapshot.phase == Phase::Done => {
            bench.figures.solved_after = since(bench.started) * 1e3;
            if let Some(lattice) = &sandbox.snapshot.lattice {
                bench.figures.resolution = lattice.summary.resolution;
                bench.figures.triangles = lattice.boundary.triangles.len();
            }
            bench.stage = Stage::Idle(now);
        }
        Stage::FirstSolve => {}
        Stage::Idle(at) => {
            // The first frames still hold what the end of the solve brought.
            if since(at) > 0.5 {
                bench.frames.push(frame);
            }
            if since(at) > bench.seconds + 0.5 {
                bench.figures.idle = Frames::of(std::mem::take(&mut bench.frames));
                bench.stage = Stage::Solving(now);
            }
        }
        Stage::Solving(at) => {
            if sandbox.snapshot.phase.is_busy() {
                bench.frames.push(frame);
            } else {
                dab(&mut sandbox, bench.frames.len());
            }
            if since(at) > bench.seconds {
                bench.figures.solving = Frames::of(std::mem::take(&mut bench.frames));
                bench.stage = refine(&mut sandbox, 0);
            }
        }
        Stage::Refining(index) => {
            let lattice = sandbox.snapshot.lattice.as_ref();
            if lattice.is_some_and(|lattice| lattice.summary.resolution == RESOLUTIONS[index])
                && sandbox.snapshot.phase == Phase::Done
            {
                bench.stage = begin(&mut sandbox, index, 0);
            }
        }
        Stage::Dab(at, answered, index) => {
            let snapshot = &sandbox.snapshot;
            let Some(milliseconds) = snapshot.dab_milliseconds.filter(|_| snapshot.dabs > answered) else {
                return;
            };
            bench.dabs.push(milliseconds);
            // What is on its way already is older.
            let ahead = 1 + u64::from(unhurried.is_waiting);
            bench.stage = Stage::Showing(at, index, unhurried.shown + ahead);
        }
        Stage::Showing(..) => {}
    }
    if let Stage::Showing(at, index, count) = bench.stage
        && (unhurried.shown >= count || !unhurried.is_waiting)
    {
        bench.dabs_shown.push(since(at) * 1e3 + frame);
        if bench.dabs.len() < DABS {
            bench.stage = begin(&mut sandbox, index, bench.dabs.len());
            return;
        }
        let figures = dabs(&mut bench.dabs, &mut bench.dabs_shown, &sandbox);
        bench.figures.dabs.push(figures);
        if index + 1 < RESOLUTIONS.len() {
            bench.stage = refine(&mut sandbox, index + 1);
            return;
        }
        finish(bench);
        exit.write(AppExit::Success);
    }
}

/// Asks for another resolution.
fn refine(sandbox: &mut Sandbox, index: usize) -> Stage {
    sandbox.wishes.push(Wish::SetResolution(RESOLUTIONS[index]));
    Stage::Refining(index)
}

/// Makes a dab that is measured.
fn begin(sandbox: &mut Sandbox, index: usize, count: usize) -> Stage {
    let (at, answered) = (Instant::now(), sandbox.snapshot.dabs);
    dab(sandbox, count);
    Stage::Dab(at, answered, index)
}

/// What came of the dabs, which are used up.
fn dabs(solved: &mut Vec<f64>, shown: &mut Vec<f64>, sandbox: &Sandbox) -> Dabs {
    let (solved, shown) = (Frames::sorted(std::mem::take(solved)), Frames::sorted(std::mem::take(shown)));
    let mut dabs = Dabs {
        median: quantile(&solved, 0.5),
        worst: quantile(&solved, 1.0),
        shown_median: quantile(&shown, 0.5),
        shown_worst: quantile(&shown, 1.0),
        ..Dabs::default()
    };
    if let Some(lattice) = &sandbox.snapshot.lattice {
        (dabs.resolution, dabs.cells) = (lattice.summary.resolution, lattice.summary.cells);
    }
    dabs
}

/// Paints a dab on a vertex: another one each time.
fn dab(sandbox: &mut Sandbox, count: usize) {
    if let Some(open) = &mut sandbox.open {
        let boundary = open.painting.under().boundary.clone();
        let (low, high) = boundary.bounds().unwrap_or_default();
        let centre = boundary.positions[(count * 7919 + 13) % boundary.positions.len()].to_array();
        // Now more, now less, so that importance stays within what can be reached however long it goes on.
        let action = if count.is_multiple_of(2) { Action::Add } else { Action::Erase };
        open.painting.begin(Brush { action, value: 1.5, strength: 1.0, ..Brush::default() });
        open.painting.dab(Dab { centre, radius: 0.05 * (high - low).max_element() });
        open.painting.end();
    }
}

fn finish(bench: &mut Bench) {
    let figures = &mut bench.figures;
    figures.p99_ratio = figures.solving.p99 / figures.idle.p99.max(1e-9);
    if bench.json
        && let Ok(text) = serde_json::to_string_pretty(figures)
    {
        say(&text);
        return;
    }
    say(&format!(
        "{}: first picture {:.0} ms, solved after {:.1} s; at {} cells a frame at rest {:.1} ms (p99 {:.1}), during a solve \
         {:.1} ms (p99 {:.1}, ×{:.2})",
        figures.adapter,
        figures.first_picture,
        figures.solved_after / 1e3,
        figures.resolution,
        figures.idle.median,
        figures.idle.p99,
        figures.solving.median,
        figures.solving.p99,
        figures.p99_ratio,
    ));
    for Dabs { resolution, median, worst, shown_median, .. } in &figures.dabs {
        say(&format!(
            "a dab at {resolution} cells {median:.0} ms (worst {worst:.0}), shown after {shown_median:.0} ms"
        ));
    }
}
