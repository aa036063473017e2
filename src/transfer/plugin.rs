//! Transfer: binds the boundary once, as soon as there is a lattice to bind it to.

use std::sync::Arc;

use bevy::prelude::*;

use super::{Binding, flat_boundary};
use crate::{
    Error,
    diagnostics::Stopwatch,
    schedule::{Failed, Refused, Solve, Stage, StageResult, note_failures},
    voxel::plugin::{DomainBoundary, DomainPicture, Lattice},
};

/// Barycentric coordinates of a domain's boundary: as the surface follows the nodes now.
#[derive(Component, Debug, Clone)]
pub struct Bound(pub Arc<Binding>);

/// Adds the stage.
pub struct TransferPlugin;

impl Plugin for TransferPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Solve, (draw_pictures, bind.pipe(note_failures)).chain().in_set(Stage::Bind));
    }
}

/// Pictures are drawn on a mesh of their lattice.
fn draw_pictures(mut commands: Commands, pictures: Query<(Entity, &DomainPicture, &Lattice), Without<DomainBoundary>>) {
    for (entity, DomainPicture(picture), Lattice(complex)) in &pictures {
        let mesh = flat_boundary(&picture.name, complex, picture.size);
        commands.entity(entity).insert(DomainBoundary(mesh.into()));
    }
}

type New = (Without<Bound>, Without<Failed>);

fn bind(
    mut commands: Commands,
    lattices: Query<(Entity, &DomainBoundary, &Lattice), New>,
    mut watch: ResMut<Stopwatch>,
) -> StageResult {
    let mut refused = Refused::default();
    for (entity, DomainBoundary(boundary), Lattice(complex)) in &lattices {
        let binding = watch.time("transfer", || Binding::new(boundary, complex));
        let bound = match binding.unbound(boundary) {
            None => Ok(Bound(Arc::new(binding))),
            Some(vertex) => Err(Error::Fault(format!("vertex {vertex} lies outside the lattice made for it"))),
        };
        if let Some(bound) = refused.note(entity, bound) {
            commands.entity(entity).insert(bound);
        }
    }
    refused.into_result()
}
