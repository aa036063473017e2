//! Contract over all complexes, importances and states: what must hold for any of them, judged by means that share nothing
//! with the code under test: dense solves, all pairs, exact integers. Each has a sabotage beside it: one thing broken on
//! purpose, and seen.

#[path = "../common/mod.rs"]
mod common;

mod carried;
mod complexes;
mod edge;
mod states;
mod surfaces;

use common::complex;
use glam::{DVec3, IVec3, UVec3};
use homunculus::voxel::{Complex, Grid};
use proptest::prelude::*;

/// So many cases, no files left behind.
pub fn cases(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, failure_persistence: None, max_shrink_iters: 200, ..ProptestConfig::default() }
}

/// A complex that is shown by its cells.
pub struct Cells(Complex);

impl std::ops::Deref for Cells {
    type Target = Complex;

    fn deref(&self) -> &Complex {
        &self.0
    }
}

impl std::fmt::Debug for Cells {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let cells: Vec<_> = self.cells.iter().map(|c| c.to_array()).collect();
        write!(f, "{} cells of {}: {cells:?}", cells.len(), self.grid.cells)
    }
}

/// Cells at random, more inside than not, one at least; up to `most` along an axis.
pub fn scattered(most: u32) -> impl Strategy<Value = Cells> {
    (1..=most, 1..=most, 1..=most).prop_flat_map(|(x, y, z)| {
        let size = UVec3::new(x, y, z);
        prop::collection::vec(prop::bool::weighted(0.65), size.element_product() as usize).prop_map(move |mut cells| {
            cells[0] = true;
            Cells(Complex::from_cells(Grid { origin: DVec3::ZERO, cell_size: 1.0, cells: size }, &cells))
        })
    })
}

/// Boxes with a gap of one cell between them, some bridged at one end.
pub fn boxes_with_gaps(most: i32) -> impl Strategy<Value = Cells> {
    let side = 2..=most;
    (side.clone(), side.clone(), side, 0..3_usize, prop::bool::ANY, prop::bool::ANY).prop_map(
        |(x, y, z, across, bridged, second)| {
            let mut size = IVec3::new(x, y, z);
            size[across] = size[across].max(3) + if second { 2 } else { 0 };
            let gap = size[across] / 2;
            let other = (across + 1) % 3;
            Cells(complex(size, |c| {
                let in_gap = c[across] == gap || (second && c[across] == gap - 2);
                !in_gap || (bridged && c[other] == 0 && c[across] == gap)
            }))
        },
    )
}

/// `[nodes]` importance at random, spread evenly in the logarithm, without any smoothness.
pub fn rough(random: &mut common::Random, nodes: usize, low: f64, high: f64) -> Vec<f32> {
    (0..nodes).map(|_| (low.ln() + (high / low).ln() * random.unit()).exp() as f32).collect()
}
