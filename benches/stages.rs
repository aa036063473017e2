//! Time of each stage at 32, 64 and 128 cells: one group per stage, then how they compare.
//!
//! `cargo bench --bench stages`, a filter as for any criterion bench: `cargo bench --bench stages -- certificate`.
#![expect(clippy::print_stdout, reason = "the ratios are what the bench is for")]

mod common;

use std::{
    cell::{LazyCell, RefCell},
    hint::black_box,
    time::{Duration, Instant},
};

use bevy::prelude::World;
use common::{RESOLUTIONS, Subject, Table, human_seconds};
use criterion::{BenchmarkId, Criterion};
use glam::{Mat3A, Quat, Vec3A};
use homunculus::{
    certificate::{Surfaces, certify},
    collision::{
        Asked, Contacts, Growth, Problem, contact_step, global_step, grow, guard_step, local_step,
        plugin::{CollisionProblem, Growing, Rotations, Warped},
    },
    edge::EdgeSolver,
    run::{Domain, solver},
    schedule::Solve,
    settings::Settings,
    voxel::{Complex, plugin::Lattice, voxelize},
};

/// Median seconds by stage, case and resolution.
#[derive(Default)]
struct Medians(RefCell<Vec<(&'static str, &'static str, u32, f64)>>);

impl Medians {
    fn of(&self, stage: &str, case: &str, resolution: u32) -> Option<f64> {
        self.0.borrow().iter().find(|m| (m.0, m.1, m.2) == (stage, case, resolution)).map(|m| m.3)
    }
}

/// Where a bench writes to.
struct Bench<'a> {
    criterion: &'a mut Criterion,
    medians: &'a Medians,
    resolution: u32,
}

impl Bench<'_> {
    /// Measures `routine` alone, on what `prepare` makes anew for each run.
    fn measure<S, T>(
        &mut self,
        stage: &'static str,
        case: &'static str,
        prepare: impl Fn() -> S,
        routine: impl Fn(&mut S) -> T,
    ) {
        let mut samples = Vec::new();
        let mut group = self.criterion.benchmark_group(stage);
        group.sample_size(10).warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(2));
        group.bench_function(BenchmarkId::new(case, self.resolution), |bencher| {
            bencher.iter_custom(|runs| {
                let mut total = Duration::ZERO;
                for _ in 0..runs {
                    let mut state = prepare();
                    let start = Instant::now();
                    black_box(routine(&mut state));
                    total += start.elapsed();
                }
                samples.push(total.as_secs_f64() / runs as f64);
                total
            });
        });
        group.finish();
        samples.sort_unstable_by(f64::total_cmp);
        if let Some(&median) = samples.get(samples.len() / 2) {
            self.medians.0.borrow_mut().push((stage, case, self.resolution, median));
        }
    }
}

/// The collision optimization in the middle of the growth, about to make its first iteration at a new λ.
struct Midway {
    problem: Problem,
    asked: Asked,
    positions: Vec<Vec3A>,
    rotations: Vec<Quat>,
    surfaces: Surfaces,
}

impl Midway {
    fn new(subject: &Subject, resolution: u32) -> Self {
        let mut app = solver(None);
        let world = app.world_mut();
        let settings = Settings { resolution, fidelity: 0.5, keys: 8, reference: None };
        let domain = Domain::body(subject.boundary.clone().into(), subject.importance(&[]).into(), settings);
        let entity = domain.spawn(world);
        let is_midway = |world: &World| {
            world.get::<Growing>(entity).is_some_and(|Growing(g): &Growing| g.lambda() >= 0.5 && g.is_new_step())
        };
        while !is_midway(world) {
            world.run_schedule(Solve);
        }
        let entity = &mut world.entity_mut(entity);
        let lambda = entity.get::<Growing>().map_or(0.5, |Growing(g): &Growing| Growth::lambda(g));
        let (Some(Lattice(complex)), Some(Rotations(rotations)), Some(Warped(positions))) =
            (entity.get(), entity.get(), entity.get())
        else {
            panic!("a growing domain lacks a component");
        };
        let CollisionProblem(problem) = entity.get().expect("a problem");
        Self {
            asked: grow(complex, problem, lambda),
            problem: problem.clone(),
            positions: positions.clone(),
            rotations: rotations.clone(),
            surfaces: entity.get::<Surfaces>().expect("surfaces").clone(),
        }
    }

    fn local(&self, complex: &Complex, rotations: &mut Vec<Quat>) -> Vec<Mat3A> {
        let mut targets = Vec::new();
        local_step(complex, &self.problem, &self.asked, &self.positions, rotations, &mut targets);
        targets
    }

    fn contact(&self, complex: &Complex) -> Contacts {
        contact_step(complex, &self.problem, &self.asked, &self.positions)
    }

    fn global(&self, complex: &Complex, targets: &[Mat3A], contacts: &Contacts) -> Vec<Vec3A> {
        global_step(complex, &self.problem, &self.positions, targets, contacts).0
    }
}

fn measure_all(bench: &mut Bench, subject: &Subject) {
    let resolution = bench.resolution;
    bench.measure("voxel", "voxelize", || (), |()| voxelize(&subject.boundary, resolution));
    let complex = &voxelize(&subject.boundary, resolution).expect("a lattice");
    bench.measure("importance", "spread", || (), |()| subject.node_importance(complex, &[]));
    measure_edge(bench, subject, complex);

    let midway = &LazyCell::new(|| Midway::new(subject, resolution));
    measure_collision(bench, complex, midway);
    for (case, with_surface) in [("skin", false), ("skin + surface", true)] {
        bench.measure(
            "certificate",
            case,
            || midway.surfaces.clone(),
            |surfaces| certify(complex, surfaces.all_if(with_surface), &midway.positions),
        );
    }
}

