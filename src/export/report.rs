//! The report: what was asked, achieved and proven, as JSON. Others script by these keys; they stay.

use std::io::Write as _;
use std::path::Path;

use serde::Serialize;
use serde_json::{Map, Value};

use crate::collision::areas::LEAST_CELLS;
use crate::diagnostics::peak_memory_bytes;
use crate::file::write_atomically;
use crate::importance::{Field, RegionArea, median_error, worst};
use crate::{Error, Result};
use crate::{
    run::{Counts, DomainSummary, InputSummary, Outcome},
    settings::{Reference, Settings},
};
use crate::{scene::Scene, voxel::memory_estimate};

/// All that is written about a run.
#[derive(Debug, Clone, Serialize)]
pub struct Report {
    /// The source as ordered.
    pub source: String,
    /// How it was warped.
    pub settings: SettingsReport,
    /// What was read.
    pub input: InputReport,
    /// What was voxelized.
    pub domain: DomainReport,
    /// Eq. 1 alone, where it was looked at.
    pub classic: Option<ClassicReport>,
    /// What was proven.
    pub certificate: CertificateReport,
    /// Size asked against size achieved.
    pub fidelity: FidelityReport,
    /// Conformal distortion, ≥ 1.
    pub distortion: DistortionReport,
    /// Of a picture with regions: their areas.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub areas: Option<AreaReport>,
    /// Wall time by stage.
    pub seconds: Map<String, Value>,
    /// The most memory the process held, where the system tells.
    pub peak_memory_bytes: Option<u64>,
    /// How many values of importance `--clamp` changed.
    pub clamped: usize,
    /// Sentences the user should read.
    pub warnings: Vec<String>,
    /// Version of this program.
    pub version: &'static str,
}

/// How it was warped.
#[derive(Debug, Clone, Serialize)]
pub struct SettingsReport {
    /// Cells along the longest axis.
    pub resolution: u32,
    /// μ
    pub fidelity: f32,
    /// Importance below all layers.
    pub base: f32,
    /// How many layers lie over it.
    pub layers: usize,
    /// Keyframes of the growth.
    pub keys: usize,
    /// `fig5`, `eq1` or null.
    pub reference: Option<&'static str>,
}

/// What was read.
#[derive(Debug, Clone, Serialize)]
pub struct InputReport {
    /// Vertices in the file.
    pub vertices: usize,
    /// Triangles, polygons being triangulated.
    pub triangles: usize,
    /// Connected pieces of surface.
    pub components: usize,
    /// Loops of edges with one triangle.
    pub boundary_loops: usize,
    /// Pairs of triangles that cross.
    pub self_intersections: usize,
}

/// What was voxelized.
#[derive(Debug, Clone, Serialize)]
pub struct DomainReport {
    /// Cells along the longest axis.
    pub resolution: u32,
    /// Edge of a cell in source units.
    pub cell_size: f64,
    /// Inside cells.
    pub cells: usize,
    /// Lattice nodes.
    pub nodes: usize,
    /// Lattice edges.
    pub edges: usize,
    /// Tetrahedra.
    pub elements: usize,
    /// Cells that may glue two sheets of the surface.
    pub suspected_welds: usize,
    /// Memory to warp it, about.
    pub memory_estimate_bytes: u64,
}

/// What Eq. 1 alone leaves broken.
#[derive(Debug, Clone, Serialize)]
pub struct ClassicReport {
    /// Inverted elements.
    pub inverted: usize,
    /// Pairs of boundary faces that cross.
    pub crossings: usize,
}

/// What was proven, over all frames: the greatest counts and the least ratio.
#[derive(Debug, Clone, Serialize)]
pub struct CertificateReport {
    /// Whether every frame is free of both.
    pub certified: bool,
    /// Inverted elements.
    pub inverted: usize,
    /// Pairs of the complex's boundary faces that cross.
    pub crossings: usize,
    /// Pairs of the warped mesh's own triangles that cross and did not in the input.
    pub surface_crossings: usize,
    /// Bodies that lie inside another body.
    pub enclosed: usize,
    /// Least volume of an element over its rest volume.
    pub min_volume_ratio: f64,
    /// Where the last frame is worst, in units of the file: a crossing, an inverted element, or the smallest one.
    pub worst: Option<[f64; 3]>,
    /// Each frame.
    pub frames: Vec<FrameReport>,
}

