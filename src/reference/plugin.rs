//! Runs a reference solver in place of the collision optimization, certifying what it gives like anything else.

use bevy::prelude::*;
use glam::Vec3A;

use super::{ITERATIONS, Reading, fig5};
use crate::{
    certificate::{Surfaces, certify},
    collision::{
        Growth, Problem,
        plugin::{CollisionProblem, Growing, Warped},
    },
    diagnostics::Stopwatch,
    edge::plugin::LinearSolution,
    film::{Film, Keyframe, plugin::Reel},
    importance::plugin::Importance,
    schedule::{Failed, Solve, Stage},
    settings::{Reference, Settings},
    voxel::{Complex, blend, plugin::Lattice},
};

/// Iterations done so far.
#[derive(Component, Debug, Default)]
pub struct ReferenceIterations(pub usize);

/// Iterations per run of the schedule: often enough to see progress and to stop.
const ITERATIONS_PER_RUN: usize = 10;

/// Adds the reference solver in the places of the stages it replaces.
pub struct ReferencePlugin(pub Reference);

impl Plugin for ReferencePlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Solve, start.in_set(Stage::Grow));
        match self.0 {
            Reference::Eq1 => app.add_systems(Solve, scale.in_set(Stage::Global)),
            Reference::Fig5 => app.add_systems(Solve, project.in_set(Stage::Global)),
        };
    }
}

type New = (With<LinearSolution>, Without<Growing>, Without<Failed>);

fn start(mut commands: Commands, lattices: Query<(Entity, &Settings, &Lattice, &Importance), New>) {
    for (entity, settings, Lattice(complex), importance) in &lattices {
        commands.entity(entity).insert((
            CollisionProblem(Problem::new(complex, &importance.nodes, settings.fidelity)),
            Growing(Growth::plan(settings.keys, 1.0, 1.0)),
            Warped(complex.rest.clone()),
            ReferenceIterations::default(),
            Reel::default(),
        ));
    }
}

fn scale(
    mut domains: Query<(&Settings, &Lattice, &LinearSolution, &mut Growing, &mut Warped, &Surfaces, &mut Reel)>,
    mut watch: ResMut<Stopwatch>,
) {
    for (settings, Lattice(complex), linear, mut growing, mut warped, surfaces, mut reel) in &mut domains {
        for k in 0..=settings.keys {
            let lambda = k as f32 / settings.keys.max(1) as f32;
            warped.0 = blend(&complex.rest, &linear.0, lambda);
            keep(complex, surfaces, &mut reel.0, lambda, &warped.0, &mut watch);
        }
        growing.0.finish();
    }
}

type Projected<'a> = (
    &'a Settings,
    &'a Lattice,
    &'a LinearSolution,
    &'a CollisionProblem,
    &'a mut Growing,
    &'a mut Warped,
    &'a Surfaces,
    &'a mut Reel,
    &'a mut ReferenceIterations,
);

fn project(mut domains: Query<Projected>, mut watch: ResMut<Stopwatch>) {
    for (settings, Lattice(complex), linear, problem, mut growing, mut warped, surfaces, mut reel, mut done) in
        &mut domains
    {
        let keys = settings.keys.max(1);
        if done.0 == 0 {
            keep(complex, surfaces, &mut reel.0, 0.0, &complex.rest, &mut watch);
        }
        for _ in 0..ITERATIONS_PER_RUN {
            let lambda = done.0 as f32 / (ITERATIONS - 1) as f32;
            warped.0 = watch.time("fig5", || iterate(complex, &problem.0, &linear.0, lambda, &warped.0));
            done.0 += 1;
            let key = done.0 * keys / ITERATIONS;
            if key > (done.0 - 1) * keys / ITERATIONS {
                keep(complex, surfaces, &mut reel.0, key as f32 / keys as f32, &warped.0, &mut watch);
            }
        }
        if done.0 >= ITERATIONS {
            growing.0.finish();
        }
    }
}

fn iterate(complex: &Complex, problem: &Problem, linear: &[Vec3A], lambda: f32, x: &[Vec3A]) -> Vec<Vec3A> {
    fig5(complex, problem, linear, Reading::Sensible, lambda, x)
}

fn keep(
    complex: &Complex,
    surfaces: &Surfaces,
    film: &mut Film,
    lambda: f32,
    positions: &[Vec3A],
    watch: &mut Stopwatch,
) {
    let certificate = watch.time("certificate", || certify(complex, surfaces, positions));
    film.push(Keyframe { lambda, positions: positions.to_vec(), certificate, motion_is_proven: false });
}
