//! Areas of regions: what is asked of cells, corrected until regions have their size.
//!
//! A cell that lies in two regions has one size, and cells on a shared border give way to each other: the mean size of
//! cells may be right while a small region is several percent off. So at λ = 1 what a region asks for is multiplied by
//! `asked area / achieved area` every few iterations, until areas agree (cartogram methods repeat their flow for the same
//! reason, Gastner, Seguy and More 2018).

use bevy::prelude::Component;
use glam::Vec3A;

use crate::{
    certificate::volume_ratios,
    voxel::{Complex, Shares},
};

/// Iterations between two corrections: enough for the last one to be felt.
const PERIOD: u32 = 12;

/// Corrections at most.
const ROUNDS: u32 = 24;

/// No correction where the worst region is nearer to its area than this.
const GOOD_ENOUGH: f64 = 0.004;

/// A region's factor stays within this range and its inverse: what cannot be reached is not asked for ever louder.
const MOST: f64 = 4.0;

/// Regions smaller than this many cells are not corrected: they have no cell of their own to grow by, and would drive
/// their neighbours off.
const LEAST_CELLS: f64 = 2.0;

/// The correction of one domain.
#[derive(Component, Debug, Clone)]
pub struct AreaCorrection {
    /// `[regions]` what each asks for is multiplied by this, as area.
    factors: Vec<f32>,
    rounds: u32,
    finished: bool,
}

/// A region's areas, in pixels.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Areas {
    /// At rest.
    pub rest: f64,
    /// Asked for.
    pub asked: f64,
    /// In the state looked at.
    pub achieved: f64,
}

/// `[regions]` areas in a state.
pub fn region_areas(complex: &Complex, shares: &Shares, regions: usize, positions: &[Vec3A]) -> Vec<Areas> {
    let ratios = volume_ratios(complex, positions);
    let mut areas = vec![Areas::default(); regions];
    for (cell, elements) in ratios.chunks(complex.dimension.elements().len()).enumerate() {
        let ratio = elements.iter().map(|&r| f64::from(r)).sum::<f64>() / elements.len() as f64;
        for share in shares.of(cell) {
            if let Some(sum) = areas.get_mut(share.region as usize) {
                sum.rest += f64::from(share.area);
                sum.asked += f64::from(share.asked);
                sum.achieved += ratio * f64::from(share.area);
            }
        }
    }
    areas
}

impl AreaCorrection {
    /// For so many regions.
    pub fn new(regions: usize) -> Self {
        Self { factors: vec![1.0; regions], rounds: 0, finished: false }
    }

    /// Whether it is time for a correction at this iteration of λ = 1, or the state would be kept.
    pub fn is_due(&self, iteration: u32, settled: bool) -> bool {
        !self.finished && (settled || iteration.is_multiple_of(PERIOD))
    }

    /// Corrects what regions ask for: `[cells]` new importance, or nothing where areas are right or enough was tried.
    pub fn correct(&mut self, complex: &Complex, shares: &Shares, positions: &[Vec3A]) -> Option<Vec<f32>> {
        let cell = complex.grid.cell_size * complex.grid.cell_size;
        let areas = region_areas(complex, shares, self.factors.len(), positions);
        let is_resolved = |a: &Areas| a.rest >= LEAST_CELLS * cell && a.asked > 0.0 && a.achieved > 0.0;
        let off = |a: &Areas| (a.achieved / a.asked - 1.0).abs();
        let is_good = areas.iter().filter(|a| is_resolved(a)).all(|a| off(a) < GOOD_ENOUGH);
        if is_good || self.rounds >= ROUNDS {
            self.finished = true;
            return None;
        }
        self.rounds += 1;
        for (factor, a) in self.factors.iter_mut().zip(&areas).filter(|(_, a)| is_resolved(a)) {
            *factor = (f64::from(*factor) * (a.asked / a.achieved)).clamp(1.0 / MOST, MOST) as f32;
        }
        Some(shares.sizes(&self.factors))
    }
}
