//! Contract of memory: every input that once broke a promise is kept, and keeps it now. Each test says in a sentence
//! which promise it broke and when that was mended. An input is never taken away from here.

#[path = "../common/mod.rs"]
mod common;

mod blends;
mod files;
mod numbers;
mod states;

use glam::{DVec3, IVec3};
use homunculus::voxel::{Complex, Grid};

/// The complex of the cells for which `inside` holds.
fn complex(size: IVec3, inside: impl Fn(IVec3) -> bool) -> Complex {
    let grid = Grid { origin: DVec3::ZERO, cell_size: 1.0, cells: size.as_uvec3() };
    let cell = |k: i32| IVec3::new(k % size.x, k / size.x % size.y, k / size.x / size.y);
    let cells: Vec<bool> = (0..size.element_product()).map(|k| inside(cell(k))).collect();
    Complex::from_cells(grid, &cells)
}
