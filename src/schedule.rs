//! THE order of the method: one schedule, its stages in words, and who runs it.
//!
//! ```text
//! Voxelize → Importance → EdgeSolve → [ Grow → Local → Contact → Global → Guard → Certify ]*
//!                                       └ Bind, once ┘
//! ```
//!
//! A domain is an entity; stages give it components (arrays over nodes, cells and edges of its lattice) and each run of
//! [`Solve`] takes it one iteration further. A stage whose input is not there yet, or whose output is, does nothing.

use std::sync::Arc;

use bevy::{
    ecs::schedule::{LogLevel, ScheduleBuildSettings, ScheduleLabel, SingleThreadedExecutor},
    prelude::*,
};
use glam::{DVec3, Vec3A};

pub use crate::certificate::{Certificate, Distortion, Fidelity, RegionFidelity};
use crate::{
    Error, Result,
    boundary::Boundary,
    certificate::{certify, distortion, fidelity},
    collision::{
        Shell,
        areas::{AreaCorrection, Areas},
        plugin::{CollisionPlugin, CollisionProblem, Growing, Shells, Warped},
    },
    diagnostics::Stopwatch,
    edge::plugin::{EdgePlugin, LinearSolution},
    film::{
        Film, Keyframe,
        plugin::{FilmPlugin, Reel},
    },
    importance::{
        self,
        plugin::{Importance, ImportancePlugin},
    },
    reference::plugin::{ReferenceIterations, ReferencePlugin},
    scene::{check_flat_resolution, check_resolution},
    transfer::{
        Binding,
        plugin::{Bound, SelfIntersections, TransferPlugin},
    },
    voxel::{
        Complex, Flat,
        plugin::{Lattice, SuspectedWelds, VoxelPlugin},
        suspected_welds, voxelize,
    },
};

/// The schedule that takes every domain one iteration further.
#[derive(ScheduleLabel, Debug, Clone, PartialEq, Eq, Hash)]
pub struct Solve;

/// Its stages, in this order.
#[derive(SystemSet, Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Stage {
    /// 3.2: boundary to lattice.
    Voxelize,
    /// 3.2: importance onto nodes and edges.
    Importance,
    /// 3.3: Eq. 1.
    EdgeSolve,
    /// 3.3: the next λ.
    Grow,
    /// 3.5: barycentric coordinates of the boundary, once.
    Bind,
    /// 3.3: targets of the cells.
    Local,
    /// 3.3: pairs that are too close.
    Contact,
    /// 3.3: Eq. 2's linear solve.
    Global,
    /// What of the step stays injective.
    Guard,
    /// Keyframes and their certificates.
    Certify,
}

/// What to warp: the entity's first component.
#[derive(Component, Debug, Clone)]
pub struct Domain {
    /// B. Of a picture the flat mesh it is drawn on, which comes with the lattice.
    pub boundary: Arc<Boundary>,
    /// F, as a function of the surface; a picture brings its own.
    pub importance: Arc<importance::Stack>,
    /// The picture, where it is one that is warped.
    pub picture: Option<Arc<Flat>>,
    /// How.
    pub settings: Settings,
}

impl Domain {
    /// A body.
    pub fn body(boundary: Arc<Boundary>, importance: Arc<importance::Stack>, settings: Settings) -> Self {
        Self { boundary, importance, picture: None, settings }
    }

    /// A picture.
    pub fn picture(picture: Arc<Flat>, settings: Settings) -> Self {
        Self { boundary: Arc::default(), importance: Arc::default(), picture: Some(picture), settings }
    }
}

/// The first error a stage met; solving stops.
#[derive(Resource, Debug, Default)]
pub struct Failure(pub Option<Error>);

/// Declares [`Solve`] and its order.
pub struct SolveSchedulePlugin;

impl Plugin for SolveSchedulePlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Stopwatch>().init_resource::<Failure>().init_schedule(Solve).edit_schedule(
            Solve,
            |schedule| {
                schedule
                    // Stages are parallel inside (rayon), one after the other outside.
                    .set_executor(SingleThreadedExecutor::new())
                    .set_build_settings(ScheduleBuildSettings { ambiguity_detection: LogLevel::Error, ..default() })
                    .configure_sets(
                        (
                            Stage::Voxelize,
                            Stage::Importance,
                            Stage::EdgeSolve,
                            Stage::Grow,
                            Stage::Bind,
                            Stage::Local,
                            Stage::Contact,
                            Stage::Global,
                            Stage::Guard,
                            Stage::Certify,
                        )
                            .chain(),
                    );
            },
        );
    }
}

/// An app with the stages of the method, or of a reference solver in their place.
pub fn solver(reference: Option<Reference>) -> App {
    let mut app = App::new();
    app.add_plugins((SolveSchedulePlugin, VoxelPlugin, ImportancePlugin, EdgePlugin, TransferPlugin));
    match reference {
        None => app.add_plugins((CollisionPlugin, FilmPlugin)),
        Some(reference) => app.add_plugins(ReferencePlugin(reference)),
    };
    app.finish();
    app.cleanup();
    app
}

