//! 3.3  Collision optimization (Eq. 2): grow by λ, fit every cell, keep apart, never step across.
//!
//! # Theory
//! Local–global iteration on `Σ_c Σ_{e∈c} ‖Δ''_e − A_c Δ_e‖²`: the [local] step chooses the target `A_c` of every cell,
//! the [global](global_step) step is one Laplacian solve for the positions, [contact] adds springs between boundary
//! nodes that come too close, and the [guard] lets only injective steps through.
//!
//! # Changes from the paper
//! Fig. 5 projects edge lengths one by one and diverges as printed (see `reference`). Its ingredients stay: stepwise
//! scaling by λ, spheres of radius r_i found by spatial hashing. The guard is new: it keeps the promise. So is the
//! [flow](Flow) by which each step of λ begins on maps.
//!
//! # Practice
//! One multigrid cycle is enough for the global step where nothing touches; with contacts, which the cycle does not
//! know, a few conjugate gradient steps are taken. All loops gather or sum in fixed chunks: same bits for any threads.

pub mod areas;
pub mod contact;
mod energy;
mod flow;
pub mod growth;
pub mod guard;
pub mod local;
pub mod plugin;
mod trail;

use std::sync::Arc;

use glam::{DMat3, DVec3, Mat3A, Quat, Vec3A};
use rayon::prelude::*;

use crate::{
    certificate::Checked,
    importance::cell_importance,
    multigrid::{Multigrid, Weights, dot, preconditioned},
    voxel::{CHUNK, Complex, Dimension},
};
pub use contact::Contacts;
pub use energy::{CellEnergy, Mixture};
pub use flow::Flow;
pub use growth::Growth;
pub use guard::{Extent, Guarded};
pub use trail::Trail;

/// Conjugate gradient steps of the global step without and with contacts. More than one without contacts gained nothing
/// (measured: the rotations, not the solve, are what converges slowly).
const GLOBAL_STEPS: [u32; 2] = [1, 2];

/// No node moves further than this part of its radius in one iteration (half a cell where cells keep their size), so
/// that a wall of one cell is not skipped by one.
const STEP_LIMIT: f32 = 0.5;

/// The same in the plane, where large parts have to flow far: a step is proven to be valid at every instant.
const FLAT_STEP_LIMIT: f32 = 4.0;

/// How near pairs are kept for the iterations of an extrapolated step, in radii.
const REACH: f32 = 1.5;

/// The constant part of the collision optimization: what depends on complex and importance alone.
#[derive(Debug, Clone)]
pub struct Problem {
    /// `[cells]` f_c.
    pub importance: Vec<f32>,
    /// What cells would like to be.
    pub energy: Arc<dyn CellEnergy>,
    /// `[cells]` size factor at λ = 0; `None` for 1, the rest shape.
    pub from: Option<Vec<f32>>,
    /// `[cells]` weight of each cell's misfit in the plane, `1 / s²`: a cell that shall be small is as much off by a
    /// tenth of its size as a large one. Empty for 1, which serves in space.
    weights: Vec<f32>,
    operator: Multigrid,
    boundary_nodes: Vec<u32>,
}

impl Problem {
    /// Prepares for a complex and its `[nodes]` importance, with the [`Mixture`] of a fidelity in 0..=1.
    pub fn new(complex: &Complex, importance: &[f32], fidelity: f32) -> Self {
        Self::of_cells(complex, cell_importance(complex, importance), Arc::new(Mixture { fidelity }))
    }

    /// Prepares for a complex and its `[cells]` importance.
    pub fn of_cells(complex: &Complex, importance: Vec<f32>, energy: Arc<dyn CellEnergy>) -> Self {
        Self {
            importance,
            energy,
            from: None,
            weights: Vec::new(),
            operator: Multigrid::new(complex, Weights::Cells),
            boundary_nodes: (0..complex.nodes() as u32).filter(|&i| complex.on_boundary[i as usize]).collect(),
        }
    }

