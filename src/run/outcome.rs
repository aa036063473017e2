//! What came of a solve.

use std::sync::Arc;

use bevy::prelude::{Entity, World};
use glam::{DVec3, Vec3A};

use crate::{
    boundary::Boundary,
    certificate::{
        Certificate, Distortion, Fidelity, RegionFidelity, Surfaces, certify, distortion, fidelity,
        plugin::SelfIntersections,
    },
    collision::{
        areas::{AreaCorrection, Areas},
        plugin::CollisionProblem,
    },
    diagnostics::Stopwatch,
    edge::plugin::LinearSolution,
    film::{Film, Keyframe, plugin::Reel},
    importance::plugin::{DomainImportance, Importance},
    settings::Settings,
    transfer::{Binding, plugin::Bound},
    voxel::{
        Complex,
        plugin::{DomainBoundary, DomainPicture, Lattice, SuspectedWelds},
    },
};

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
    /// Pairs of triangles that cross or touch beyond what they share.
    pub self_intersections: usize,
}

/// What was voxelized.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DomainSummary {
    /// Cells along the longest axis.
    pub resolution: u32,
    /// h in source units.
    pub cell_size: f64,
    /// Inside cells.
    pub cells: usize,
    /// |V|.
    pub nodes: usize,
    /// |E|.
    pub edges: usize,
    /// |T|.
    pub elements: usize,
    /// Cells that may glue two sheets of the surface.
    pub suspected_welds: usize,
}

/// Counts of faults.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    /// Elements.
    pub inverted: usize,
    /// Pairs of faces of the complex's boundary.
    pub crossings: usize,
}

/// One state of the growth.
#[derive(Debug, Clone)]
pub struct Frame {
    /// λ.
    pub lambda: f32,
    /// B', `[vertices]`, source units.
    pub positions: Vec<DVec3>,
    /// What the check of this state found.
    pub certificate: Certificate,
}

/// All that came of it.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// What was read.
    pub input: InputSummary,
    /// What was voxelized.
    pub domain: DomainSummary,
    /// What Eq. 1 alone would give.
    pub classic: Option<Counts>,
    /// Of the last frame.
    pub certificate: Certificate,
    /// By ascending λ: the rest shape first, λ = 1 last.
    pub frames: Vec<Frame>,
    /// Size asked against size achieved.
    pub fidelity: Fidelity,
    /// Of shape.
    pub distortion: Distortion,
    /// Wall time per stage.
    pub seconds: Vec<(&'static str, f64)>,
    /// `[vertices]` importance.
    pub importance: Vec<f32>,
}

/// A solved domain: what came of it, and what it takes to show and check any state of its film.
#[derive(Debug, Clone)]
pub struct Solved {
    /// B; of a picture the flat mesh it is drawn on.
    pub boundary: Arc<Boundary>,
    /// C and C_t.
    pub complex: Arc<Complex>,
    /// B to C.
    pub binding: Arc<Binding>,
    /// Surfaces that must not cross, for [`certify`].
    pub surfaces: Surfaces,
    /// The node states.
    pub film: Film,
    /// V', `[nodes]`, in cells.
    pub linear: Vec<Vec3A>,
    /// `[nodes]` importance.
    pub importance: Vec<f32>,
    /// The rest.
    pub outcome: Outcome,
}

impl Solved {
    /// `[vertices]` B' at λ = 1, in the units of B.
    pub fn positions(&self) -> &[DVec3] {
        self.outcome.frames.last().map_or(&[], |frame| &frame.positions)
    }

    /// Whether every frame of the growth is certified.
    pub fn certified(&self) -> bool {
        self.outcome.certified()
    }
}

impl Outcome {
    /// Whether every frame is certified.
    pub fn certified(&self) -> bool {
        self.certificate.certified() && self.frames.iter().all(|frame| frame.certificate.certified())
    }
}

pub(super) fn outcome(world: &mut World, entity: Entity) -> Option<Outcome> {
    let mut watch = std::mem::take(&mut *world.resource_mut::<Stopwatch>());
    let (mut surfaces, Reel(mut film)) = world.entity_mut(entity).take::<(Surfaces, Reel)>()?;
    let outcome = assemble(world, entity, &mut watch, &mut surfaces, &mut film);
    let mut entity = world.entity_mut(entity);
    // A flat surface may follow the nodes otherwise than at first.
    if let Some(binding) = surfaces.binding().cloned() {
        entity.insert(Bound(binding));
    }
    // Given back: a change of importance goes on with them.
    entity.insert((surfaces, Reel(film)));
    world.insert_resource(watch);
    outcome
}

