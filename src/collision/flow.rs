//! Flow: on maps, areas find their own way.
//!
//! # Theory
//! The local–global iteration fits cells one by one. Where sizes change much within a few cells it proposes folds, the
//! guard holds them, and what is held does not grow. So before it each step of λ is taken by a flow: nodes move by
//! `d = ∇φ`, `Δφ = ln(area asked / area now)` on the deformed complex. Every cell gains about what it lacks, and as the
//! divergence is small and smooth nothing turns over. Cartograms are made by such flows alone (Gastner and Newman 2004;
//! Gastner, Seguy and More 2018); here they only lead, and what shear they leave behind the iterations take out.
//!
//! # Practice
//! Linear elements on the deformed triangles, whose edges are the lattice's: the multigrid cycle of their Laplacian. φ is
//! held near 0 along the rim, so that domains grow where they are free to.

use glam::{Vec2, Vec3A};
use rayon::prelude::*;

use super::Asked;
use crate::{
    multigrid::{Multigrid, Weights, conjugate_gradients},
    voxel::{CHUNK, Complex, Dimension, KUHN_FLAT},
};

/// A cell gains or loses at most this much at once, as `ln` of its area: about what a step of λ asks for, so that growth
/// passes through states that are near to each other; and where regions are far from their area at λ = 1.
pub const GROWING: f32 = 0.06;
pub const CORRECTING: f32 = 0.5;

/// How strongly φ is held at 0 along the rim, against 1 for an edge.
const RIM: f32 = 1.0;

/// Weights of edges (half the sum of cotangents) are kept within these: slivers must not spoil the solve.
const WEIGHTS: [f32; 2] = [0.02, 20.0];

/// Conjugate gradient steps at most, and the part of the residual that may be left: it is only the way, not the goal.
const STEPS: u32 = 12;
const TOLERANCE: f64 = 0.01;

/// The corners of a flat cell's two triangles.
const ELEMENTS: [[usize; 3]; 2] = {
    let [[a, b, c, _], [d, e, f, _]] = KUHN_FLAT;
    [[a, b, c], [d, e, f]]
};

/// What a flow needs of a flat complex from step to step.
#[derive(Debug, Clone)]
pub struct Flow {
    operator: Multigrid,
}

impl Flow {
    /// Prepares for a complex.
    pub fn new(complex: &Complex) -> Self {
        debug_assert_eq!(complex.dimension, Dimension::Two);
        let rim = complex.on_boundary.iter().map(|&rim| if rim { RIM } else { 0.0 }).collect();
        Self { operator: Multigrid::with_mass(complex, Weights::Unit, rim) }
    }

    /// Where a flow would take the nodes: every cell nearer to the area asked for, by at most `most` as `ln` of its area.
    pub fn step(&mut self, complex: &Complex, asked: &Asked, positions: &[Vec3A], most: f32) -> Vec<Vec3A> {
        let cells: Vec<Cell> = complex
            .corners
            .par_iter()
            .zip(&asked.size)
            .with_min_len(CHUNK / 4)
            .map(|(corners, &size)| {
                Cell::of(std::array::from_fn(|k| positions[corners[k] as usize].truncate()), size, most)
            })
            .collect();
        self.operator.reweigh(complex, |cell, corner, direction| cells[cell].weight(corner, direction));
        let around = |i: usize| {
            complex.cells_around[i]
                .iter()
                .take(4)
                .enumerate()
                .filter(|(_, cell)| **cell != u32::MAX)
                .map(|(corner, &cell)| (corner, cell as usize))
        };
        let mut source: Vec<Vec3A> = (0..complex.nodes())
            .into_par_iter()
            .with_min_len(CHUNK)
            .map(|i| Vec3A::X * -around(i).map(|(corner, cell)| cells[cell].source(corner)).sum::<f32>())
            .collect();
        let mut potential = vec![Vec3A::ZERO; complex.nodes()];
        let goal = TOLERANCE * source.iter().map(|s| f64::from(s.x).powi(2)).sum::<f64>().sqrt();
        conjugate_gradients(&self.operator, &mut source, &mut potential, goal, STEPS);
        let slopes: Vec<[Vec2; 2]> = complex
            .corners
            .par_iter()
            .zip(&cells)
            .with_min_len(CHUNK / 4)
            .map(|(corners, cell)| cell.slopes(std::array::from_fn(|k| potential[corners[k] as usize].x)))
            .collect();
        (0..complex.nodes())
            .into_par_iter()
            .with_min_len(CHUNK)
            .map(|i| {
                let (mut sum, mut area) = (Vec2::ZERO, 0.0);
                for (corner, cell) in around(i) {
                    for (element, corners) in ELEMENTS.iter().enumerate() {
                        if corners.contains(&corner) {
                            sum += cells[cell].areas[element] * slopes[cell][element];
                            area += cells[cell].areas[element];
                        }
                    }
                }
                positions[i] + (sum / area.max(f32::MIN_POSITIVE)).extend(0.0).to_vec3a()
            })
            .collect()
    }
}

