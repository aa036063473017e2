//! `play --bench`: how long frames take at rest and during a solve, how soon a dab is seen, how soon the first picture.

use std::time::Instant;

use bevy::prelude::*;
use serde::Serialize;

use super::present::Shown;
use super::sandbox::Sandbox;
use crate::app::say;
use crate::paint::{Action, Brush, Dab};
use crate::session::Phase;

/// What is printed. Milliseconds but where it says otherwise.
#[derive(Debug, Clone, Default, Serialize)]
struct Figures {
    adapter: String,
    resolution: u32,
    cells: usize,
    first_picture: f64,
    solved_after: f64,
    idle: Frames,
    solving: Frames,
    /// p99 of a frame during a solve over that at rest.
    p99_ratio: f64,
    /// From a dab to its linear solution.
    dab_median: f64,
    dab_worst: f64,
    /// From a dab to the frame that shows it.
    dab_shown_median: f64,
}

/// Frame times.
#[derive(Debug, Clone, Default, Serialize)]
struct Frames {
    count: usize,
    median: f64,
    p99: f64,
}

impl Frames {
    fn of(mut milliseconds: Vec<f64>) -> Self {
        milliseconds.sort_unstable_by(f64::total_cmp);
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
    /// A dab was made in that version of the painting; the snapshot before it.
    Dab(Instant, u64),
    Solving(Instant),
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
    dabs: Vec<f64>,
    dabs_shown: Vec<f64>,
    figures: Figures,
}

/// Dabs that are made.
const DABS: usize = 10;

/// Frames after which the first picture is on the screen: the renderer is one behind.
const UNTIL_SHOWN: u32 = 2;

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
            dabs: Vec::new(),
            dabs_shown: Vec::new(),
            figures: Figures { adapter, ..Figures::default() },
        }
    }
}

/// Measures an app with a window.
pub(super) fn build(app: &mut App, bench: Bench) {
    app.insert_resource(bench).add_systems(Last, measure);
}

fn measure(
    mut bench: ResMut<Bench>,
    mut sandbox: ResMut<Sandbox>,
    shown: Query<(), With<Shown>>,
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
            if bench.shown > UNTIL_SHOWN {
                bench.figures.first_picture = since(bench.started) * 1e3;
                bench.stage = Stage::FirstSolve;
            }
        }
        Stage::FirstSolve if sandbox.snapshot.phase == Phase::Done => {
            bench.figures.solved_after = since(bench.started) * 1e3;
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
                bench.stage = dab(&mut sandbox, bench.dabs.len());
            }
        }
        Stage::Dab(at, version) => {
            let snapshot = &sandbox.snapshot;
            let Some(milliseconds) =
                snapshot.dab_milliseconds.filter(|_| snapshot.version > version && !snapshot.film_is_current)
            else {
                return;
            };
            bench.dabs.push(milliseconds);
            bench.dabs_shown.push(since(at) * 1e3 + frame);
            bench.stage =
                if bench.dabs.len() < DABS { dab(&mut sandbox, bench.dabs.len()) } else { Stage::Solving(now) };
        }
        Stage::Solving(at) => {
            if sandbox.snapshot.phase.is_busy() {
                bench.frames.push(frame);
            } else {
                dab(&mut sandbox, bench.frames.len());
            }
            if since(at) > bench.seconds {
                bench.figures.solving = Frames::of(std::mem::take(&mut bench.frames));
                finish(bench, &sandbox);
                exit.write(AppExit::Success);
            }
        }
    }
}

/// Paints a dab on a vertex: another one each time.
fn dab(sandbox: &mut Sandbox, count: usize) -> Stage {
    let version = sandbox.snapshot.version;
    if let Some(open) = &mut sandbox.open {
        let boundary = open.painting.under().boundary.clone();
        let (low, high) = boundary.bounds().unwrap_or_default();
        let centre = boundary.positions[(count * 7919 + 13) % boundary.positions.len()].to_array();
        open.painting.begin(Brush { action: Action::Add, value: 1.5, strength: 1.0, ..Brush::default() });
        open.painting.dab(Dab { centre, radius: 0.05 * (high - low).max_element() });
        open.painting.end();
    }
    Stage::Dab(Instant::now(), version)
}

fn finish(bench: &mut Bench, sandbox: &Sandbox) {
    let figures = &mut bench.figures;
    if let Some(lattice) = &sandbox.snapshot.lattice {
        (figures.resolution, figures.cells) = (lattice.summary.resolution, lattice.summary.cells);
    }
    bench.dabs.sort_unstable_by(f64::total_cmp);
    bench.dabs_shown.sort_unstable_by(f64::total_cmp);
    figures.dab_median = quantile(&bench.dabs, 0.5);
    figures.dab_worst = quantile(&bench.dabs, 1.0);
    figures.dab_shown_median = quantile(&bench.dabs_shown, 0.5);
    figures.p99_ratio = figures.solving.p99 / figures.idle.p99.max(1e-9);
    if bench.json
        && let Ok(text) = serde_json::to_string_pretty(figures)
    {
        say(&text);
        return;
    }
    say(&format!(
        "{} at {} cells: first picture {:.0} ms, solved after {:.1} s; frame at rest {:.1} ms (p99 {:.1}), during a solve \
         {:.1} ms (p99 {:.1}, ×{:.2}); dab {:.0} ms (worst {:.0}), shown after {:.0} ms",
        figures.adapter,
        figures.resolution,
        figures.first_picture,
        figures.solved_after / 1e3,
        figures.idle.median,
        figures.idle.p99,
        figures.solving.median,
        figures.solving.p99,
        figures.p99_ratio,
        figures.dab_median,
        figures.dab_worst,
        figures.dab_shown_median,
    ));
}
