//! Importance: gives a lattice its F, and another one whenever something else is asked for.

use std::sync::Arc;

use bevy::prelude::*;

use super::{Sampling, Spread, Stack, cell_importance, node_importance};
use crate::{
    diagnostics::Stopwatch,
    schedule::{Interactive, Solve, Stage},
    voxel::plugin::{DomainBoundary, DomainPicture, Lattice, PixelShares},
};

/// F as a function of a domain's surface; a picture brings its own.
#[derive(Component, Debug, Clone)]
pub struct DomainImportance(pub Arc<Stack>);

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

/// What spreading from a surface into its lattice needs, made once, with its last result to start from.
#[derive(Component, Debug)]
pub struct Spreading {
    sampling: Sampling,
    spread: Spread,
    /// `[cells]` region, or empty.
    regions: Vec<u32>,
}

/// Adds the stage.
pub struct ImportancePlugin;

impl Plugin for ImportancePlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Solve, (prepare, spread, take_pixels).chain().in_set(Stage::Importance));
    }
}

type Prepared<'a> =
    (Entity, &'a DomainBoundary, &'a DomainImportance, &'a Lattice, &'a mut Spreading, Has<Interactive>);

type Renewed = Or<(Changed<DomainImportance>, Added<Spreading>)>;

type Unprepared = (Changed<DomainImportance>, Without<DomainPicture>, Without<Spreading>);

fn prepare(
    mut commands: Commands,
    lattices: Query<(Entity, &DomainBoundary, &Lattice), Unprepared>,
    mut watch: ResMut<Stopwatch>,
) {
    for (entity, DomainBoundary(boundary), Lattice(complex)) in &lattices {
        let spreading = watch.time("importance", || {
            let sampling = Sampling::new(boundary, complex);
            let spread = Spread::new(&sampling, complex);
            Spreading { spread, regions: sampling.regions(boundary, complex), sampling }
        });
        commands.entity(entity).insert(spreading);
    }
}

fn spread(mut commands: Commands, mut domains: Query<Prepared, Renewed>, mut watch: ResMut<Stopwatch>) {
    for (entity, DomainBoundary(boundary), DomainImportance(stack), Lattice(complex), mut spreading, is_kept) in
        &mut domains
    {
        let importance = watch.time("importance", || {
            let Spreading { sampling, spread, regions } = &mut *spreading;
            let asked = stack.evaluate(boundary, &sampling.samples);
            let nodes = spread.solve(sampling, &asked);
            Importance { cells: cell_importance(complex, &nodes), nodes, region_of_cell: regions.clone() }
        });
        let mut entity = commands.entity(entity);
        entity.insert(importance);
        if !is_kept {
            entity.remove::<Spreading>();
        }
    }
}

fn take_pixels(
    mut commands: Commands,
    pictures: Query<(Entity, &Lattice, &PixelShares), Changed<PixelShares>>,
    mut watch: ResMut<Stopwatch>,
) {
    for (entity, Lattice(complex), PixelShares(shares)) in &pictures {
        let importance = watch.time("importance", || {
            let cells = shares.sizes(&[]);
            Importance { nodes: node_importance(complex, &cells), cells, region_of_cell: shares.regions() }
        });
        commands.entity(entity).insert(importance);
    }
}