/// Which of the paper's own solvers to run for comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reference {
    /// Edge optimization alone.
    Eq1,
    /// Collision optimization as in Fig. 5, read sensibly.
    Fig5,
}

/// How to warp.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Cells along the longest axis.
    pub resolution: u32,
    /// μ in 0..=1: 0 keeps shape, 1 reaches the asked size.
    pub fidelity: f32,
    /// Keyframes of the growth after the rest shape, ≥ 1; more where a blend between two would not be valid.
    pub keys: usize,
    /// Run a reference solver instead.
    pub reference: Option<Reference>,
}

/// Where the engine is.
#[derive(Debug, Clone, Copy)]
pub struct Progress {
    /// The stage's name.
    pub stage: &'static str,
    /// λ, 0..=1.
    pub lambda: f32,
    /// 95th percentile of the size error against what is asked for at λ = 1.
    pub size_error_p95: f32,
    /// Share of the whole work done, 0..=1.
    pub fraction: f32,
}

/// Who watches the engine.
pub trait Observer: Sync {
    /// Called between iterations.
    fn progress(&self, p: &Progress);
    /// Whether to stop; asked between iterations.
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
    pub complex: Complex,
    /// B to C.
    pub binding: Binding,
    /// Surfaces that must not cross, for [`certify`]: the complex's skin first.
    pub shells: Vec<Shell>,
    /// The node states.
    pub film: Film,
    /// V', `[nodes]`, in cells.
    pub linear: Vec<Vec3A>,
    /// `[nodes]` importance.
    pub importance: Vec<f32>,
    /// The rest.
    pub outcome: Outcome,
}

/// Warps a boundary: runs [`Solve`] until λ = 1 has settled, and hands out the film.
///
/// # Errors
/// [`Error::Cancelled`] when the observer says so; [`Error::Input`] for a boundary without extent or a resolution out
/// of range.
pub fn warp(
    boundary: &Boundary,
    importance: &importance::Stack,
    settings: &Settings,
    observer: &dyn Observer,
) -> Result<Outcome> {
    solve(boundary, importance, settings, observer).map(|solved| solved.outcome)
}

/// As [`warp`], with the states of the nodes.
///
/// # Errors
/// As [`warp`].
pub fn solve(
    boundary: &Boundary,
    importance: &importance::Stack,
    settings: &Settings,
    observer: &dyn Observer,
) -> Result<Solved> {
    let domain = Domain::body(Arc::new(boundary.clone()), Arc::new(importance.clone()), settings.clone());
    solve_domain(domain, observer)
}

/// As [`solve`], of a body or a picture.
///
/// # Errors
/// As [`warp`].
pub fn solve_domain(domain: Domain, observer: &dyn Observer) -> Result<Solved> {
    let settings = &domain.settings;
    match domain.picture {
        None => check_resolution(settings.resolution)?,
        Some(_) => check_flat_resolution(settings.resolution)?,
    }
    let mut app = solver(settings.reference);
    let world = app.world_mut();
    let entity = world.spawn(domain).id();
    loop {
        observer.progress(&progress(world, entity));
        if observer.cancelled() {
            return Err(Error::Cancelled);
        }
        world.run_schedule(Solve);
        if let Some(error) = world.resource_mut::<Failure>().0.take() {
            return Err(error);
        }
        if world.get::<Growing>(entity).is_some_and(|g| g.0.done()) {
            break;
        }
    }
    solved(world, entity).ok_or_else(|| Error::Fault("a solved domain lacks a component".into()))
}

/// Where a domain is; the stage named is the one about to run.
fn progress(world: &World, entity: Entity) -> Progress {
    let at = |stage, fraction| Progress { stage, lambda: 0.0, size_error_p95: f32::NAN, fraction };
    if world.get::<Lattice>(entity).is_none() {
        return at("voxelize", 0.0);
    }
    let Some(Growing(growth)) = world.get::<Growing>(entity) else { return at("edge", 0.01) };
    if let Some(ReferenceIterations(done)) = world.get(entity) {
        let fraction = *done as f32 / crate::reference::ITERATIONS as f32;
        return Progress { lambda: fraction, ..at("fig5", fraction) };
    }
    let size_error_p95 =
        match (world.get::<Lattice>(entity), world.get::<CollisionProblem>(entity), world.get::<Warped>(entity)) {
            (Some(Lattice(complex)), Some(CollisionProblem(problem)), Some(Warped(positions)))
                if growth.is_new_step() =>
            {
                fidelity(complex, &problem.importance, positions, problem.fidelity, &[], &[]).p95 as f32
            }
            _ => f32::NAN,
        };
    let (stage, lambda) = if growth.lambda() < 1.0 { ("growth", growth.lambda()) } else { ("settling", 1.0) };
    Progress { stage, lambda, size_error_p95, fraction: growth.fraction() }
}

