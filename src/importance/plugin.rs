//! Importance: gives a lattice its F.

use bevy::prelude::*;

use super::Sampling;
use crate::{
    diagnostics::Stopwatch,
    schedule::{Domain, Solve, Stage},
    voxel::plugin::Lattice,
};

/// F of a domain, > 0.
#[derive(Component, Debug)]
pub struct Importance {
    /// `[nodes]`
    pub nodes: Vec<f32>,
    /// `[cells]` region of each cell, `u32::MAX` for none; empty where the boundary has no regions.
    pub region_of_cell: Vec<u32>,
}

/// Adds the stage.
pub struct ImportancePlugin;

impl Plugin for ImportancePlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Solve, spread_new.in_set(Stage::Importance));
    }
}

fn spread_new(
    mut commands: Commands,
    lattices: Query<(Entity, &Domain, &Lattice), Without<Importance>>,
    mut watch: ResMut<Stopwatch>,
) {
    for (entity, domain, Lattice(complex)) in &lattices {
        let importance = watch.time("importance", || {
            let sampling = Sampling::new(&domain.boundary, complex);
            let asked = domain.importance.evaluate(&domain.boundary, &sampling.samples);
            Importance {
                nodes: sampling.spread(complex, &asked),
                region_of_cell: sampling.regions(&domain.boundary, complex),
            }
        });
        commands.entity(entity).insert(importance);
    }
}
