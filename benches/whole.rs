//! The whole warp against the paper's scheme (Fig. 5, 1000 iterations) in the same run, each once.
//!
//! `cargo bench --bench whole`, or with resolutions of your own: `cargo bench --bench whole -- 32 64`. Above 64 cells the
//! reference is extrapolated from 100 iterations, and the table says so; `HOMUNCULUS_FULL=1` runs all of them.
#![expect(clippy::print_stdout, reason = "the tables are what the bench is for")]

mod common;

use std::{
    sync::atomic::{AtomicUsize, Ordering},
    time::Instant,
};

use common::{Subject, Table, human_seconds, resolutions};
use homunculus::{
    collision::Problem,
    diagnostics::{human_bytes, peak_memory_bytes},
    edge::EdgeSolver,
    reference::{ITERATIONS, Reading, fig5},
    run::warp,
    run::{Observer, Outcome, Progress},
    settings::{Reference, Settings},
    voxel::voxelize,
};

/// μ where nothing else is said.
const FIDELITY: f32 = 0.5;

/// Fidelity is judged at this resolution.
const JUDGED: u32 = 64;

/// The reference is run in full up to this resolution: above it takes minutes.
const FULL_UP_TO: u32 = 64;

/// Iterations that stand for all of them above [`FULL_UP_TO`]. λ goes from 0 to 1 over them too, so that contacts, which
/// cost more the further the growth is, have the same share.
const SAMPLED_ITERATIONS: usize = 100;

/// Counts iterations: those of the growth, and those of the settling at λ = 1.
#[derive(Default)]
struct Counter {
    growth: AtomicUsize,
    settling: AtomicUsize,
}

impl Observer for Counter {
    fn progress(&self, p: &Progress) {
        match p.stage {
            "growth" => self.growth.fetch_add(1, Ordering::Relaxed),
            "settling" => self.settling.fetch_add(1, Ordering::Relaxed),
            _ => 0,
        };
    }
    fn cancelled(&self) -> bool {
        false
    }
}

/// Wall time, and time of all threads together where the system tells: the one to look at where others compute too.
#[derive(Clone, Copy)]
struct Cost {
    wall: f64,
    cpu: Option<f64>,
}

impl Cost {
    fn of<T>(work: impl FnOnce() -> T) -> (T, Self) {
        let (start, cpu_before) = (Instant::now(), cpu_seconds());
        let result = work();
        let cpu = cpu_before.zip(cpu_seconds()).map(|(before, after)| after - before);
        (result, Self { wall: start.elapsed().as_secs_f64(), cpu })
    }

    fn plus(self, factor: f64, other: Self) -> Self {
        let cpu = self.cpu.zip(other.cpu).map(|(a, b)| a + factor * b);
        Self { wall: self.wall + factor * other.wall, cpu }
    }
}

/// User and system time of this process from Linux' `/proc/self/stat`, which counts in hundredths.
fn cpu_seconds() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    // Fields after the command's name, which may hold spaces: the state is the first, times are the 12th and 13th.
    let fields: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    let ticks: u64 = fields.get(11)?.parse::<u64>().ok()? + fields.get(12)?.parse::<u64>().ok()?;
    Some(ticks as f64 / 100.0)
}

/// One resolution, both ways.
struct Comparison {
    resolution: u32,
    ours: Outcome,
    cost: Cost,
    iterations: [usize; 2],
    peak_memory: Option<u64>,
    reference: Timed,
}

/// The reference.
struct Timed {
    cost: Cost,
    extrapolated: bool,
    /// Inverted elements and crossings at the end, where it was run to the end.
    faults: Option<[usize; 2]>,
}

fn run(subject: &Subject, resolution: u32, fidelity: f32, reference: Option<Reference>) -> (Outcome, Cost, [usize; 2]) {
    let settings = Settings { resolution, fidelity, keys: 8, reference };
    let (importance, counter) = (subject.importance(&[]), Counter::default());
    let (outcome, cost) = Cost::of(|| warp(&subject.boundary, &importance, &settings, &counter).expect("a warp"));
    (outcome, cost, [counter.growth.into_inner(), counter.settling.into_inner()])
}

