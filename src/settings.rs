//! How a domain is warped.

use bevy::prelude::Component;

use crate::{Error, Result};

/// Most keyframes: each is a whole mesh in the growth file.
pub const MAX_KEYS: usize = 64;

/// How to warp.
#[derive(Component, Debug, Clone, PartialEq)]
pub struct Settings {
    /// Cells along the longest axis.
    pub resolution: u32,
    /// μ in 0..=1: 0 keeps shape, 1 reaches the asked size.
    pub fidelity: f32,
    /// Keyframes of the growth after the rest shape, ≥ 1; more where a blend between two would not be valid.
    pub keys: usize,
    /// Run a reference solver instead.
    pub reference: Option<Reference>,
}

/// Which of the paper's own solvers to run for comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reference {
    /// Edge optimization alone.
    Eq1,
    /// Collision optimization as in Fig. 5, read sensibly.
    Fig5,
}

impl Default for Settings {
    /// What the command line takes for a body where nothing is said.
    fn default() -> Self {
        Self { resolution: 64, fidelity: 0.5, keys: 8, reference: None }
    }
}

impl Settings {
    /// Refuses what is out of range; how many cells there may be depends on what is warped, see
    /// [`check_resolution`](crate::voxel::check_resolution).
    ///
    /// # Errors
    /// One sentence with the field, its value and its range.
    pub fn check(&self) -> Result<()> {
        if !(0.0..=1.0).contains(&self.fidelity) {
            return Err(Error::input(format!("fidelity {} is not within 0 to 1", self.fidelity)));
        }
        if !(1..=MAX_KEYS).contains(&self.keys) {
            return Err(Error::input(format!("keys {} is not within 1 to {MAX_KEYS}", self.keys)));
        }
        Ok(())
    }
}
