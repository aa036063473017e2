//! From the boundary's surface to nodes and edges: importance spread smoothly into the interior.
//!
//! The surface is sampled about twice per cell and axis; each sample pulls on the nodes of its element. Between them the
//! logarithm of importance is as smooth as a Laplacian makes it: `minimize Σ_s w_s (u_i − ln f_s)² + Σ_e (u_i − u_j)²`.
//! Logarithms, so that ×½ and ×2 are equally far from 1 and no value leaves the range that was asked for.

use glam::{DVec3, Vec3A};
use rayon::prelude::*;

use super::Sample;
use crate::{
    boundary::Boundary,
    multigrid::{Multigrid, Weights, conjugate_gradients},
    transfer::CellIndex,
    voxel::{Complex, Dimension},
};

/// Samples per cell and axis on the surface.
const SAMPLES_PER_CELL: f64 = 2.0;

/// No edge of a triangle is cut more often than this: a triangle cannot span more cells than the lattice has.
const MOST_CUTS: u32 = 1024;

/// How strongly the samples of one node pull, against 1 for each edge: at 10 the surface keeps what was asked to a few
/// percent while single samples do not show.
const PULL: f32 = 10.0;

/// `[cells]` mean importance of their nodes.
pub fn cell_importance(complex: &Complex, importance: &[f32]) -> Vec<f32> {
    complex.corners.par_iter().map(|c| c.iter().map(|&i| importance[i as usize]).sum::<f32>() / 8.0).collect()
}

/// Rounds of smoothing; each is a tent over three cells. Fewer leave jagged lines where importance steps, more blur small
/// regions into their neighbours.
const SMOOTHING: u32 = 1;

/// `[cells]` importance of a picture without steps: sizes that jump from cell to cell bend every line that crosses there.
/// Smoothed in the logarithm, as importance on bodies is.
pub fn smoothed(complex: &Complex, importance: &[f32]) -> Vec<f32> {
    let mut ln: Vec<f32> = importance.iter().map(|f| f.ln()).collect();
    for _ in 0..SMOOTHING {
        ln = cell_importance(complex, &node_importance(complex, &ln));
    }
    ln.into_iter().map(f32::exp).collect()
}

/// `[cells]` sizes that the collision optimization is asked for: those of a picture [`smoothed`].
pub fn asked_sizes(complex: &Complex, importance: &[f32]) -> Vec<f32> {
    match complex.dimension {
        Dimension::Two => smoothed(complex, importance),
        Dimension::Three => importance.to_vec(),
    }
}

/// `[nodes]` mean importance of the cells around.
pub fn node_importance(complex: &Complex, importance: &[f32]) -> Vec<f32> {
    let mean = |cells: &[u32; 8]| {
        let around = || cells.iter().filter(|&&c| c != u32::MAX).map(|&c| importance[c as usize]);
        around().sum::<f32>() / around().count() as f32
    };
    complex.cells_around.par_iter().map(mean).collect()
}

/// Where the surface was sampled, and on which nodes each sample pulls.
#[derive(Debug, Clone)]
pub struct Sampling {
    /// The samples, triangle by triangle.
    pub samples: Vec<Sample>,
    /// `[samples]` cell that holds it.
    cells: Vec<u32>,
    nodes: Vec<[u32; 4]>,
    weights: Vec<[f32; 4]>,
}

/// A sample, its cell, and the nodes it pulls on with their weights.
type Placed = (Sample, u32, [u32; 4], [f32; 4]);

impl Sampling {
    /// Samples the boundary for its complex.
    pub fn new(boundary: &Boundary, complex: &Complex) -> Self {
        let index = CellIndex::new(complex);
        // Each vertex is sampled once, by the first of its triangles: most samples of a fine mesh are vertices.
        let first_corners = boundary.first_corners();
        let found: Vec<Vec<Placed>> = (0..boundary.triangles.len())
            .into_par_iter()
            .with_min_len(256)
            .map(|t| {
                let corners = boundary.triangles[t];
                let at = corners.map(|v| complex.grid.lattice_from_source(boundary.positions[v as usize]));
                let longest = (at[1] - at[0]).length().max((at[2] - at[1]).length()).max((at[0] - at[2]).length());
                let cuts = ((longest * SAMPLES_PER_CELL).ceil() as u32).clamp(1, MOST_CUTS);
                let is_another_s = |i: u32, j: u32| {
                    let at = [i, j, cuts - i - j].iter().position(|&k| k == cuts);
                    at.and_then(|k| first_corners[corners[k] as usize]).is_some_and(|(first, _)| first != t)
                };
                let mut samples = Vec::new();
                for i in 0..=cuts {
                    for j in (0..=cuts - i).filter(|&j| !is_another_s(i, j)) {
                        let w = [f64::from(i), f64::from(j), f64::from(cuts - i - j)].map(|k| k / f64::from(cuts));
                        let p: DVec3 = at.iter().zip(w).map(|(p, w)| *p * w).sum();
                        if let Some(cell) = index.locate(p) {
                            let (nodes, weights) = index.barycentric(cell, p);
                            let sample = Sample { triangle: t as u32, weights: w.map(|w| w as f32) };
                            samples.push((sample, cell, nodes, weights));
                        }
                    }
                }
                samples
            })
            .collect();
        let mut sampling = Self { samples: Vec::new(), cells: Vec::new(), nodes: Vec::new(), weights: Vec::new() };
        for (sample, cell, nodes, weights) in found.into_iter().flatten() {
            sampling.samples.push(sample);
            sampling.cells.push(cell);
            sampling.nodes.push(nodes);
            sampling.weights.push(weights);
        }
        sampling
    }