    /// Weighs the cells of a flat complex by the sizes asked for now.
    pub fn weigh(&mut self, complex: &Complex, asked: &Asked) {
        if complex.dimension == Dimension::Two {
            self.weights = asked.size.iter().map(|s| 1.0 / (s * s)).collect();
            let weights = &self.weights;
            self.operator.reweigh(complex, |cell, _, _| weights[cell]);
        }
    }

    /// Takes another importance; the complex stays.
    pub fn set_importance(&mut self, complex: &Complex, importance: &[f32]) {
        self.importance = cell_importance(complex, importance);
    }
}

/// What is asked for at one λ.
#[derive(Debug, Clone, Default)]
pub struct Asked {
    /// `[cells]` s_c = 1 + λ (f_c − 1); from other sizes than rest f_c^λ · from_c^(1 − λ).
    pub size: Vec<f32>,
    /// `[nodes]` r_i, the least target length of the edges at i.
    pub radius: Vec<f32>,
}

/// Grow: the sizes and radii asked for at λ.
pub fn grow(complex: &Complex, problem: &Problem, lambda: f32) -> Asked {
    let size: Vec<f32> = match &problem.from {
        None => problem.importance.iter().map(|f| 1.0 + lambda * (f - 1.0)).collect(),
        Some(from) => from.iter().zip(&problem.importance).map(|(a, b)| a * (b / a).powf(lambda)).collect(),
    };
    let radius = complex
        .cells_around
        .par_iter()
        .with_min_len(CHUNK)
        .map(|cells| cells.iter().filter(|&&c| c != u32::MAX).map(|&c| size[c as usize]).fold(f32::INFINITY, f32::min))
        .collect();
    Asked { size, radius }
}

/// Local step: `[cells]` targets A_c, rotations brought up to date.
pub fn local_step(
    complex: &Complex,
    problem: &Problem,
    asked: &Asked,
    positions: &[Vec3A],
    rotations: &mut Vec<Quat>,
    targets: &mut Vec<Mat3A>,
) {
    rotations.resize(complex.cells.len(), Quat::IDENTITY);
    rotations
        .par_iter_mut()
        .zip(&complex.corners)
        .zip(&asked.size)
        .with_min_len(CHUNK / 4)
        .map(|((q, corners), &size)| {
            if complex.dimension == Dimension::Two {
                return problem.energy.flat_target(corners.map(|c| positions[c as usize]), size);
            }
            problem.energy.target(corners.map(|c| positions[c as usize]), q, size)
        })
        .collect_into_vec(targets);
}

/// Contact: pairs of boundary nodes that are too close now.
pub fn contact_step(complex: &Complex, problem: &Problem, asked: &Asked, positions: &[Vec3A]) -> Contacts {
    contact::find(complex, &problem.boundary_nodes, &asked.radius, positions)
}

/// Pairs of boundary nodes that may come too close within a few iterations.
pub fn near_step(complex: &Complex, problem: &Problem, asked: &Asked, positions: &[Vec3A]) -> Vec<(u32, u32)> {
    contact::near(complex, &problem.boundary_nodes, &asked.radius, positions, REACH)
}

/// Global step: where the nodes would like to go. Returns the proposed positions and the force left before the step
/// (root mean square over nodes, in cells), which is zero at rest.
pub fn global_step(
    complex: &Complex,
    problem: &Problem,
    positions: &[Vec3A],
    targets: &[Mat3A],
    contacts: &Contacts,
) -> (Vec<Vec3A>, f64) {
    let weight = |cell: u32| problem.weights.get(cell as usize).copied().unwrap_or(1.0);
    let corner_gather = local::corner_gather(complex.dimension);
    let mut force = Vec::new();
    problem.operator.apply(positions, &mut force);
    force.par_iter_mut().enumerate().with_min_len(CHUNK).for_each(|(i, force)| {
        let mut sum = -*force;
        for (corner, &cell) in complex.cells_around[i].iter().enumerate() {
            if cell != u32::MAX {
                sum += weight(cell) * (targets[cell as usize] * corner_gather[corner]);
            }
        }
        for c in contacts.of(i) {
            sum += contact::CONTACT_WEIGHT * c.depth * c.direction;
        }
        *force = sum;
    });
    let strength = (dot(&force, &force) / force.len() as f64).sqrt();
    let with_contacts = |p: &[Vec3A], q: &mut Vec<Vec3A>| {
        problem.operator.apply(p, q);
        if !contacts.is_empty() {
            q.par_iter_mut().enumerate().with_min_len(CHUNK).for_each(|(i, q)| {
                for c in contacts.of(i) {
                    *q += contact::CONTACT_WEIGHT * (p[i] - p[c.other as usize]);
                }
            });
        }
    };
    let mut step = vec![Vec3A::ZERO; complex.nodes()];
    let steps = GLOBAL_STEPS[usize::from(!contacts.is_empty())];
    preconditioned(&problem.operator, with_contacts, &mut force, &mut step, 0.0, steps);
    remove_rigid_motion(positions, &mut step);
    let proposed = positions.par_iter().zip(&step).with_min_len(CHUNK).map(|(x, d)| *x + *d).collect();
    (proposed, strength)
}