/// What was proven of one frame.
#[derive(Debug, Clone, Serialize)]
pub struct FrameReport {
    /// Growth.
    pub lambda: f32,
    /// Inverted elements.
    pub inverted: usize,
    /// Pairs of boundary faces that cross.
    pub crossings: usize,
    /// Pairs of the warped mesh's own triangles that cross and did not in the input.
    pub surface_crossings: usize,
}

/// Size asked against size achieved; errors are max(s/f, f/s) − 1.
#[derive(Debug, Clone, Serialize)]
pub struct FidelityReport {
    /// μ
    pub mu: f32,
    /// Half of the volume is nearer to the size asked for.
    pub median: f64,
    /// 95 % of the volume are nearer to it.
    pub p95: f64,
    /// The worst.
    pub max: f64,
    /// By named region.
    pub regions: Vec<RegionReport>,
}

/// A region's size.
#[derive(Debug, Clone, Serialize)]
pub struct RegionReport {
    /// Its name.
    pub name: String,
    /// Linear size factor asked for.
    pub asked: f64,
    /// Linear size factor achieved.
    pub achieved: f64,
}

/// Conformal distortion, ≥ 1.
#[derive(Debug, Clone, Serialize)]
pub struct DistortionReport {
    /// Half is less.
    pub median: f64,
    /// 95 % are less.
    pub p95: f64,
    /// 99 % are less.
    pub p99: f64,
}

/// Areas of a picture's regions, in pixels of the input.
#[derive(Debug, Clone, Serialize)]
pub struct AreaReport {
    /// |achieved / asked − 1| of the worst region that is not `unresolved`.
    pub worst: Option<WorstArea>,
    /// Median of the same.
    pub median_error: f64,
    /// Regions smaller than two cells: they have no cell of their own to grow by. More `--resolution` helps.
    pub unresolved: Vec<String>,
    /// Each region.
    pub regions: Vec<RegionArea>,
}

/// What is in a picture.
#[derive(Debug, Serialize)]
pub struct PictureReport {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Bits of a channel: 8 or 16.
    pub bits: u32,
    /// Pixels of the body: opaque enough, and not background.
    pub domain_pixels: usize,
    /// Whether a colour profile goes along.
    pub has_profile: bool,
    /// Names of the regions a built-in picture has.
    pub regions: Vec<String>,
}

/// The region that misses its area most.
#[derive(Debug, Clone, Serialize)]
pub struct WorstArea {
    /// Its name.
    pub name: String,
    /// |achieved / asked − 1|
    pub error: f64,
}

impl AreaReport {
    /// Of areas and the field they were asked by; `cell` is the area of a cell in pixels. Nothing without regions.
    pub fn of(areas: &[RegionArea], field: &Field, domain: &[bool], cell: f64) -> Option<Self> {
        let regions = field.regions.as_ref()?;
        let mut pixels = vec![0_u32; regions.names.len()];
        for (&region, _) in regions.of_pixel.iter().zip(domain).filter(|(_, inside)| **inside) {
            if let Some(count) = pixels.get_mut(region as usize) {
                *count += 1;
            }
        }
        let is_small = |name: &String| {
            let at = regions.names.iter().position(|n| n == name);
            at.is_some_and(|k| f64::from(pixels[k]) < LEAST_CELLS * cell)
        };
        let (small, resolved): (Vec<_>, Vec<_>) = areas.iter().cloned().partition(|a| is_small(&a.name));
        Some(Self {
            worst: worst(&resolved).map(|a| WorstArea { name: a.name.clone(), error: a.error() }),
            median_error: median_error(&resolved),
            unresolved: small.into_iter().map(|a| a.name).collect(),
            regions: areas.to_vec(),
        })
    }
}

impl Report {
    /// Adds the areas of a picture's regions; sizes of regions are told by them.
    pub fn take_areas(&mut self, areas: Option<AreaReport>) {
        if let Some(names) = areas.as_ref().map(|a| a.unresolved.join(", ")).filter(|names| !names.is_empty()) {
            self.warnings.push(format!(
                "smaller than two cells, so the size asked for is not reached: {names}; raise --resolution"
            ));
        }
        self.areas = areas;
    }

