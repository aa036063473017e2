//! Importance to linear solution, again and again on one lattice.

use glam::Vec3A;

use crate::{
    boundary::Boundary,
    edge::EdgeSolver,
    importance::{Sampling, Spread, Stack},
    voxel::Complex,
};

/// Everything between a stroke and V' that depends on the lattice alone, and the last results to start from.
pub struct Linear {
    sampling: Sampling,
    spread: Spread,
    edge: EdgeSolver,
    /// `[cells]` region, or empty.
    regions: Vec<u32>,
    /// V' of the last importance, `[nodes]`, in cells.
    solution: Vec<Vec3A>,
}

impl Linear {
    /// Prepares for a boundary and its complex.
    pub fn new(boundary: &Boundary, complex: &Complex) -> Self {
        let sampling = Sampling::new(boundary, complex);
        Self {
            spread: Spread::new(&sampling, complex),
            regions: sampling.regions(boundary, complex),
            sampling,
            edge: EdgeSolver::new(complex),
            solution: complex.rest.clone(),
        }
    }

    /// `[nodes]` importance, and V' in cells.
    pub fn solve(&mut self, boundary: &Boundary, complex: &Complex, stack: &Stack) -> (Vec<f32>, &[Vec3A]) {
        let asked = stack.evaluate(boundary, &self.sampling.samples);
        let importance = self.spread.solve(&self.sampling, &asked);
        self.edge.solve(complex, &importance, &mut self.solution);
        (importance, &self.solution)
    }

    /// `[cells]` region of each cell, `u32::MAX` for none; empty where there are no regions.
    pub fn regions(&self) -> &[u32] {
        &self.regions
    }
}
