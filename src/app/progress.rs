//! What the user sees while the engine works: a bar on a terminal, lines in a pipe, nothing with `-q`.

use std::io::IsTerminal;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use super::{cancel, note};
use crate::run::{Observer, Progress};

/// Steps of the bar; a thousand is finer than a terminal is wide.
const STEPS: u64 = 1000;

/// In a pipe: a line for each new stage, and one for each further tenth of the work.
const LINES_PER_RUN: f32 = 10.0;

/// A watcher for this run.
pub(super) fn watcher(quiet: bool) -> Watcher {
    let face = if quiet {
        Face::None
    } else if std::io::stderr().is_terminal() {
        let bar = ProgressBar::new(STEPS);
        if let Ok(style) = ProgressStyle::with_template("{prefix:<11} [{bar:20}] {percent:>3} % {wide_msg}") {
            bar.set_style(style);
        }
        Face::Bar(bar)
    } else {
        Face::Lines(Mutex::default())
    };
    Watcher { start: Instant::now(), face }
}

/// Shows progress and passes on the wish to stop.
pub(super) struct Watcher {
    start: Instant,
    face: Face,
}

enum Face {
    None,
    Bar(ProgressBar),
    Lines(Mutex<LastLine>),
}

/// The last line written: its stage and its tenth of the work.
#[derive(Default)]
struct LastLine(&'static str, u32);

impl Watcher {
    /// Takes the bar away.
    pub fn finish(&self) {
        if let Face::Bar(bar) = &self.face {
            bar.finish_and_clear();
        }
    }
}

impl Observer for Watcher {
    fn progress(&self, p: &Progress) {
        match &self.face {
            Face::None => {}
            Face::Bar(bar) => {
                bar.set_prefix(p.stage);
                bar.set_message(details(p, self.start.elapsed()).join(" · "));
                bar.set_position((p.fraction.clamp(0.0, 1.0) * STEPS as f32) as u64);
            }
            Face::Lines(last) => {
                let mut last = last.lock().unwrap_or_else(PoisonError::into_inner);
                let tenth = (p.fraction.clamp(0.0, 1.0) * LINES_PER_RUN) as u32;
                if last.0 != p.stage || last.1 != tenth {
                    *last = LastLine(p.stage, tenth);
                    let percent = p.fraction.clamp(0.0, 1.0) * 100.0;
                    let mut parts = details(p, self.start.elapsed());
                    parts.insert(0, format!("{}: {percent:.0} %", p.stage));
                    note(&parts.join(" · "));
                }
            }
        }
    }

    fn cancelled(&self) -> bool {
        cancel::asked()
    }
}

/// `λ 0.45`, `size error 12.0 %`, `14 s left`, each only where it is known.
fn details(p: &Progress, elapsed: Duration) -> Vec<String> {
    let mut details = Vec::new();
    if p.lambda > 0.0 {
        details.push(format!("λ {:.2}", p.lambda));
    }
    if p.size_error_p95 > 0.0 && p.size_error_p95.is_finite() {
        details.push(format!("size error {:.1} %", p.size_error_p95 * 100.0));
    }
    // Before a twentieth is done a guess at the rest is worth nothing.
    if p.fraction > 0.05 && p.fraction <= 1.0 {
        let left = elapsed.as_secs_f32() * (1.0 - p.fraction) / p.fraction;
        details.push(if left < 90.0 { format!("{left:.0} s left") } else { format!("{:.0} min left", left / 60.0) });
    }
    details
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn says_what_is_known() {
        let progress = |lambda, size_error_p95, fraction| Progress { stage: "x", lambda, size_error_p95, fraction };
        let elapsed = Duration::from_secs(10);
        assert_eq!(details(&progress(0.0, f32::NAN, 0.0), elapsed), [""; 0]);
        assert_eq!(details(&progress(0.5, 0.12, 0.5), elapsed), ["λ 0.50", "size error 12.0 %", "10 s left"]);
        assert_eq!(details(&progress(0.0, 0.0, 0.1), elapsed * 10), ["15 min left"]);
        assert_eq!(details(&progress(f32::NAN, 0.0, f32::NAN), elapsed), [""; 0]);
    }
}