    /// `[nodes]` importance from `[samples]` importance.
    pub fn spread(&self, complex: &Complex, importance: &[f32]) -> Vec<f32> {
        Spread::new(self, complex).solve(self, importance)
    }

    /// `[cells]` region of each cell: that of its first sample, spread from cell to cell; `u32::MAX` for none at all.
    pub fn regions(&self, boundary: &Boundary, complex: &Complex) -> Vec<u32> {
        let Some(regions) = &boundary.regions else { return Vec::new() };
        let mut of_cell = vec![u32::MAX; complex.cells.len()];
        let mut seen = vec![false; complex.cells.len()];
        let mut front = Vec::new();
        for (sample, &cell) in self.samples.iter().zip(&self.cells) {
            let heaviest = (0..3).max_by(|&a, &b| sample.weights[a].total_cmp(&sample.weights[b])).unwrap_or(0);
            let vertex = boundary.triangles[sample.triangle as usize][heaviest];
            if !seen[cell as usize] {
                seen[cell as usize] = true;
                of_cell[cell as usize] = regions.of_vertex[vertex as usize];
                front.push(cell);
            }
        }
        while !front.is_empty() {
            let mut next = Vec::new();
            for &cell in &front {
                for &node in &complex.corners[cell as usize] {
                    for &other in &complex.cells_around[node as usize] {
                        if other != u32::MAX && !seen[other as usize] {
                            seen[other as usize] = true;
                            of_cell[other as usize] = of_cell[cell as usize];
                            next.push(other);
                        }
                    }
                }
            }
            front = next;
        }
        of_cell
    }
}

/// What spreading needs that does not depend on importance, and the last result to start from.
#[derive(Debug, Clone)]
pub struct Spread {
    /// `[nodes]` how strongly samples pull together.
    pull: Vec<f64>,
    /// `[nodes]` the same, at most [`PULL`].
    mass: Vec<f32>,
    operator: Multigrid,
    /// `[nodes]` ln f in the first coordinate.
    u: Vec<Vec3A>,
}

impl Spread {
    /// Prepares for the samples of a complex.
    pub fn new(sampling: &Sampling, complex: &Complex) -> Self {
        let mut pull = vec![0.0_f64; complex.nodes()];
        for (nodes, weights) in sampling.nodes.iter().zip(&sampling.weights) {
            for (&i, &w) in nodes.iter().zip(weights) {
                pull[i as usize] += f64::from(w);
            }
        }
        // The mean of a node's samples, pulling with at most PULL: many samples do not outweigh few.
        let mass: Vec<f32> = pull.iter().map(|&p| PULL * p.min(1.0) as f32).collect();
        let operator = Multigrid::with_mass(complex, Weights::Unit, mass.clone());
        Self { pull, mass, operator, u: vec![Vec3A::ZERO; complex.nodes()] }
    }

    /// `[nodes]` importance from `[samples]` importance, starting from the last result.
    pub fn solve(&mut self, sampling: &Sampling, importance: &[f32]) -> Vec<f32> {
        let mut towards = vec![0.0_f64; self.pull.len()];
        for (k, &f) in importance.iter().enumerate() {
            let ln = f64::from(f).ln();
            for (&i, &w) in sampling.nodes[k].iter().zip(&sampling.weights[k]) {
                towards[i as usize] += f64::from(w) * ln;
            }
        }
        let wanted: Vec<f32> =
            self.pull.iter().zip(&towards).map(|(&p, &t)| if p > 0.0 { (t / p) as f32 } else { 0.0 }).collect();
        if wanted.iter().zip(&self.mass).all(|(&u, &m)| m == 0.0 || u == 0.0) {
            self.u.fill(Vec3A::ZERO);
            return vec![1.0; self.pull.len()];
        }
        let mut residual = Vec::new();
        self.operator.apply(&self.u, &mut residual);
        for (r, (&u, &m)) in residual.iter_mut().zip(wanted.iter().zip(&self.mass)) {
            *r = Vec3A::new(m * u, 0.0, 0.0) - *r;
        }
        let goal = 1.0e-4 * (self.pull.len() as f64).sqrt();
        conjugate_gradients(&self.operator, &mut residual, &mut self.u, goal, 60);
        let (low, high) = importance.iter().fold((f32::INFINITY, 0.0_f32), |(l, h), &f| (l.min(f), h.max(f)));
        self.u.iter().map(|u| u.x.exp().clamp(low, high)).collect()
    }
}
