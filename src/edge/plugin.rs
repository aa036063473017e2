//! Edge solve: gives a lattice with importance its V'.

use bevy::prelude::*;
use glam::Vec3A;

use super::EdgeSolver;
use crate::{
    diagnostics::Stopwatch,
    importance::plugin::Importance,
    schedule::{Solve, Stage},
    voxel::plugin::Lattice,
};

/// V', `[nodes]`, in cells.
#[derive(Component, Debug)]
pub struct LinearSolution(pub Vec<Vec3A>);

/// Adds the stage.
pub struct EdgePlugin;

impl Plugin for EdgePlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Solve, solve_new.in_set(Stage::EdgeSolve));
    }
}

fn solve_new(
    mut commands: Commands,
    lattices: Query<(Entity, &Lattice, &Importance), Without<LinearSolution>>,
    mut watch: ResMut<Stopwatch>,
) {
    for (entity, Lattice(complex), importance) in &lattices {
        let linear = watch.time("edge", || {
            let mut linear = complex.rest.clone();
            EdgeSolver::new(complex).solve(complex, &importance.nodes, &mut linear);
            linear
        });
        commands.entity(entity).insert(LinearSolution(linear));
    }
}
