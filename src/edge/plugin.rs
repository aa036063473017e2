//! Edge solve: gives a lattice with importance its V', from the V' of before where there is one.

use bevy::prelude::*;
use glam::Vec3A;

use super::EdgeSolver;
use crate::{
    diagnostics::Stopwatch,
    importance::plugin::Importance,
    schedule::{Interactive, Solve, Stage},
    voxel::plugin::Lattice,
};

/// V', `[nodes]`, in cells.
#[derive(Component, Debug)]
pub struct LinearSolution(pub Vec<Vec3A>);

/// What Eq. 1 needs of a lattice, made once.
#[derive(Component, Debug)]
pub struct EdgeProblem(EdgeSolver);

/// Adds the stage.
pub struct EdgePlugin;

impl Plugin for EdgePlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Solve, solve.in_set(Stage::EdgeSolve));
    }
}

type Asked<'a> = (
    Entity,
    &'a Lattice,
    &'a Importance,
    Option<&'a mut EdgeProblem>,
    Option<&'a mut LinearSolution>,
    Has<Interactive>,
);

fn solve(mut commands: Commands, mut lattices: Query<Asked, Changed<Importance>>, mut watch: ResMut<Stopwatch>) {
    for (entity, Lattice(complex), importance, mut problem, mut linear, is_kept) in &mut lattices {
        let (mut prepared, mut first) = (None, None);
        watch.time("edge", || {
            let solver = match &mut problem {
                Some(problem) => &mut problem.0,
                None => prepared.insert(EdgeSolver::new(complex)),
            };
            let linear = match &mut linear {
                Some(linear) => &mut linear.0,
                None => first.insert(complex.rest.clone()),
            };
            solver.solve(complex, &importance.nodes, linear);
        });
        if let Some(first) = first {
            commands.entity(entity).insert(LinearSolution(first));
        }
        if let Some(solver) = prepared.filter(|_| is_kept) {
            commands.entity(entity).insert(EdgeProblem(solver));
        }
    }
}