fn assemble(
    world: &World,
    entity: Entity,
    watch: &mut Stopwatch,
    surfaces: &mut Surfaces,
    film: &mut Film,
) -> Option<Outcome> {
    let get = world.get_entity(entity).ok()?;
    let (settings, DomainBoundary(boundary), Lattice(complex), Bound(binding)) =
        get.get_components::<(&Settings, &DomainBoundary, &Lattice, &Bound)>().ok()?;
    let (CollisionProblem(problem), importance, LinearSolution(linear)) =
        get.get_components::<(&CollisionProblem, &Importance, &LinearSolution)>().ok()?;
    let picture = get.get::<DomainPicture>().map(|picture| &picture.0);

    let classic = watch.time("classic", || certify(complex, surfaces.skin_alone(), linear));
    if settings.reference.is_none() {
        watch.time("certificate", || film.mend(complex, surfaces, &problem.importance));
    }
    let binding = surfaces.binding().unwrap_or(binding);
    let frames: Vec<Frame> = watch.time("transfer", || {
        let frame = |k: &Keyframe| Frame {
            lambda: k.lambda,
            positions: binding.apply(&k.positions),
            certificate: k.certificate.clone(),
        };
        film.keyframes().iter().map(frame).collect()
    });
    let last = film.keyframes().last()?;
    let regions = picture.map_or(boundary.regions.as_ref(), |picture| picture.regions.as_ref());
    let names = regions.map_or(&[][..], |r| &r.names);
    let (fidelity, distortion) = watch.time("fidelity", || {
        let asked = &importance.cells;
        (
            fidelity(complex, asked, &last.positions, settings.fidelity, names, &importance.region_of_cell),
            distortion(complex, &last.positions),
        )
    });
    let fidelity = match (get.get::<AreaCorrection>(), frames.last()) {
        (Some(correction), Some(Frame { positions, .. })) => {
            Fidelity { regions: flat_regions(correction, names, boundary, positions), ..fidelity }
        }
        _ => fidelity,
    };
    let (self_intersections, welds) = (get.get::<SelfIntersections>()?.0, get.get::<SuspectedWelds>()?.0);
    Some(Outcome {
        input: input_summary(boundary, self_intersections),
        domain: domain_summary(complex, settings.resolution, welds),
        classic: Some(Counts { inverted: classic.inverted(), crossings: classic.crossings() }),
        certificate: last.certificate.clone(),
        frames,
        fidelity,
        distortion,
        seconds: watch.seconds(),
        importance: match get.get::<DomainImportance>() {
            Some(DomainImportance(stack)) => stack.at_vertices(boundary),
            None => binding.of_nodes(&importance.nodes),
        },
    })
}

/// Regions of a picture, whose borders run through cells.
fn flat_regions(
    correction: &AreaCorrection,
    names: &[String],
    mesh: &Boundary,
    places: &[DVec3],
) -> Vec<RegionFidelity> {
    let areas = correction.pieces().areas(mesh, places);
    let size = |area: f64, rest: f64| (area / rest).sqrt();
    let region = |(name, a): (&String, Areas)| RegionFidelity {
        name: name.clone(),
        asked: size(a.asked, a.rest),
        achieved: size(a.achieved, a.rest),
    };
    names.iter().zip(areas).filter(|(_, a)| a.rest > 0.0).map(region).collect()
}

pub(super) fn input_summary(boundary: &Boundary, self_intersections: usize) -> InputSummary {
    let welded = boundary.welded();
    InputSummary {
        vertices: boundary.positions.len(),
        triangles: boundary.triangles.len(),
        components: boundary.components(&welded),
        boundary_loops: boundary.boundary_loops(&welded),
        self_intersections,
    }
}

/// A complex in numbers.
pub fn domain_summary(complex: &Complex, resolution: u32, suspected_welds: usize) -> DomainSummary {
    DomainSummary {
        resolution,
        cell_size: complex.grid.cell_size,
        cells: complex.cells.len(),
        nodes: complex.nodes(),
        edges: complex.edges(),
        elements: complex.elements(),
        suspected_welds,
    }
}