/// A deformed cell.
struct Cell {
    at: [Vec2; 4],
    /// Of its two triangles; of one that is flatter than a hundredth of the size asked for, that.
    areas: [f32; 2],
    /// ln of area asked over area now, within bounds.
    lack: f32,
}

impl Cell {
    fn of(at: [Vec2; 4], size: f32, most: f32) -> Self {
        let areas = ELEMENTS.map(|[a, b, c]| 0.5 * (at[b] - at[a]).perp_dot(at[c] - at[a]));
        let asked = size * size;
        let now = (areas[0] + areas[1]).max(0.01 * asked);
        let lack = (asked / now).ln().clamp(-most, most);
        Self { at, areas: areas.map(|area| area.max(0.005 * asked)), lack }
    }

    /// Half the sum of the cotangents across the edge from a corner in a direction.
    fn weight(&self, corner: usize, direction: usize) -> f32 {
        let other = corner | direction;
        let of_element = |element: usize| {
            let corners = ELEMENTS[element];
            if !corners.contains(&corner) || !corners.contains(&other) {
                return 0.0;
            }
            let Some(&across) = corners.iter().find(|&&k| k != corner && k != other) else { return 0.0 };
            let (u, v) = (self.at[corner] - self.at[across], self.at[other] - self.at[across]);
            0.5 * u.dot(v) / (2.0 * self.areas[element])
        };
        (of_element(0) + of_element(1)).clamp(WEIGHTS[0], WEIGHTS[1])
    }

    /// What a corner has of the cell's lack.
    fn source(&self, corner: usize) -> f32 {
        let third = |element: usize| if ELEMENTS[element].contains(&corner) { self.areas[element] / 3.0 } else { 0.0 };
        self.lack * (third(0) + third(1))
    }

    /// Slopes of a potential given at the corners, by triangle.
    fn slopes(&self, potential: [f32; 4]) -> [Vec2; 2] {
        [0, 1].map(|element| {
            let corners = ELEMENTS[element];
            let sum: Vec2 = (0..3)
                .map(|k| {
                    let [a, b, c] = [0, 1, 2].map(|step| corners[(k + step) % 3]);
                    (self.at[c] - self.at[b]).perp() * potential[a]
                })
                .sum();
            sum / (2.0 * self.areas[element])
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{certificate::is_positive, voxel::Grid};
    use glam::{DVec3, UVec3};

    /// A square of 16 cells a side whose middle asks for three times the area, and the root mean square lack of its cells
    /// before and after flows of which each goes this part of its way.
    fn lack_after_flows(part: f32) -> [f32; 2] {
        let grid = Grid { origin: DVec3::ZERO, cell_size: 1.0, cells: UVec3::new(16, 16, 1) };
        let complex = Complex::from_flat_cells(grid, &[true; 256]);
        let is_middle = |c: &glam::IVec3| (5..11).contains(&c.x) && (5..11).contains(&c.y);
        let size = complex.cells.iter().map(|c| if is_middle(c) { 3.0_f32.sqrt() } else { 1.0 }).collect();
        let asked = Asked { size, radius: Vec::new() };
        let mut positions = complex.rest.clone();
        let lack = |positions: &[Vec3A]| {
            let area = |corners: &[u32; 8]| -> f32 {
                Cell::of(std::array::from_fn(|k| positions[corners[k] as usize].truncate()), 1.0, 1.0)
                    .areas
                    .iter()
                    .sum()
            };
            let of_cell = |(corners, size): (&[u32; 8], &f32)| (size * size / area(corners)).ln().powi(2);
            (complex.corners.iter().zip(&asked.size).map(of_cell).sum::<f32>() / 256.0).sqrt()
        };
        let before = lack(&positions);
        let mut flow = Flow::new(&complex);
        for _ in 0..12 {
            let next = flow.step(&complex, &asked, &positions, 0.25);
            positions.iter_mut().zip(next).for_each(|(p, next)| *p = p.lerp(next, part));
            for corners in &complex.corners {
                for element in Dimension::Two.elements() {
                    let at = element.map(|k| positions[corners[k] as usize].as_dvec3());
                    assert!(part < 0.0 || is_positive(Dimension::Two, at), "a cell folds");
                }
            }
        }
        [before, lack(&positions)]
    }

    #[test]
    fn cells_flow_to_their_areas_without_folding() {
        let [before, after] = lack_after_flows(1.0);
        assert!(after < 0.35 * before, "{before} {after}");
    }

    #[test]
    fn sabotage_against_the_flow_areas_become_worse() {
        let [before, after] = lack_after_flows(-1.0);
        assert!(after > before, "{before} {after}");
    }
}