fn solved(world: &mut World, entity: Entity) -> Option<Solved> {
    let mut watch = world.remove_resource::<Stopwatch>()?;
    let mut shells = std::mem::take(&mut world.get_mut::<Shells>(entity)?.0);
    let mut film = std::mem::take(&mut world.get_mut::<Reel>(entity)?.0);
    let get = world.get_entity(entity).ok()?;
    let (domain, Lattice(complex), Bound(binding)) = (get.get::<Domain>()?, get.get::<Lattice>()?, get.get::<Bound>()?);
    let CollisionProblem(problem) = get.get::<CollisionProblem>()?;
    let (importance, linear) = (get.get::<Importance>()?, get.get::<LinearSolution>()?);

    let classic = watch.time("classic", || certify(complex, &shells[..1], &linear.0));
    let mut binding = binding.clone();
    if domain.settings.reference.is_none() {
        watch.time("certificate", || film.mend(complex, &mut shells, &problem.importance));
    }
    // A flat surface may follow the nodes otherwise than at first.
    if let Some(straightened) = shells.iter().find_map(Shell::binding).filter(|_| domain.picture.is_some()) {
        binding = straightened.clone();
    }
    let frames: Vec<Frame> = watch.time("transfer", || {
        let frame = |k: &Keyframe| Frame {
            lambda: k.lambda,
            positions: binding.apply(&k.positions),
            certificate: k.certificate.clone(),
        };
        film.keyframes().iter().map(frame).collect()
    });
    let last = film.keyframes().last()?;
    let regions = match &domain.picture {
        Some(picture) => picture.regions.as_ref(),
        None => domain.boundary.regions.as_ref(),
    };
    let names = regions.map_or(&[][..], |r| &r.names);
    let (fidelity, distortion) = watch.time("fidelity", || {
        let asked = &importance.cells;
        (
            fidelity(complex, asked, &last.positions, problem.fidelity, names, &importance.region_of_cell),
            distortion(complex, &last.positions),
        )
    });
    let fidelity = match (get.get::<AreaCorrection>(), frames.last()) {
        (Some(correction), Some(Frame { positions, .. })) => {
            Fidelity { regions: flat_regions(correction, names, &domain.boundary, positions), ..fidelity }
        }
        _ => fidelity,
    };
    let boundary = &domain.boundary;
    let (self_intersections, welds) = (get.get::<SelfIntersections>()?.0, get.get::<SuspectedWelds>()?.0);
    let outcome = Outcome {
        input: input_summary(boundary, self_intersections),
        domain: domain_summary(complex, domain.settings.resolution, welds),
        classic: Some(Counts { inverted: classic.inverted(), crossings: classic.crossings() }),
        certificate: last.certificate.clone(),
        frames,
        fidelity,
        distortion,
        seconds: watch.seconds(),
        importance: match &domain.picture {
            Some(_) => binding.of_nodes(&importance.nodes),
            None => domain.importance.at_vertices(boundary),
        },
    };
    let boundary = domain.boundary.clone();
    let mut domain = world.entity_mut(entity);
    let Lattice(complex) = domain.take()?;
    let (LinearSolution(linear), Importance { nodes: importance, .. }) = (domain.take()?, domain.take()?);
    Some(Solved { boundary, complex, binding, shells, film, linear, importance, outcome })
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

fn input_summary(boundary: &Boundary, self_intersections: usize) -> InputSummary {
    let welded = boundary.welded();
    InputSummary {
        vertices: boundary.positions.len(),
        triangles: boundary.triangles.len(),
        components: boundary.components(&welded),
        boundary_loops: boundary.boundary_loops(&welded),
        self_intersections,
    }
}

fn domain_summary(complex: &Complex, resolution: u32, suspected_welds: usize) -> DomainSummary {
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

/// What is in a boundary and what would be voxelized.
///
/// # Errors
/// As [`warp`].
pub fn inspect(boundary: &Boundary, resolution: u32) -> Result<(InputSummary, DomainSummary)> {
    check_resolution(resolution)?;
    let complex = voxelize(boundary, resolution)?;
    let shell = Shell::boundary(boundary, Binding::new(boundary, &complex), &complex);
    let welds = suspected_welds(boundary, &boundary.welded(), &complex);
    Ok((input_summary(boundary, shell.inherited()), domain_summary(&complex, resolution, welds)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_systems_of_the_schedule_are_ambiguous() {
        for reference in [None, Some(Reference::Eq1), Some(Reference::Fig5)] {
            let mut app = solver(reference);
            app.world_mut().schedule_scope(Solve, |world, schedule| {
                schedule.initialize(world).expect("buildable");
                assert_eq!(schedule.graph().conflicting_systems().len(), 0, "{reference:?}");
            });
        }
    }
}
