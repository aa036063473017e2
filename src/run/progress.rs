//! Where a solve is, and who watches it.

use bevy::prelude::{Entity, World};

use crate::{
    certificate::fidelity,
    collision::plugin::{CollisionProblem, Growing, Warped},
    reference::plugin::ReferenceIterations,
    voxel::plugin::Lattice,
};

/// Where the engine is.
#[derive(Debug, Clone, Copy)]
pub struct Progress {
    /// The stage's name.
    pub stage: &'static str,
    /// λ, 0..=1.
    pub lambda: f32,
    /// 95th percentile of the size error against what is asked for at λ = 1.
    pub size_error_p95: f32,
    /// Share of the whole work done, 0..=1.
    pub fraction: f32,
}

/// Who watches the engine.
pub trait Observer: Sync {
    /// Called between iterations.
    fn progress(&self, p: &Progress);
    /// Whether to stop; asked between iterations.
    fn cancelled(&self) -> bool;
}

/// Watches nothing and never stops.
impl Observer for () {
    fn progress(&self, _: &Progress) {}

    fn cancelled(&self) -> bool {
        false
    }
}

/// Where a domain is; the stage named is the one about to run.
pub(super) fn progress(world: &World, entity: Entity) -> Progress {
    let at = |stage, fraction| Progress { stage, lambda: 0.0, size_error_p95: f32::NAN, fraction };
    if world.get::<Lattice>(entity).is_none() {
        return at("voxelize", 0.0);
    }
    let Some(Growing(growth)) = world.get::<Growing>(entity) else { return at("edge", 0.01) };
    if let Some(ReferenceIterations(done)) = world.get(entity) {
        let fraction = *done as f32 / crate::reference::ITERATIONS as f32;
        return Progress { lambda: fraction, ..at("fig5", fraction) };
    }
    let size_error_p95 =
        match (world.get::<Lattice>(entity), world.get::<CollisionProblem>(entity), world.get::<Warped>(entity)) {
            (Some(Lattice(complex)), Some(CollisionProblem(problem)), Some(Warped(positions)))
                if growth.is_new_step() =>
            {
                fidelity(complex, &problem.importance, positions, 0.0, &[], &[]).p95 as f32
            }
            _ => f32::NAN,
        };
    let (stage, lambda) = if growth.lambda() < 1.0 { ("growth", growth.lambda()) } else { ("settling", 1.0) };
    Progress { stage, lambda, size_error_p95, fraction: growth.fraction() }
}