/// Takes the common translation and rotation out of a step: the energy does not know them, so they would only drift.
fn remove_rigid_motion(positions: &[Vec3A], step: &mut [Vec3A]) {
    let n = positions.len().max(1) as f64;
    let sum = |f: &(dyn Fn(usize) -> DVec3 + Sync)| -> DVec3 {
        let parts: Vec<DVec3> = (0..positions.len().div_ceil(CHUNK))
            .into_par_iter()
            .map(|c| (c * CHUNK..((c + 1) * CHUNK).min(positions.len())).map(f).sum())
            .collect();
        parts.into_iter().sum()
    };
    let centre = sum(&|i| positions[i].as_dvec3()) / n;
    let drift = sum(&|i| step[i].as_dvec3()) / n;
    let momentum = sum(&|i| (positions[i].as_dvec3() - centre).cross(step[i].as_dvec3() - drift));
    let squares = sum(&|i| {
        let r = positions[i].as_dvec3() - centre;
        r * r
    });
    let products = sum(&|i| {
        let r = positions[i].as_dvec3() - centre;
        DVec3::new(r.y * r.z, r.z * r.x, r.x * r.y)
    });
    let inertia = DMat3::from_cols(
        DVec3::new(squares.y + squares.z, -products.z, -products.y),
        DVec3::new(-products.z, squares.z + squares.x, -products.x),
        DVec3::new(-products.y, -products.x, squares.x + squares.y),
    );
    let spin = if inertia.determinant() > 1.0e-9 { inertia.inverse() * momentum } else { DVec3::ZERO };
    let (centre, drift, spin) = (centre.as_vec3a(), drift.as_vec3a(), spin.as_vec3a());
    step.par_iter_mut().zip(positions).with_min_len(CHUNK).for_each(|(d, x)| *d -= drift + spin.cross(*x - centre));
}

/// Guard: takes of the proposed step what stays injective. `backtracking` is kept from step to step. Returns the new
/// positions' largest motion in cells and what was held back.
pub fn guard_step<'a>(
    complex: &Complex,
    asked: &Asked,
    surfaces: impl Into<Checked<'a>>,
    positions: &mut Vec<Vec3A>,
    mut proposed: Vec<Vec3A>,
    backtracking: &mut Vec<u8>,
) -> (f32, Guarded) {
    let reach = match complex.dimension {
        Dimension::Two => FLAT_STEP_LIMIT,
        Dimension::Three => STEP_LIMIT,
    };
    guard::limit(positions, &mut proposed, |i| reach * asked.radius[i].min(1.0));
    let surfaces = surfaces.into();
    let extent = if surfaces.written.is_some() { Extent::Motion } else { Extent::End };
    let guarded = guard::guard(complex, surfaces, &asked.size, positions, &mut proposed, extent, backtracking);
    let motion = largest_motion(positions, &proposed);
    *positions = proposed;
    (motion, guarded)
}

/// How far any node moves from one state to another, in cells.
pub fn largest_motion(a: &[Vec3A], b: &[Vec3A]) -> f32 {
    a.par_iter().zip(b).with_min_len(CHUNK).map(|(a, b)| a.distance_squared(*b)).reduce(|| 0.0, f32::max).sqrt()
}
