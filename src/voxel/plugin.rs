//! Voxelize: gives a domain its lattice.

use std::sync::Arc;

use bevy::prelude::*;

use super::{Complex, Flat, Shares, suspected_welds, voxelize};
use crate::{
    boundary::Boundary,
    diagnostics::Stopwatch,
    schedule::{Failed, Refused, Solve, Stage, StageResult, note_failures},
    settings::Settings,
};

/// B of a domain. Of a picture it is the flat mesh that it is drawn on, which comes with the lattice.
#[derive(Component, Debug, Clone)]
pub struct DomainBoundary(pub Arc<Boundary>);

/// The picture of a domain, where it is one that is warped.
#[derive(Component, Debug, Clone)]
pub struct DomainPicture(pub Arc<Flat>);

/// C and C_t of a domain.
#[derive(Component, Debug, Clone)]
pub struct Lattice(pub Arc<Complex>);

/// Cells of a domain that may glue two sheets of its surface.
#[derive(Component, Debug)]
pub struct SuspectedWelds(pub usize);

/// What regions have of the cells of a picture.
#[derive(Component, Debug)]
pub struct PixelShares(pub Shares);

/// Adds the stage.
pub struct VoxelPlugin;

impl Plugin for VoxelPlugin {
    fn build(&self, app: &mut App) {
        let systems = (voxelize_bodies.pipe(note_failures), voxelize_pictures.pipe(note_failures), share_pixels);
        app.add_systems(Solve, systems.chain().in_set(Stage::Voxelize));
    }
}

type New = (Without<Lattice>, Without<Failed>);

fn voxelize_bodies(
    mut commands: Commands,
    domains: Query<(Entity, &Settings, &DomainBoundary), (New, Without<DomainPicture>)>,
    mut watch: ResMut<Stopwatch>,
) -> StageResult {
    let mut refused = Refused::default();
    for (entity, settings, DomainBoundary(boundary)) in &domains {
        let lattice = watch.time("voxelize", || voxelize(boundary, settings.resolution));
        if let Some(complex) = refused.note(entity, lattice) {
            let welds = watch.time("input", || suspected_welds(boundary, &boundary.welded(), &complex));
            commands.entity(entity).insert((Lattice(Arc::new(complex)), SuspectedWelds(welds)));
        }
    }
    refused.into_result()
}

fn voxelize_pictures(
    mut commands: Commands,
    domains: Query<(Entity, &Settings, &DomainPicture), New>,
    mut watch: ResMut<Stopwatch>,
) -> StageResult {
    let mut refused = Refused::default();
    for (entity, settings, DomainPicture(picture)) in &domains {
        let lattice = watch.time("voxelize", || picture.lattice(settings.resolution));
        if let Some(complex) = refused.note(entity, lattice) {
            commands.entity(entity).insert((Lattice(Arc::new(complex)), SuspectedWelds(0)));
        }
    }
    refused.into_result()
}

/// What is asked of the pixels goes to the cells that they lie in.
fn share_pixels(
    mut commands: Commands,
    pictures: Query<(Entity, &DomainPicture, &Lattice), Changed<DomainPicture>>,
    mut watch: ResMut<Stopwatch>,
) {
    for (entity, DomainPicture(picture), Lattice(complex)) in &pictures {
        let shares = watch.time("voxelize", || picture.shares(complex));
        commands.entity(entity).insert(PixelShares(shares));
    }
}
