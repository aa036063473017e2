//! Voxelize: gives a domain its lattice.

use std::sync::Arc;

use bevy::prelude::*;

use super::{Complex, suspected_welds, voxelize};
use crate::{
    diagnostics::Stopwatch,
    schedule::{Domain, Failure, Solve, Stage},
};

/// C and C_t of a domain.
#[derive(Component, Debug)]
pub struct Lattice(pub Arc<Complex>);

/// Cells of a domain that may glue two sheets of its surface.
#[derive(Component, Debug)]
pub struct SuspectedWelds(pub usize);

/// Adds the stage.
pub struct VoxelPlugin;

impl Plugin for VoxelPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Solve, voxelize_new.in_set(Stage::Voxelize));
    }
}

fn voxelize_new(
    mut commands: Commands,
    domains: Query<(Entity, &Domain), Without<Lattice>>,
    mut watch: ResMut<Stopwatch>,
    mut failure: ResMut<Failure>,
) {
    for (entity, domain) in &domains {
        match watch.time("voxelize", || voxelize(&domain.boundary, domain.settings.resolution)) {
            Ok(complex) => {
                let welds =
                    watch.time("input", || suspected_welds(&domain.boundary, &domain.boundary.welded(), &complex));
                commands.entity(entity).insert((Lattice(Arc::new(complex)), SuspectedWelds(welds)));
            }
            Err(error) => failure.0 = Some(error),
        }
    }
}
