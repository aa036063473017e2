//! Enclose: says which surfaces of a domain must not cross, and what of them crosses in the input.

use bevy::prelude::*;

use super::{Shell, Surfaces};
use crate::{
    diagnostics::Stopwatch,
    schedule::{Failed, Solve, Stage},
    transfer::plugin::Bound,
    voxel::plugin::{DomainBoundary, Lattice},
};

/// Pairs of the input's triangles that crossed at rest.
#[derive(Component, Debug)]
pub struct SelfIntersections(pub usize);

/// Adds the stage.
pub struct CertificatePlugin;

impl Plugin for CertificatePlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Solve, enclose.in_set(Stage::Enclose)).add_systems(Solve, follow.after(Stage::Certify));
    }
}

type New = (Without<Surfaces>, Without<Failed>);

fn enclose(
    mut commands: Commands,
    domains: Query<(Entity, &DomainBoundary, &Lattice, &Bound), New>,
    mut watch: ResMut<Stopwatch>,
) {
    for (entity, DomainBoundary(boundary), Lattice(complex), Bound(binding)) in &domains {
        let surfaces = watch.time("input", || Surfaces::new(boundary, binding.clone(), complex));
        let crossings = SelfIntersections(surfaces.written.as_ref().map_or(0, Shell::inherited));
        commands.entity(entity).insert((surfaces, crossings));
    }
}

/// A flat surface may have to follow its nodes otherwise than at first; there is one binding for all.
fn follow(mut domains: Query<(&Surfaces, &mut Bound), Changed<Surfaces>>) {
    for (surfaces, mut bound) in &mut domains {
        if let Some(binding) = surfaces.binding()
            && !std::sync::Arc::ptr_eq(binding, &bound.0)
        {
            bound.0 = binding.clone();
        }
    }
}