    /// The report of a run.
    pub fn of(scene: &Scene, settings: &Settings, clamped: usize, outcome: &Outcome, warnings: Vec<String>) -> Self {
        Self {
            source: scene.source.to_string(),
            settings: SettingsReport {
                resolution: settings.resolution,
                fidelity: settings.fidelity,
                base: scene.base,
                layers: scene.layers.len(),
                keys: settings.keys,
                reference: settings.reference.map(|reference| match reference {
                    Reference::Fig5 => "fig5",
                    Reference::Eq1 => "eq1",
                }),
            },
            input: (&outcome.input).into(),
            domain: (&outcome.domain).into(),
            classic: outcome
                .classic
                .as_ref()
                .map(|&Counts { inverted, crossings }| ClassicReport { inverted, crossings }),
            certificate: outcome.into(),
            fidelity: outcome.into(),
            distortion: outcome.into(),
            areas: None,
            seconds: outcome.seconds.iter().map(|(stage, seconds)| ((*stage).into(), (*seconds).into())).collect(),
            peak_memory_bytes: peak_memory_bytes(),
            clamped,
            warnings,
            version: env!("CARGO_PKG_VERSION"),
        }
    }

    /// Whether every frame is proven free of inverted elements and crossings.
    pub fn certified(&self) -> bool {
        self.certificate.certified
    }
}

/// Writes a report, whole or not at all.
///
/// # Errors
/// If the file cannot be written.
pub fn write(report: &Report, path: &Path) -> Result<()> {
    let mut text = serde_json::to_vec_pretty(report).map_err(|e| Error::Fault(format!("report to JSON: {e}")))?;
    text.push(b'\n');
    write_atomically(path, |file| file.write_all(&text))
}

impl From<&InputSummary> for InputReport {
    fn from(input: &InputSummary) -> Self {
        Self {
            vertices: input.vertices,
            triangles: input.triangles,
            components: input.components,
            boundary_loops: input.boundary_loops,
            self_intersections: input.self_intersections,
        }
    }
}

impl From<&DomainSummary> for DomainReport {
    fn from(domain: &DomainSummary) -> Self {
        Self {
            resolution: domain.resolution,
            cell_size: domain.cell_size,
            cells: domain.cells,
            nodes: domain.nodes,
            edges: domain.edges,
            elements: domain.elements,
            suspected_welds: domain.suspected_welds,
            memory_estimate_bytes: memory_estimate(domain.cells as f64) as u64,
        }
    }
}

impl From<&Outcome> for CertificateReport {
    fn from(outcome: &Outcome) -> Self {
        let all = || outcome.frames.iter().map(|frame| &frame.certificate).chain([&outcome.certificate]);
        let frames = outcome.frames.iter().map(|frame| FrameReport {
            lambda: frame.lambda,
            inverted: frame.certificate.inverted(),
            crossings: frame.certificate.crossings(),
            surface_crossings: frame.certificate.surface_crossings(),
        });
        Self {
            certified: all().all(|certificate| certificate.certified()),
            inverted: all().map(|certificate| certificate.inverted()).max().unwrap_or(0),
            crossings: all().map(|certificate| certificate.crossings()).max().unwrap_or(0),
            surface_crossings: all().map(|certificate| certificate.surface_crossings()).max().unwrap_or(0),
            enclosed: all().map(|certificate| certificate.enclosed()).max().unwrap_or(0),
            worst: outcome.certificate.worst().map(|at| at.to_array()),
            min_volume_ratio: all().map(|certificate| certificate.min_volume_ratio()).fold(f64::INFINITY, f64::min),
            frames: frames.collect(),
        }
    }
}

impl From<&Outcome> for FidelityReport {
    fn from(outcome: &Outcome) -> Self {
        let fidelity = &outcome.fidelity;
        let region = |region: &crate::certificate::RegionFidelity| RegionReport {
            name: region.name.clone(),
            asked: region.asked,
            achieved: region.achieved,
        };
        Self {
            mu: fidelity.mu,
            median: fidelity.median,
            p95: fidelity.p95,
            max: fidelity.max,
            regions: fidelity.regions.iter().map(region).collect(),
        }
    }
}

impl From<&Outcome> for DistortionReport {
    fn from(outcome: &Outcome) -> Self {
        let distortion = &outcome.distortion;
        Self { median: distortion.median, p95: distortion.p95, p99: distortion.p99 }
    }
}
