//! Geometric multigrid on nested lattices: one V-cycle as preconditioner.
//!
//! # Theory
//! A coarse cell is inside where one of its eight children is. The Kuhn subdivision is nested: a fine node is either a
//! coarse node or the middle of one coarse edge, so prolongation P has at most two entries a row and is exact for
//! piecewise linear functions. The coarse operator `Pᵀ A P` (Galerkin) has the same fifteen-point pattern, because both
//! ends of a fine edge lie in one coarse tetrahedron.
//!
//! In the plane rows have six entries, and every fine edge lies on one coarse edge or beside one: see `level.rs`.
//!
//! # Practice
//! Smoother: two damped Jacobi sweeps with Chebyshev weights, the same before and (reversed) after, so that the cycle is
//! symmetric. Every parallel loop gathers, none scatters: the result has the same bits for any number of threads.

mod conjugate;
mod level;

pub(crate) use conjugate::preconditioned;
pub use conjugate::{Solution, conjugate_gradients, dot};

use glam::Vec3A;
use rayon::prelude::*;

use crate::voxel::{CHUNK, Complex, Dimension};
use level::Level;

/// Which Laplacian of C.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Weights {
    /// Every edge weighs 1 (Eq. 1).
    Unit,
    /// Every edge weighs the number of cells around it (the global step of the collision optimization).
    Cells,
}

/// The hierarchy.
#[derive(Debug, Clone)]
pub struct Multigrid {
    levels: Vec<Level>,
}

/// Levels stop at this many nodes; the coarsest is then smoothed until it is solved well enough.
const COARSEST: usize = 200;

/// Sweeps on the coarsest level.
const COARSEST_SWEEPS: usize = 24;

/// Chebyshev weights of two Jacobi sweeps for eigenvalues of D⁻¹A in [0.5, 2]: 2 is Gershgorin's bound, and what lies
/// below a quarter of it is the coarse level's work.
const SWEEPS: [f32; 2] = [0.561_694, 1.389_526];

/// Vectors of one level, kept between cycles.
#[derive(Debug, Clone, Default)]
struct Workspace {
    x: Vec<Vec3A>,
    b: Vec<Vec3A>,
    spare: Vec<Vec3A>,
}

/// Reusable memory of the cycle.
#[derive(Debug, Clone, Default)]
pub struct CycleMemory {
    levels: Vec<Workspace>,
}

impl Multigrid {
    /// Builds all levels of the Laplacian.
    pub fn new(complex: &Complex, weights: Weights) -> Self {
        Self::with_mass(complex, weights, Vec::new())
    }

    /// Builds all levels of Laplacian + diagonal; `mass` is `[nodes]`, ≥ 0, or empty for none.
    pub fn with_mass(complex: &Complex, weights: Weights, mass: Vec<f32>) -> Self {
        let (finest, mut positions) = Level::finest(complex, weights, mass);
        let mut levels = vec![finest];
        while let Some(fine) = levels.last_mut().filter(|l| l.diagonal.len() > COARSEST) {
            let Some((coarse, coarse_positions)) = fine.coarsen(&positions) else { break };
            levels.push(coarse);
            positions = coarse_positions;
        }
        Self { levels }
    }

    /// Gives every edge of a flat lattice the sum of what the cells around it give, the diagonal stays: `weight` is asked
    /// for the cell, the corner where the edge begins, and its direction as corner bits.
    pub fn reweigh(&mut self, complex: &Complex, weight: impl Fn(usize, usize, usize) -> f32 + Sync) {
        debug_assert_eq!(complex.dimension, Dimension::Two);
        let forward = |i: usize| {
            std::array::from_fn(|slot| {
                let around = complex.cells_around[i].iter().take(4).enumerate();
                let beside = around.filter(|(corner, cell)| corner & (slot + 1) == 0 && **cell != u32::MAX);
                beside.map(|(corner, &cell)| weight(cell as usize, corner, slot + 1)).sum()
            })
        };
        let mut forward: Vec<[f32; 3]> =
            (0..complex.nodes()).into_par_iter().with_min_len(CHUNK).map(forward).collect();
        for k in 0..self.levels.len() {
            self.levels[k].reweigh(&forward);
            if let [fine, coarse, ..] = &self.levels[k..] {
                forward = fine.lift(&forward, coarse);
            }
        }
    }

    /// The operator itself: `y = A x`.
    pub fn apply(&self, x: &[Vec3A], y: &mut Vec<Vec3A>) {
        self.levels[0].apply(x, y);
    }

    /// `[nodes]` diagonal of the operator.
    pub fn diagonal(&self) -> &[f32] {
        &self.levels[0].diagonal
    }

    /// One symmetric V-cycle from zero: `x ≈ A⁻¹ b`.
    pub fn cycle(&self, b: &[Vec3A], x: &mut Vec<Vec3A>, memory: &mut CycleMemory) {
        memory.levels.resize_with(self.levels.len(), Workspace::default);
        memory.levels[0].b.clear();
        memory.levels[0].b.extend_from_slice(b);
        self.descend(0, &mut memory.levels);
        x.clone_from(&memory.levels[0].x);
    }

