//! STUB of the engine's interface.

use crate::boundary::Boundary;
use crate::diagnostics::Stopwatch;
use crate::importance;
use crate::{Error, Result};
use glam::DVec3;

/// Which of the paper's own solvers to run for comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reference {
    /// Edge optimization alone.
    Eq1,
    /// Collision optimization as printed in Fig. 5, read sensibly.
    Fig5,
}

/// How to warp.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Cells along the longest axis.
    pub resolution: u32,
    /// μ
    pub fidelity: f32,
    /// Keyframes of the growth, the rest pose not counted.
    pub keys: usize,
    /// Run a reference solver instead.
    pub reference: Option<Reference>,
}

/// Where the engine is.
#[derive(Debug, Clone, Copy)]
pub struct Progress {
    /// The stage's name.
    pub stage: &'static str,
    /// Growth.
    pub lambda: f32,
    /// 95th percentile of the size error.
    pub size_error_p95: f32,
    /// Share of the whole work done, 0..=1.
    pub fraction: f32,
}

/// Who watches the engine.
pub trait Observer: Sync {
    /// Called often.
    fn progress(&self, p: &Progress);
    /// Whether to stop.
    fn cancelled(&self) -> bool;
}

/// What was read.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct InputSummary {
    /// Vertices.
    pub vertices: usize,
    /// Triangles.
    pub triangles: usize,
    /// Connected components.
    pub components: usize,
    /// Loops of edges with one triangle.
    pub boundary_loops: usize,
    /// Pairs of triangles that cross.
    pub self_intersections: usize,
}

/// What was voxelized.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DomainSummary {
    /// Cells along the longest axis.
    pub resolution: u32,
    /// Source units.
    pub cell_size: f64,
    /// Inside cells.
    pub cells: usize,
    /// Nodes.
    pub nodes: usize,
    /// Edges.
    pub edges: usize,
    /// Tetrahedra.
    pub elements: usize,
    /// Cells that hold two sheets.
    pub suspected_welds: usize,
}

/// Counts of faults.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    /// Elements.
    pub inverted: usize,
    /// Pairs of faces.
    pub crossings: usize,
}

/// STUB
#[derive(Debug, Clone, PartialEq)]
pub struct Certificate {
    crossings: usize,
}

impl Certificate {
    /// STUB
    pub fn certified(&self) -> bool {
        self.crossings == 0
    }
    /// STUB
    pub fn inverted(&self) -> usize {
        0
    }
    /// STUB
    pub fn crossings(&self) -> usize {
        self.crossings
    }
    /// STUB
    pub fn surface_crossings(&self) -> usize {
        0
    }
    /// STUB
    pub fn min_volume_ratio(&self) -> f64 {
        1.0
    }
}

/// One certified state.
#[derive(Debug, Clone)]
pub struct Frame {
    /// λ
    pub lambda: f32,
    /// B'
    pub positions: Vec<DVec3>,
    /// Its check.
    pub certificate: Certificate,
}

/// Asked against achieved.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Fidelity {
    /// μ
    pub mu: f32,
    /// Size error.
    pub median: f64,
    /// Size error.
    pub p95: f64,
    /// Size error.
    pub max: f64,
    /// By region.
    pub regions: Vec<RegionFidelity>,
}

/// A region's size.
#[derive(Debug, Clone, PartialEq)]
pub struct RegionFidelity {
    /// Name.
    pub name: String,
    /// Factor.
    pub asked: f64,
    /// Factor.
    pub achieved: f64,
}

/// Conformal distortion.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Distortion {
    /// ≥ 1
    pub median: f64,
    /// ≥ 1
    pub p95: f64,
    /// ≥ 1
    pub p99: f64,
}

/// All that came of it.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// Input.
    pub input: InputSummary,
    /// Domain.
    pub domain: DomainSummary,
    /// Eq. 1 alone.
    pub classic: Option<Counts>,
    /// Of the last frame.
    pub certificate: Certificate,
    /// Rest first, λ = 1 last.
    pub frames: Vec<Frame>,
    /// Size.
    pub fidelity: Fidelity,
    /// Shape.
    pub distortion: Distortion,
    /// Per stage.
    pub seconds: Vec<(&'static str, f64)>,
    /// Per boundary vertex.
    pub importance: Vec<f32>,
}

/// STUB
///
/// # Errors
/// Cancelled.
pub fn warp(b: &Boundary, f: &importance::Stack, s: &Settings, observer: &dyn Observer) -> Result<Outcome> {
    let (input, domain) = inspect(b, s.resolution)?;
    let mut watch = Stopwatch::default();
    let importance = watch.time("importance", || f.at_vertices(b));
    let crossings = usize::from(s.reference.is_some() && importance.iter().any(|f| *f > 1.5));
    let certificate = Certificate { crossings };
    let steps = 2 * s.resolution;
    for step in 0..steps {
        let fraction = step as f32 / steps as f32;
        observer.progress(&Progress { stage: "collision", lambda: fraction, size_error_p95: 0.1, fraction });
        if observer.cancelled() {
            return Err(Error::Cancelled);
        }
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let frame = |k: usize| Frame {
        lambda: k as f32 / s.keys as f32,
        positions: b.positions.clone(),
        certificate: certificate.clone(),
    };
    Ok(Outcome {
        input,
        domain,
        classic: None,
        certificate: certificate.clone(),
        frames: (0..=s.keys).map(frame).collect(),
        fidelity: Fidelity { mu: s.fidelity, ..Default::default() },
        distortion: Distortion { median: 1.0, p95: 1.0, p99: 1.0 },
        seconds: watch.seconds(),
        importance,
    })
}

/// STUB
///
/// # Errors
/// Never.
pub fn inspect(b: &Boundary, resolution: u32) -> Result<(InputSummary, DomainSummary)> {
    let input =
        InputSummary { vertices: b.positions.len(), triangles: b.triangles.len(), components: 1, ..Default::default() };
    Ok((input, DomainSummary { resolution, cell_size: 1.0, ..Default::default() }))
}
