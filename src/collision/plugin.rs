//! Grow, local, contact, global, guard: one iteration of the collision optimization per run of the schedule.

use bevy::prelude::*;
use glam::{Mat3A, Quat, Vec3A};

use super::{
    Asked, Contacts, Growth, Guarded, Problem, Shell, contact_step, global_step, grow, guard_step, local_step,
};
use crate::{
    diagnostics::Stopwatch,
    edge::plugin::LinearSolution,
    importance::plugin::Importance,
    schedule::{Domain, Solve, Stage},
    voxel::plugin::Lattice,
};

/// What the collision optimization of a domain is about.
#[derive(Component, Debug)]
pub struct CollisionProblem(pub Problem);

/// Where its growth is.
#[derive(Component, Debug)]
pub struct Growing(pub Growth);

/// Sizes and radii asked for at the present λ.
#[derive(Component, Debug, Default)]
pub struct Sizes(pub Asked);

/// `[cells]` R_c.
#[derive(Component, Debug, Default)]
pub struct Rotations(pub Vec<Quat>);

/// `[cells]` A_c.
#[derive(Component, Debug, Default)]
pub struct Targets(pub Vec<Mat3A>);

/// Pairs of boundary nodes that are too close.
#[derive(Component, Debug, Default)]
pub struct Touching(pub Contacts);

/// `[nodes]` where the global step would like to go.
#[derive(Component, Debug, Default)]
pub struct Proposed(pub Vec<Vec3A>);

/// V'', `[nodes]`, in cells: always a valid state.
#[derive(Component, Debug)]
pub struct Warped(pub Vec<Vec3A>);

/// Surfaces that must not cross: the complex's skin first.
#[derive(Component, Debug)]
pub struct Shells(pub Vec<Shell>);

/// Whether the boundary as it will be written is guarded in every iteration, and not only when a keyframe is made: once
/// it had to be drawn back, it will have to be again, and small holds are better than large ones.
#[derive(Component, Debug, Default)]
pub struct BoundaryAtRisk(pub bool);

/// `[nodes]` how often the guard halved each node's last step.
#[derive(Component, Debug, Default)]
pub struct Holds(pub Vec<u8>);

/// What the guard held back in the last iteration.
#[derive(Component, Debug, Default)]
pub struct HeldBack(pub Guarded);

/// Adds the stages.
pub struct CollisionPlugin;

impl Plugin for CollisionPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(
            Solve,
            (
                (start, grow_sizes).chain().in_set(Stage::Grow),
                fit_cells.in_set(Stage::Local),
                find_contacts.in_set(Stage::Contact),
                propose.in_set(Stage::Global),
                accept.in_set(Stage::Guard),
            ),
        );
    }
}

type New = (With<LinearSolution>, Without<Growing>);

fn start(
    mut commands: Commands,
    lattices: Query<(Entity, &Domain, &Lattice, &Importance), New>,
    mut watch: ResMut<Stopwatch>,
) {
    for (entity, domain, Lattice(complex), importance) in &lattices {
        let problem = watch.time("grow", || Problem::new(complex, &importance.nodes, domain.settings.fidelity));
        let growth = Growth::of(domain.settings.keys, &problem.importance);
        commands.entity(entity).insert((
            CollisionProblem(problem),
            Growing(growth),
            Warped(complex.rest.clone()),
            Shells(vec![Shell::skin(complex)]),
            (Sizes::default(), Rotations::default(), Targets::default(), Touching::default(), Proposed::default()),
            (HeldBack::default(), Holds::default(), BoundaryAtRisk::default()),
        ));
    }
}

fn grow_sizes(mut domains: Query<(&Lattice, &CollisionProblem, &Growing, &mut Sizes)>, mut watch: ResMut<Stopwatch>) {
    for (Lattice(complex), CollisionProblem(problem), Growing(growth), mut sizes) in &mut domains {
        if !growth.done() && growth.is_new_step() {
            sizes.0 = watch.time("grow", || grow(complex, problem, growth.lambda()));
        }
    }
}

fn fit_cells(
    mut domains: Query<(&Lattice, &CollisionProblem, &Growing, &Sizes, &Warped, &mut Rotations, &mut Targets)>,
    mut watch: ResMut<Stopwatch>,
) {
    for (Lattice(complex), CollisionProblem(problem), Growing(growth), sizes, warped, mut rotations, mut targets) in
        &mut domains
    {
        if !growth.done() {
            watch.time("local", || local_step(complex, problem, &sizes.0, &warped.0, &mut rotations.0, &mut targets.0));
        }
    }
}

fn find_contacts(
    mut domains: Query<(&Lattice, &CollisionProblem, &Growing, &Sizes, &Warped, &mut Touching)>,
    mut watch: ResMut<Stopwatch>,
) {
    for (Lattice(complex), CollisionProblem(problem), Growing(growth), sizes, warped, mut touching) in &mut domains {
        if !growth.done() {
            touching.0 = watch.time("contact", || contact_step(complex, problem, &sizes.0, &warped.0));
        }
    }
}

fn propose(
    mut domains: Query<(&Lattice, &CollisionProblem, &Growing, &Warped, &Targets, &Touching, &mut Proposed)>,
    mut watch: ResMut<Stopwatch>,
) {
    for (Lattice(complex), CollisionProblem(problem), Growing(growth), warped, targets, touching, mut proposed) in
        &mut domains
    {
        if !growth.done() {
            proposed.0 = watch.time("global", || global_step(complex, problem, &warped.0, &targets.0, &touching.0).0);
        }
    }
}

type Accepted<'a> = (
    &'a Lattice,
    &'a Sizes,
    &'a BoundaryAtRisk,
    &'a mut Growing,
    &'a mut Shells,
    &'a mut Warped,
    &'a mut Proposed,
    &'a mut HeldBack,
    &'a mut Holds,
);

fn accept(mut domains: Query<Accepted>, mut watch: ResMut<Stopwatch>) {
    for (
        Lattice(complex),
        sizes,
        at_risk,
        mut growing,
        mut shells,
        mut warped,
        mut proposed,
        mut held_back,
        mut holds,
    ) in &mut domains
    {
        if growing.0.done() {
            continue;
        }
        let proposed = std::mem::take(&mut proposed.0);
        let guarded = if at_risk.0 { shells.0.len() } else { 1 };
        let (motion, guarded) = watch.time("guard", || {
            guard_step(complex, &sizes.0, &mut shells.0[..guarded], &mut warped.0, proposed, &mut holds.0)
        });
        growing.0.iterated(motion);
        held_back.0 = guarded;
    }
}