    fn descend(&self, depth: usize, memory: &mut [Workspace]) {
        let level = &self.levels[depth];
        let Some((work, below)) = memory.split_first_mut() else { return };
        let b = &work.b;
        // The first sweep starts from zero and needs no product with A.
        (0..b.len())
            .into_par_iter()
            .with_min_len(CHUNK)
            .map(|i| (SWEEPS[0] / level.diagonal[i]) * b[i])
            .collect_into_vec(&mut work.x);
        if depth + 1 == self.levels.len() {
            for k in 1..COARSEST_SWEEPS {
                // Palindromic order of weights keeps the coarsest solve symmetric.
                let weight = SWEEPS[usize::from(k % 4 == 1 || k % 4 == 2)];
                level.sweep(weight, b, &work.x, &mut work.spare);
                std::mem::swap(&mut work.x, &mut work.spare);
            }
            return;
        }
        level.sweep(SWEEPS[1], b, &work.x, &mut work.spare);
        std::mem::swap(&mut work.x, &mut work.spare);

        level.map_rows(&work.x, &mut work.spare, |i, ax| b[i] - ax);
        let residual = &work.spare;
        (0..level.children_start.len() - 1)
            .into_par_iter()
            .with_min_len(CHUNK)
            .map(|c| {
                let mut sum = Vec3A::ZERO;
                for &i in &level.children[level.children_start[c] as usize..level.children_start[c + 1] as usize] {
                    let [p, q] = level.parents[i as usize];
                    sum += if p == q { residual[i as usize] } else { 0.5 * residual[i as usize] };
                }
                sum
            })
            .collect_into_vec(&mut below[0].b);
        self.descend(depth + 1, below);

        let coarse = &below[0].x;
        work.x.par_iter_mut().zip(&level.parents).with_min_len(CHUNK).for_each(|(x, &[p, q])| {
            *x += 0.5 * (coarse[p as usize] + coarse[q as usize]);
        });
        for &weight in SWEEPS.iter().rev() {
            level.sweep(weight, b, &work.x, &mut work.spare);
            std::mem::swap(&mut work.x, &mut work.spare);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::voxel::Grid;
    use glam::{DVec3, UVec3};

    /// A block with a hole.
    fn complex(dimension: Dimension) -> Complex {
        let cells = match dimension {
            Dimension::Two => UVec3::new(31, 22, 1),
            Dimension::Three => UVec3::new(9, 8, 7),
        };
        let grid = Grid { origin: DVec3::ZERO, cell_size: 1.0, cells };
        let inside: Vec<bool> = (0..cells.element_product()).map(|k| k % 37 != 5).collect();
        match dimension {
            Dimension::Two => Complex::from_flat_cells(grid, &inside),
            Dimension::Three => Complex::from_cells(grid, &inside),
        }
    }

    fn values(count: usize) -> Vec<Vec3A> {
        let value = |k: usize| (k as u32).wrapping_mul(2_654_435_761) as f32 / u32::MAX as f32;
        (0..count).map(|k| Vec3A::new(value(3 * k), value(3 * k + 1), value(3 * k + 2))).collect()
    }

    /// `xᵀ A x` of what is linear on the coarse lattice, with the coarse matrix and with the fine one.
    fn energies(multigrid: &Multigrid, depth: usize) -> [f64; 2] {
        let (fine, coarse) = (&multigrid.levels[depth], &multigrid.levels[depth + 1]);
        let x = values(coarse.diagonal.len());
        let between = |&[p, q]: &[u32; 2]| 0.5 * (x[p as usize] + x[q as usize]);
        let lifted: Vec<Vec3A> = fine.parents.iter().map(between).collect();
        let energy = |level: &Level, x: &[Vec3A]| {
            let mut ax = Vec::new();
            level.apply(x, &mut ax);
            x.iter().zip(&ax).map(|(x, ax)| f64::from(x.dot(*ax))).sum()
        };
        [energy(coarse, &x), energy(fine, &lifted)]
    }

    /// The hierarchy of a flat lattice whose cells weigh differently.
    fn reweighed() -> Multigrid {
        let complex = complex(Dimension::Two);
        let mut multigrid = Multigrid::new(&complex, Weights::Unit);
        let weight = values(complex.cells.len());
        multigrid.reweigh(&complex, |cell, corner, direction| weight[cell].x + 0.1 * (corner + direction) as f32);
        multigrid
    }

    #[test]
    fn coarse_matrices_are_what_is_left_of_the_fine_ones() {
        let flat = Multigrid::new(&complex(Dimension::Two), Weights::Cells);
        let body = Multigrid::new(&complex(Dimension::Three), Weights::Cells);
        for multigrid in [flat, body, reweighed()] {
            assert!(multigrid.levels.len() > 1);
            for depth in 0..multigrid.levels.len() - 1 {
                let [coarse, fine] = energies(&multigrid, depth);
                assert!((coarse - fine).abs() < 1e-4 * fine, "{depth}: {coarse} {fine}");
            }
        }
    }

    #[test]
    fn sabotage_of_the_weights_shows() {
        let mut multigrid = reweighed();
        let (first, rest) = multigrid.levels.split_at_mut(1);
        let uneven: Vec<[f32; 3]> = values(first[0].diagonal.len()).iter().map(|v| v.to_array()).collect();
        let mut lifted = first[0].lift(&uneven, &rest[0]);
        lifted.iter_mut().for_each(|forward| forward.swap(0, 2));
        rest[0].reweigh(&lifted);
        first[0].reweigh(&uneven);
        let [coarse, fine] = energies(&multigrid, 0);
        assert!((coarse - fine).abs() > 1e-3 * fine, "{coarse} {fine}");
    }
}
