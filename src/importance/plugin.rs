//! Importance: gives a lattice its F.

use bevy::prelude::*;

use super::{Sampling, cell_importance, node_importance};
use crate::{
    diagnostics::Stopwatch,
    schedule::{Domain, Solve, Stage},
    voxel::plugin::{Lattice, PixelShares},
};

/// F of a domain, > 0.
#[derive(Component, Debug, Clone, Default)]
pub struct Importance {
    /// `[nodes]`, for the edges of Eq. 1.
    pub nodes: Vec<f32>,
    /// `[cells]`, for Eq. 2.
    pub cells: Vec<f32>,
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
    lattices: Query<(Entity, &Domain, &Lattice, Option<&PixelShares>), Without<Importance>>,
    mut watch: ResMut<Stopwatch>,
) {
    for (entity, domain, Lattice(complex), shares) in &lattices {
        let importance = watch.time("importance", || {
            if let Some(PixelShares(shares)) = shares {
                let cells = shares.sizes(&[]);
                return Importance { nodes: node_importance(complex, &cells), cells, region_of_cell: shares.regions() };
            }
            let sampling = Sampling::new(&domain.boundary, complex);
            let asked = domain.importance.evaluate(&domain.boundary, &sampling.samples);
            let nodes = sampling.spread(complex, &asked);
            Importance {
                cells: cell_importance(complex, &nodes),
                nodes,
                region_of_cell: sampling.regions(&domain.boundary, complex),
            }
        });
        commands.entity(entity).insert(importance);
    }
}