fn measure_edge(bench: &mut Bench, subject: &Subject, complex: &Complex) {
    let importance = &LazyCell::new(|| subject.node_importance(complex, &[]));
    let cold = || {
        let (mut solver, mut linear) = (EdgeSolver::new(complex), complex.rest.clone());
        solver.solve(complex, importance, &mut linear);
        (solver, linear)
    };
    bench.measure("edge", "cold", || LazyCell::force(importance), |_| cold());
    let painted = &LazyCell::new(|| (cold(), subject.node_importance(complex, &[subject.dab()])));
    bench.measure("edge", "dab", || painted.0.clone(), |(solver, linear)| solver.solve(complex, &painted.1, linear));
}

fn measure_collision(bench: &mut Bench, complex: &Complex, midway: &LazyCell<Midway, impl FnOnce() -> Midway>) {
    let rotations = || midway.rotations.clone();
    bench.measure("collision", "local", rotations, |rotations| midway.local(complex, rotations));
    bench.measure("collision", "contact", || LazyCell::force(midway), |midway| midway.contact(complex));
    let forces = &LazyCell::new(|| (midway.local(complex, &mut rotations()), midway.contact(complex)));
    bench.measure(
        "collision",
        "global",
        || LazyCell::force(forces),
        |(targets, contacts)| midway.global(complex, targets, contacts),
    );
    let proposed = &LazyCell::new(|| midway.global(complex, &forces.0, &forces.1));
    let state = || (midway.rotations.clone(), midway.positions.clone(), midway.surfaces.clone());
    bench.measure(
        "collision",
        "guard",
        || (state(), LazyCell::force(proposed).clone()),
        |((_, positions, surfaces), proposed)| {
            guard_step(
                complex,
                &midway.asked,
                surfaces.skin_alone(),
                positions,
                std::mem::take(proposed),
                &mut Vec::new(),
            )
        },
    );
    bench.measure("collision", "iteration", state, |(rotations, positions, surfaces)| {
        let targets = midway.local(complex, rotations);
        let contacts = midway.contact(complex);
        let proposed = midway.global(complex, &targets, &contacts);
        guard_step(complex, &midway.asked, surfaces.skin_alone(), positions, proposed, &mut Vec::new())
    });
}

/// A ratio worth knowing: its name, and stage and case over and under the line.
type Ratio = (&'static str, [&'static str; 2], [&'static str; 2]);

const RATIOS: [Ratio; 8] = [
    ("Eq. 1 after a dab / cold", ["edge", "dab"], ["edge", "cold"]),
    ("Eq. 1 cold / voxelization", ["edge", "cold"], ["voxel", "voxelize"]),
    ("local / iteration", ["collision", "local"], ["collision", "iteration"]),
    ("contact / iteration", ["collision", "contact"], ["collision", "iteration"]),
    ("global / iteration", ["collision", "global"], ["collision", "iteration"]),
    ("guard / iteration", ["collision", "guard"], ["collision", "iteration"]),
    ("certificate, skin / iteration", ["certificate", "skin"], ["collision", "iteration"]),
    ("certificate, skin + surface / iteration", ["certificate", "skin + surface"], ["collision", "iteration"]),
];

fn print_summary(medians: &Medians, nodes: &[usize]) {
    let heads = || RESOLUTIONS.iter().map(|r| r.to_string());
    let or_dash = |value: Option<String>| value.unwrap_or_else(|| "–".into());

    let mut times = Table::new("median time at", heads());
    let mut growth = Table::new("growth of cost from", RESOLUTIONS.windows(2).map(|r| format!("{} to {}", r[0], r[1])));
    growth.row("nodes", nodes.windows(2).map(|n| format!("{:.2}×", n[1] as f64 / n[0] as f64)));
    let mut seen = Vec::new();
    for &(stage, case, ..) in medians.0.borrow().iter() {
        if seen.contains(&(stage, case)) {
            continue;
        }
        seen.push((stage, case));
        let at = |resolution| medians.of(stage, case, resolution);
        let name = format!("{stage}: {case}");
        times.row(&name, RESOLUTIONS.iter().map(|&r| or_dash(at(r).map(human_seconds))));
        let grown = |r: &[u32]| Some(format!("{:.2}×", at(r[1])? / at(r[0])?));
        growth.row(&name, RESOLUTIONS.windows(2).map(|r| or_dash(grown(r))));
    }

    let mut ratios = Table::new("ratio at", heads());
    for (name, over, under) in RATIOS {
        let ratio = |r| Some(format!("{:.3}", medians.of(over[0], over[1], r)? / medians.of(under[0], under[1], r)?));
        ratios.row(name, RESOLUTIONS.iter().map(|&r| or_dash(ratio(r))));
    }
    println!("\n{times}\n{ratios}\n{growth}");
}

fn main() {
    let subject = Subject::new();
    let medians = Medians::default();
    let mut criterion = Criterion::default().configure_from_args();
    let mut nodes = Vec::new();
    for resolution in RESOLUTIONS {
        nodes.push(voxelize(&subject.boundary, resolution).expect("a lattice").nodes());
        measure_all(&mut Bench { criterion: &mut criterion, medians: &medians, resolution }, &subject);
    }
    criterion.final_summary();
    print_summary(&medians, &nodes);
}