fn compare(subject: &Subject, resolution: u32) -> Comparison {
    eprintln!("warping at {resolution} cells");
    let (ours, cost, iterations) = run(subject, resolution, FIDELITY, None);
    // Resolutions ascend and ours comes before the reference, so what the process has held at most is of this warp.
    let peak_memory = peak_memory_bytes();
    eprintln!("reference at {resolution} cells");
    let in_full = resolution <= FULL_UP_TO || std::env::var("HOMUNCULUS_FULL").is_ok_and(|v| v == "1");
    let reference = if in_full {
        let (outcome, cost, _) = run(subject, resolution, FIDELITY, Some(Reference::Fig5));
        let certificate = &outcome.certificate;
        let faults = Some([certificate.inverted(), certificate.crossings() + certificate.surface_crossings()]);
        Timed { cost, extrapolated: false, faults }
    } else {
        Timed { cost: extrapolated(subject, resolution), extrapolated: true, faults: None }
    };
    Comparison { resolution, ours, cost, iterations, peak_memory, reference }
}

/// What comes before the iterations, and [`SAMPLED_ITERATIONS`] scaled to all. The reference's own certificates are left
/// out: they are few against the iterations, and leaving them out is in its favour.
fn extrapolated(subject: &Subject, resolution: u32) -> Cost {
    let ((complex, linear, problem), before) = Cost::of(|| {
        let complex = voxelize(&subject.boundary, resolution).expect("a lattice");
        let importance = subject.node_importance(&complex, &[]);
        let mut linear = complex.rest.clone();
        EdgeSolver::new(&complex).solve(&complex, &importance, &mut linear);
        let problem = Problem::new(&complex, &importance, FIDELITY);
        (complex, linear, problem)
    });
    let (x, sampled) = Cost::of(|| {
        (0..SAMPLED_ITERATIONS).fold(complex.rest.clone(), |x, k| {
            let lambda = k as f32 / (SAMPLED_ITERATIONS - 1) as f32;
            fig5(&complex, &problem, &linear, Reading::Sensible, lambda, &x)
        })
    });
    assert!(x.iter().all(|p| p.is_finite()), "the reference diverged: its time would say nothing");
    before.plus(ITERATIONS as f64 / SAMPLED_ITERATIONS as f64, sampled)
}

fn seconds_of(outcome: &Outcome, stage: &str) -> f64 {
    outcome.seconds.iter().filter(|(name, _)| *name == stage).map(|(_, seconds)| seconds).sum()
}

fn all_seconds(outcome: &Outcome) -> f64 {
    outcome.seconds.iter().map(|(_, seconds)| seconds).sum()
}

fn main() {
    let subject = Subject::new();
    let mut resolutions = resolutions();
    resolutions.sort_unstable();
    let all: Vec<Comparison> = resolutions.iter().map(|&r| compare(&subject, r)).collect();
    println!("\n{}, {} threads\n", subject.boundary.name, rayon::current_num_threads());
    print_comparison(&all);
    print_stages(&all);
    print_growth(&all);
    if let Some(judged) = all.iter().find(|c| c.resolution == JUDGED) {
        print_fidelity(&subject, &judged.ours);
    }
}

