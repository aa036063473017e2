//! The energy of a cell, as the target that its local step fits it to.

use glam::{Mat3A, Quat, Vec3A};

use super::local;
use crate::settings::Settings;

/// What a cell would like to be. Local–global iteration minimizes `Σ_c Σ_{e∈c} ‖Δ''_e − A_c Δ_e‖²`, so an energy is given
/// by the target `A_c` that is best for the present state of one cell.
///
/// It must be a pure function of its arguments, so that a solve has the same bits for any number of threads.
pub trait CellEnergy: std::fmt::Debug + Send + Sync {
    /// `A_c` of a cell in space with its eight corners at these places, in cells. `size` > 0 is the linear size asked for
    /// now. `rotation` is the last one of this cell and is brought up to date.
    fn target(&self, corners: [Vec3A; 8], rotation: &mut Quat, size: f32) -> Mat3A;

    /// `A_c` of a flat cell, whose first four corners count.
    fn flat_target(&self, corners: [Vec3A; 8], size: f32) -> Mat3A;
}

/// The mixture of shape and size: `A_c = (1 − μ) s_c R_c + μ P_c`, with `P_c` the matrix nearest to the cell's deformation
/// gradient that has the volume asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mixture {
    /// μ in 0..=1: 0 keeps shape, 1 reaches the size.
    pub fidelity: f32,
}

impl From<&Settings> for Mixture {
    fn from(settings: &Settings) -> Self {
        Self { fidelity: settings.fidelity }
    }
}

impl CellEnergy for Mixture {
    #[inline]
    fn target(&self, corners: [Vec3A; 8], rotation: &mut Quat, size: f32) -> Mat3A {
        let (target, turned) = local::target(corners, *rotation, size, self.fidelity);
        *rotation = turned;
        target
    }

    #[inline]
    fn flat_target(&self, corners: [Vec3A; 8], size: f32) -> Mat3A {
        local::flat_target(corners, size, self.fidelity)
    }
}
