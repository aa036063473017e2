//! Transfer: binds the boundary once, as soon as there is a lattice to bind it to.

use std::sync::Arc;

use bevy::prelude::*;

use super::Binding;
use crate::{
    Error,
    certificate::Shell,
    collision::plugin::Shells,
    diagnostics::Stopwatch,
    schedule::{Domain, Failure, Solve, Stage},
    voxel::plugin::Lattice,
};

/// Barycentric coordinates of a domain's boundary.
#[derive(Component, Debug)]
pub struct Bound(pub Arc<Binding>);

/// Pairs of the input's triangles that crossed at rest.
#[derive(Component, Debug)]
pub struct SelfIntersections(pub usize);

/// Adds the stage.
pub struct TransferPlugin;

impl Plugin for TransferPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Solve, bind_new.in_set(Stage::Bind));
    }
}

fn bind_new(
    mut commands: Commands,
    mut lattices: Query<(Entity, &Domain, &Lattice, &mut Shells), Without<Bound>>,
    mut watch: ResMut<Stopwatch>,
    mut failure: ResMut<Failure>,
) {
    for (entity, domain, Lattice(complex), mut shells) in &mut lattices {
        let binding = watch.time("transfer", || Binding::new(&domain.boundary, complex));
        if let Some(vertex) = binding.unbound(&domain.boundary) {
            failure.0 = Some(Error::Fault(format!("vertex {vertex} lies outside the lattice made for it")));
            return;
        }
        let shell = watch.time("input", || Shell::boundary(&domain.boundary, binding.clone(), complex));
        commands.entity(entity).insert((Bound(Arc::new(binding)), SelfIntersections(shell.inherited())));
        shells.0.push(shell);
    }
}
