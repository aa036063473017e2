//! Voxelize: gives a domain its lattice.

use std::sync::Arc;

use bevy::prelude::*;

use super::{Complex, Shares, suspected_welds, voxelize};
use crate::{
    Result,
    diagnostics::Stopwatch,
    schedule::{Domain, Failure, Solve, Stage},
    transfer::flat_boundary,
};

/// C and C_t of a domain.
#[derive(Component, Debug)]
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
        app.add_systems(Solve, voxelize_new.in_set(Stage::Voxelize));
    }
}

fn voxelize_new(
    mut commands: Commands,
    mut domains: Query<(Entity, &mut Domain), Without<Lattice>>,
    mut watch: ResMut<Stopwatch>,
    mut failure: ResMut<Failure>,
) {
    for (entity, mut domain) in &mut domains {
        match voxelize_domain(&mut domain, &mut watch) {
            Ok((complex, shares, welds)) => {
                let mut entity = commands.entity(entity);
                entity.insert((Lattice(Arc::new(complex)), SuspectedWelds(welds)));
                if let Some(shares) = shares {
                    entity.insert(PixelShares(shares));
                }
            }
            Err(error) => failure.0 = Some(error),
        }
    }
}

/// The lattice of a domain; of a picture also its shares, and B is made.
fn voxelize_domain(domain: &mut Domain, watch: &mut Stopwatch) -> Result<(Complex, Option<Shares>, usize)> {
    let resolution = domain.settings.resolution;
    if let Some(picture) = &domain.picture {
        let (complex, shares) = watch.time("voxelize", || picture.voxelize(resolution))?;
        domain.boundary = flat_boundary(&picture.name, &complex, picture.size).into();
        return Ok((complex, Some(shares), 0));
    }
    let boundary = &domain.boundary;
    let complex = watch.time("voxelize", || voxelize(boundary, resolution))?;
    let welds = watch.time("input", || suspected_welds(boundary, &boundary.welded(), &complex));
    Ok((complex, None, welds))
}