fn print_comparison(all: &[Comparison]) {
    let mut table = Table::new("whole warp at", all.iter().map(|c| c.resolution.to_string()));
    let mut row = |name: &str, value: &dyn Fn(&Comparison) -> String| table.row(name, all.iter().map(value));
    row("nodes", &|c| c.ours.domain.nodes.to_string());
    row("ours: growth + settling", &|c| format!("{} + {}", c.iterations[0], c.iterations[1]));
    let star = |c: &Comparison| if c.reference.extrapolated { "*" } else { "" };
    let cpu = |cost: Cost| cost.cpu.map_or("–".into(), human_seconds);
    row("ours", &|c| human_seconds(c.cost.wall));
    row("Fig. 5, 1000 iterations", &|c| format!("{}{}", human_seconds(c.reference.cost.wall), star(c)));
    row("Fig. 5 / ours", &|c| format!("{:.1}×", c.reference.cost.wall / c.cost.wall));
    row("ours, all threads", &|c| cpu(c.cost));
    row("Fig. 5, all threads", &|c| format!("{}{}", cpu(c.reference.cost), star(c)));
    row("Fig. 5 / ours, all threads", &|c| {
        let ratio = c.reference.cost.cpu.zip(c.cost.cpu).map(|(theirs, ours)| theirs / ours);
        ratio.map_or("–".into(), |ratio| format!("{ratio:.1}×"))
    });
    row("ours: certified", &|c| c.ours.frames.iter().all(|f| f.certificate.certified()).to_string());
    row("Fig. 5: inverted + crossing", &|c| c.reference.faults.map_or("–".into(), |[i, x]| format!("{i} + {x}")));
    row("certificate / solve", &|c| {
        format!("{:.1} %", 100.0 * seconds_of(&c.ours, "certificate") / all_seconds(&c.ours))
    });
    row("peak memory", &|c| c.peak_memory.map_or("–".into(), |bytes| human_bytes(bytes as f64)));
    println!("{table}");
    if all.iter().any(|c| c.reference.extrapolated) {
        println!("* extrapolated from {SAMPLED_ITERATIONS} iterations; HOMUNCULUS_FULL=1 runs all {ITERATIONS}\n");
    }
}

fn print_stages(all: &[Comparison]) {
    let mut table = Table::new("seconds of ours by stage", all.iter().map(|c| c.resolution.to_string()));
    let Some(last) = all.last() else { return };
    for (stage, _) in &last.ours.seconds {
        table.row(stage, all.iter().map(|c| human_seconds(seconds_of(&c.ours, stage))));
    }
    println!("{table}");
}

fn print_growth(all: &[Comparison]) {
    let pairs = || all.windows(2);
    let mut table = Table::new("growth from", pairs().map(|c| format!("{} to {}", c[0].resolution, c[1].resolution)));
    let mut row = |name: &str, value: &dyn Fn(&Comparison) -> f64| {
        table.row(name, pairs().map(|c| format!("{:.2}×", value(&c[1]) / value(&c[0]))));
    };
    row("nodes", &|c| c.ours.domain.nodes as f64);
    row("ours", &|c| c.cost.wall);
    row("ours, all threads", &|c| c.cost.cpu.unwrap_or(f64::NAN));
    row("Fig. 5", &|c| c.reference.cost.wall);
    row("Fig. 5, all threads", &|c| c.reference.cost.cpu.unwrap_or(f64::NAN));
    for (stage, _) in &all[0].ours.seconds {
        row(&format!("ours: {stage}"), &|c| seconds_of(&c.ours, stage));
    }
    println!("{table}");
}

fn print_fidelity(subject: &Subject, middle: &Outcome) {
    let (high, ..) = run(subject, JUDGED, 0.9, None);
    let mut table = Table::new(
        &format!("at {JUDGED} cells"),
        ["median", "p95", "max", "p95", "p99", "certified"].map(String::from),
    );
    for (name, outcome) in [("μ = 0.5: size error, distortion", middle), ("μ = 0.9: size error, distortion", &high)] {
        let percent = |e: f64| format!("{:.2} %", 100.0 * e);
        let (error, distortion) = (&outcome.fidelity, &outcome.distortion);
        let certified = outcome.frames.iter().all(|f| f.certificate.certified());
        table.row(
            name,
            [
                percent(error.median),
                percent(error.p95),
                percent(error.max),
                format!("{:.3}", distortion.p95),
                format!("{:.3}", distortion.p99),
                certified.to_string(),
            ],
        );
    }
    println!("{table}");
}
