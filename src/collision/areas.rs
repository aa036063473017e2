//! Areas of regions: what is asked of cells, corrected until regions have their size.
//!
//! A cell that lies in two regions has one size, and cells on a shared border give way to each other: the mean size of
//! cells may be right while a small region is several percent off. So once λ = 1 has settled, what a region asks for is
//! multiplied by `asked area / achieved area`, and the optimization goes on, a few rounds (as the error diffusion of
//! cartogram methods, Gastner and Newman 2004, is repeated until areas agree).

use bevy::prelude::Component;
use glam::Vec3A;

use crate::{certificate::volume_ratios, voxel::{Complex, Shares}};

/// Rounds of correction at most.
const ROUNDS: u32 = 12;

/// No correction where the worst region is nearer to its area than this.
const GOOD_ENOUGH: f64 = 0.003;

/// A region's factor stays within this range and its inverse: what cannot be reached is not asked for ever louder.
const MOST: f64 = 16.0;

/// The correction of one domain.
#[derive(Component, Debug, Clone)]
pub struct AreaCorrection {
    /// `[regions]` what each asks for is multiplied by this, as area.
    factors: Vec<f32>,
    rounds: u32,
}

/// `[regions]` area asked for and achieved in a state, in pixels.
pub fn region_areas(complex: &Complex, shares: &Shares, regions: usize, positions: &[Vec3A]) -> Vec<[f64; 2]> {
    let ratios = volume_ratios(complex, positions);
    let mut areas = vec![[0.0; 2]; regions];
    for (cell, elements) in ratios.chunks(complex.dimension.elements().len()).enumerate() {
        let ratio = elements.iter().map(|&r| f64::from(r)).sum::<f64>() / elements.len() as f64;
        for share in shares.of(cell) {
            if let Some([asked, achieved]) = areas.get_mut(share.region as usize) {
                *asked += f64::from(share.asked);
                *achieved += ratio * f64::from(share.area);
            }
        }
    }
    areas
}

impl AreaCorrection {
    /// For so many regions.
    pub fn new(regions: usize) -> Self {
        Self { factors: vec![1.0; regions], rounds: 0 }
    }

    /// Corrects what regions ask for after a settled state: `[cells]` new importance, or nothing where areas are right or
    /// enough was tried.
    pub fn correct(&mut self, complex: &Complex, shares: &Shares, positions: &[Vec3A]) -> Option<Vec<f32>> {
        if self.rounds >= ROUNDS {
            return None;
        }
        let areas = region_areas(complex, shares, self.factors.len(), positions);
        let off = |[asked, achieved]: [f64; 2]| if asked > 0.0 { (achieved / asked - 1.0).abs() } else { 0.0 };
        if areas.iter().all(|&a| off(a) < GOOD_ENOUGH) {
            return None;
        }
        self.rounds += 1;
        for (factor, [asked, achieved]) in self.factors.iter_mut().zip(areas) {
            if asked > 0.0 && achieved > 0.0 {
                *factor = (f64::from(*factor) * asked / achieved).clamp(1.0 / MOST, MOST) as f32;
            }
        }
        Some(shares.sizes(&self.factors))
    }
}
