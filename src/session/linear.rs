//! Importance to linear solution, again and again on one lattice.

use std::sync::Arc;

use glam::Vec3A;

use super::Subject;
use crate::{
    edge::EdgeSolver,
    importance::{Sampling, Spread, cell_importance, node_importance, plugin::Importance},
    voxel::{Complex, Flat, Shares},
};

/// Everything between a stroke and V' that depends on the lattice alone, and the last results to start from.
pub struct Linear {
    /// Of a surface; pictures ask their pixels.
    surface: Option<Surface>,
    edge: EdgeSolver,
    /// V' of the last importance, `[nodes]`, in cells.
    solution: Vec<Vec3A>,
}

struct Surface {
    sampling: Sampling,
    spread: Spread,
    /// `[cells]` region, or empty.
    regions: Vec<u32>,
}

/// What is asked of a lattice.
#[derive(Debug, Clone, Default)]
pub struct Asked {
    /// By nodes and cells.
    pub importance: Importance,
    /// Of a picture: its pixels, painted, and what regions have of its cells.
    pub pixels: Option<(Arc<Flat>, Shares)>,
}

impl Linear {
    /// Prepares for a subject and its complex.
    pub fn new(subject: &Subject, complex: &Complex) -> Self {
        let surface = subject.picture.is_none().then(|| {
            let sampling = Sampling::new(&subject.boundary, complex);
            Surface {
                spread: Spread::new(&sampling, complex),
                regions: sampling.regions(&subject.boundary, complex),
                sampling,
            }
        });
        Self { surface, edge: EdgeSolver::new(complex), solution: complex.rest.clone() }
    }

    /// What the subject asks for, and V' in cells.
    pub fn solve(&mut self, subject: &Subject, complex: &Complex) -> (Asked, &[Vec3A]) {
        let asked = match (&mut self.surface, &subject.picture) {
            (_, Some(picture)) => {
                let flat = picture.flat();
                let shares = flat.shares(complex);
                let cells = shares.sizes(&[]);
                let nodes = node_importance(complex, &cells);
                let importance = Importance { nodes, cells, region_of_cell: shares.regions() };
                Asked { importance, pixels: Some((flat, shares)) }
            }
            (Some(Surface { sampling, spread, regions }), None) => {
                let values = subject.importance.evaluate(&subject.boundary, &sampling.samples);
                let nodes = spread.solve(sampling, &values);
                let importance =
                    Importance { cells: cell_importance(complex, &nodes), nodes, region_of_cell: regions.clone() };
                Asked { importance, pixels: None }
            }
            (None, None) => Asked::default(),
        };
        self.edge.solve(complex, &asked.importance.nodes, &mut self.solution);
        (asked, &self.solution)
    }
}
