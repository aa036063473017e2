//! What a window is told about a solve.

use std::sync::Arc;

use glam::Vec3A;
use rayon::prelude::*;

use crate::{
    boundary::Boundary,
    certificate::{Certificate, volume_ratios},
    run::{DomainSummary, Outcome},
    transfer::Binding,
    voxel::Complex,
};

/// What the solver is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Phase {
    /// Nothing is open.
    #[default]
    Empty,
    /// Voxelizing, binding.
    Preparing,
    /// From the last valid state towards what is painted.
    Adapting,
    /// From rest to λ = 1: the film.
    Growing,
    /// Checking what is between the keyframes.
    Checking,
    /// All is there.
    Done,
    /// Stopped at the user's request.
    Stopped,
    /// It went wrong; see [`Snapshot::error`].
    Failed,
}

impl Phase {
    /// Whether the solver works.
    pub fn is_busy(self) -> bool {
        matches!(self, Self::Preparing | Self::Adapting | Self::Growing | Self::Checking)
    }
}

/// The latest of everything. Arrays are shared: the same `Arc` means the same content.
#[derive(Debug, Clone, Default)]
pub struct Snapshot {
    /// Rises with each snapshot.
    pub version: u64,
    /// Of which subject: the number of the order that gave it.
    pub opened: u64,
    /// Number of the last order that it takes into account; they rise.
    pub answers: u64,
    /// What the solver is doing.
    pub phase: Phase,
    /// λ of the state being solved, 0..=1.
    pub lambda: f32,
    /// Share of the present phase done, 0..=1.
    pub fraction: f32,
    /// 95th percentile of the size error of the state being solved, against what is asked for in the end.
    pub size_error_p95: Option<f64>,
    /// C and what ties the boundary to it, as soon as they are there.
    pub lattice: Option<Lattice>,
    /// `[nodes]` F.
    pub importance: Option<Arc<Vec<f32>>>,
    /// V', `[nodes]`, in cells.
    pub linear: Option<Arc<Vec<Vec3A>>>,
    /// V'' of the last valid state of this phase, `[nodes]`, in cells.
    pub warped: Option<Arc<Vec<Vec3A>>>,
    /// Keyframes so far by ascending λ, the rest state first. Of the importance before, until new ones come.
    pub film: Vec<State>,
    /// Whether the film is of the present importance.
    pub film_is_current: bool,
    /// What the last check found.
    pub certificate: Option<Certificate>,
    /// Size achieved over asked, elements counted.
    pub histogram: Option<Arc<Histogram>>,
    /// `[vertices]` size achieved over size asked, of the state the histogram counts.
    pub reached: Option<Arc<Vec<f32>>>,
    /// Seconds per stage.
    pub seconds: Vec<(&'static str, f64)>,
    /// All that came of it, once it is done.
    pub outcome: Option<Arc<Outcome>>,
    /// One sentence.
    pub error: Option<String>,
    /// Milliseconds from the last change of importance to its linear solution.
    pub dab_milliseconds: Option<f64>,
    /// How many orders have been answered with a linear solution so.
    pub dabs: u64,
}

/// What was voxelized.
#[derive(Debug, Clone)]
pub struct Lattice {
    /// B; of a picture the mesh it is drawn on, textured.
    pub boundary: Arc<Boundary>,
    /// C.
    pub complex: Arc<Complex>,
    /// B to C.
    pub binding: Arc<Binding>,
    /// In numbers.
    pub summary: DomainSummary,
}

/// A certified (or not) state of the film.
#[derive(Debug, Clone)]
pub struct State {
    /// λ, 0 = rest, 1 = all of it.
    pub lambda: f32,
    /// V'', `[nodes]`, in cells.
    pub positions: Arc<Vec<Vec3A>>,
    /// What the check found.
    pub certificate: Certificate,
}

impl Lattice {
    /// `[vertices]` size achieved over size asked for, > 0; `asked` is `[cells]`.
    ///
    /// Per cell the cube root of its volume (of a picture the square root of its area), averaged over the cells around each
    /// node, then over the nodes that carry a vertex.
    pub fn reached(&self, asked: &[f32], positions: &[Vec3A]) -> Vec<f32> {
        let (complex, binding) = (&*self.complex, &*self.binding);
        let volumes = volume_ratios(complex, positions);
        let of_cell: Vec<f32> = volumes
            .par_chunks(complex.dimension.elements().len())
            .zip(asked)
            .map(|(volumes, asked)| {
                let mean = volumes.iter().sum::<f32>() / volumes.len() as f32;
                complex.dimension.size(f64::from(mean.max(f32::MIN_POSITIVE))) as f32 / asked
            })
            .collect();
        let mean = |values: &mut dyn Iterator<Item = f32>| {
            let (sum, count) = values.fold((0.0, 0), |(sum, count), value| (sum + value, count + 1));
            if count > 0 { sum / count as f32 } else { 1.0 }
        };
        let of_node: Vec<f32> = complex
            .cells_around
            .par_iter()
            .map(|cells| mean(&mut cells.iter().filter(|&&c| c != u32::MAX).map(|&c| of_cell[c as usize])))
            .collect();
        let carried = |v: usize| binding.weights[v] != [0.0; 4];
        let of_vertex = |v: usize| mean(&mut binding.carriers(v as u32).map(|node| of_node[node as usize]));
        (0..binding.nodes.len()).into_par_iter().map(|v| if carried(v) { of_vertex(v) } else { 1.0 }).collect()
    }
}

/// How many elements have which size, achieved over asked.
#[derive(Debug, Clone, PartialEq)]
pub struct Histogram {
    /// Elements per bin; the bins are even in the logarithm from ×½ to ×2, the outermost hold what lies beyond.
    pub counts: Vec<u32>,
}

impl Histogram {
    /// Number of bins: odd, so that one of them is "just right".
    pub const BINS: usize = 41;

    /// Counts the elements of a state; `asked` is `[cells]`.
    pub fn new(complex: &Complex, asked: &[f32], positions: &[Vec3A]) -> Self {
        let mut counts = vec![0; Self::BINS];
        let per_cell = complex.dimension.elements().len();
        for (t, volume) in volume_ratios(complex, positions).into_iter().enumerate() {
            let size = complex.dimension.size(f64::from(volume.max(f32::MIN_POSITIVE))) as f32;
            let octaves = (size / asked[t / per_cell]).log2();
            let bin = ((octaves + 1.0) * 0.5 * Self::BINS as f32).clamp(0.0, Self::BINS as f32 - 1.0);
            counts[bin as usize] += 1;
        }
        Self { counts }
    }

    /// Middle of a bin: size achieved over asked, in octaves, −1..1.
    pub fn octaves(bin: usize) -> f64 {
        (bin as f64 + 0.5) / Self::BINS as f64 * 2.0 - 1.0
    }
}
