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
    certificate::{Shell, certify, distortion, fidelity},
    collision::{
        Growth,
        areas::{AreaCorrection, Areas},
        grow,
        plugin::{
            BoundaryAtRisk, CollisionPlugin, CollisionProblem, Growing, Holds, Leap, Rotations, Shells, Sizes, Warped,
        },
    },
    diagnostics::Stopwatch,
    edge::plugin::{EdgePlugin, LinearSolution},
    film::{
        Film, Keyframe,
        plugin::{FilmPlugin, Reel},
    },
    importance::{
        self, asked_sizes,
        plugin::{Importance, ImportancePlugin},
    },
    reference::plugin::{ReferenceIterations, ReferencePlugin},
    transfer::{
        Binding, flat_boundary,
        plugin::{Bound, SelfIntersections, TransferPlugin},
    },
    voxel::{
        Complex, Flat, check_flat_resolution, check_resolution,
        plugin::{Lattice, PixelShares, SuspectedWelds, VoxelPlugin},
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
    pub complex: Arc<Complex>,
    /// B to C.
    pub binding: Arc<Binding>,
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
    let mut run = Run::new(domain)?;
    loop {
        observer.progress(&run.progress());
        if observer.cancelled() {
            return Err(Error::Cancelled);
        }
        if run.step()? {
            return run.solved();
        }
    }
}

/// One domain on its way, an iteration at a time.
pub struct Run {
    app: App,
    entity: Entity,
}

impl Run {
    /// A domain of which nothing is known yet.
    ///
    /// # Errors
    /// A resolution out of range.
    pub fn new(domain: Domain) -> Result<Self> {
        match domain.picture {
            None => check_resolution(domain.settings.resolution)?,
            Some(_) => check_flat_resolution(domain.settings.resolution)?,
        }
        let mut app = solver(domain.settings.reference);
        let entity = app.world_mut().spawn(domain).id();
        Ok(Self { app, entity })
    }

    /// Runs [`Solve`] once. Whether λ = 1 has settled.
    ///
    /// # Errors
    /// What a stage refuses.
    pub fn step(&mut self) -> Result<bool> {
        let world = self.app.world_mut();
        // Within rayon's pool: from outside, each of the many small loops would wait for another thread to wake.
        rayon::scope(|_| world.run_schedule(Solve));
        match world.resource_mut::<Failure>().0.take() {
            Some(error) => Err(error),
            None => Ok(world.get::<Growing>(self.entity).is_some_and(|g| g.0.done())),
        }
    }

    /// Where it is; the stage named is the one about to run.
    pub fn progress(&self) -> Progress {
        progress(self.app.world(), self.entity)
    }

    /// A component of the domain.
    pub fn get<C: Component>(&self) -> Option<&C> {
        self.app.world().get(self.entity)
    }

    /// Gives the domain components: what is there already no stage computes.
    pub fn insert(&mut self, components: impl Bundle) {
        self.app.world_mut().entity_mut(self.entity).insert(components);
    }

    /// Seconds per stage so far.
    pub fn seconds(&self) -> Vec<(&'static str, f64)> {
        self.app.world().resource::<Stopwatch>().seconds()
    }

    /// Takes another importance, with its linear solution, and other settings but for the resolution, and grows from rest
    /// again. What hangs on the lattice alone stays.
    pub fn restart(&mut self, domain: Domain, importance: Importance, linear: LinearSolution) {
        let mut entity = self.app.world_mut().entity_mut(self.entity);
        if let (Some(Lattice(complex)), Some(CollisionProblem(problem))) =
            (entity.get::<Lattice>(), entity.get::<CollisionProblem>())
        {
            let (complex, mut problem) = (complex.clone(), problem.clone());
            problem.importance = asked_sizes(&complex, &importance.cells);
            problem.fidelity = domain.settings.fidelity;
            problem.from = None;
            let growth = Growth::of(complex.dimension, domain.settings.keys, &problem.importance);
            entity.insert((CollisionProblem(problem), Growing(growth), Warped(complex.rest.clone())));
            let fresh = (Rotations::default(), Holds::default(), BoundaryAtRisk::default(), Leap::default());
            entity.insert(fresh).remove::<Reel>();
            correct_anew(&mut entity, &domain);
        }
        entity.insert((domain, importance, linear));
        *self.app.world_mut().resource_mut::<Stopwatch>() = Stopwatch::default();
    }

    /// The same without going back to rest: the present state, which is valid, is the first guess, and the sizes asked for
    /// go from what they are to what they will be. The film then begins at the present state. False, and nothing changes,
    /// where there is no state that could be gone on from.
    pub fn go_on(&mut self, domain: Domain, importance: Importance, linear: LinearSolution) -> bool {
        let mut entity = self.app.world_mut().entity_mut(self.entity);
        let Some(shells) = entity.get_mut::<Shells>().map(|mut shells| std::mem::take(&mut shells.0)) else {
            return false;
        };
        let start = (|| {
            let (Lattice(complex), CollisionProblem(problem)) = (entity.get()?, entity.get()?);
            let (Warped(warped), Sizes(sizes), Reel(film)) = (entity.get()?, entity.get()?, entity.get()?);
            let certificate = certify(complex, &shells, warped);
            if certificate.certified() {
                return Some((warped.clone(), certificate, sizes.size.clone()));
            }
            let last = film.keyframes().last().filter(|last| last.certificate.certified())?;
            let size = grow(complex, problem, last.lambda).size;
            Some((last.positions.clone(), last.certificate.clone(), size))
        })();
        let parts = entity.get::<Lattice>().zip(entity.get::<CollisionProblem>());
        let parts = parts.map(|(lattice, problem)| (lattice.0.clone(), problem.0.clone()));
        let ready = start.zip(parts).filter(|((_, _, size), (complex, _))| size.len() == complex.cells.len());
        entity.insert(Shells(shells));
        let Some(((positions, certificate, size), (complex, mut problem))) = ready else { return false };
        problem.importance = asked_sizes(&complex, &importance.cells);
        problem.fidelity = domain.settings.fidelity;
        let change = size.iter().zip(&problem.importance).map(|(a, b)| (b / a).ln().abs()).fold(0.0, f32::max);
        problem.from = Some(size);
        let mut film = Film::default();
        film.push(Keyframe { lambda: 0.0, positions: positions.clone(), certificate, way_is_clear: true });
        let growth = (Growing(Growth::change(complex.dimension, change)), Leap::default());
        entity.insert((CollisionProblem(problem), growth, Warped(positions), Reel(film)));
        correct_anew(&mut entity, &domain);
        entity.insert((domain, importance, linear));
        true
    }

    /// What came of it, once a [`step`](Self::step) has said that all is done. The film is mended.
    ///
    /// # Errors
    /// A fault, if it is not done.
    pub fn outcome(&mut self) -> Result<Outcome> {
        let (world, entity) = (self.app.world_mut(), self.entity);
        rayon::scope(|_| outcome(world, entity)).ok_or_else(|| Error::Fault("a solved domain lacks a component".into()))
    }

    /// The same with the states of the nodes.
    ///
    /// # Errors
    /// As [`outcome`](Self::outcome).
    pub fn solved(mut self) -> Result<Solved> {
        let outcome = self.outcome()?;
        let mut domain = self.app.world_mut().entity_mut(self.entity);
        let parts = (|| {
            let boundary = domain.get::<Domain>()?.boundary.clone();
            let (Lattice(complex), Bound(binding)) = (domain.take()?, domain.take()?);
            let (Shells(shells), Reel(film)) = (domain.take()?, domain.take()?);
            let (LinearSolution(linear), Importance { nodes: importance, .. }) = (domain.take()?, domain.take()?);
            Some(Solved { boundary, complex, binding, shells, film, linear, importance, outcome })
        })();
        parts.ok_or_else(|| Error::Fault("a solved domain lacks a component".into()))
    }
}

/// Areas of a picture's regions are corrected from the beginning, for what is asked of them now.
fn correct_anew(entity: &mut EntityWorldMut, domain: &Domain) {
    match domain.picture.as_ref().filter(|picture| picture.regions.is_some()) {
        Some(picture) => entity.insert(AreaCorrection::new(picture, &domain.boundary)),
        None => entity.remove::<AreaCorrection>(),
    };
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

fn outcome(world: &mut World, entity: Entity) -> Option<Outcome> {
    let mut watch = std::mem::take(&mut *world.resource_mut::<Stopwatch>());
    let mut shells = std::mem::take(&mut world.get_mut::<Shells>(entity)?.0);
    let mut film = std::mem::take(&mut world.get_mut::<Reel>(entity)?.0);
    let outcome = assemble(world, entity, &mut watch, &mut shells, &mut film);
    // A flat surface may follow the nodes otherwise than at first.
    if world.get::<PixelShares>(entity).is_some()
        && let Some(binding) = shells.iter().find_map(Shell::binding).cloned()
    {
        world.entity_mut(entity).insert(Bound(Arc::new(binding)));
    }
    // Given back: a change of importance goes on with them.
    world.entity_mut(entity).insert((Shells(shells), Reel(film)));
    world.insert_resource(watch);
    outcome
}

fn assemble(
    world: &World,
    entity: Entity,
    watch: &mut Stopwatch,
    shells: &mut [Shell],
    film: &mut Film,
) -> Option<Outcome> {
    let get = world.get_entity(entity).ok()?;
    let (domain, Lattice(complex), Bound(binding)) = (get.get::<Domain>()?, get.get::<Lattice>()?, get.get::<Bound>()?);
    let CollisionProblem(problem) = get.get::<CollisionProblem>()?;
    let (importance, linear) = (get.get::<Importance>()?, get.get::<LinearSolution>()?);

    let classic = watch.time("classic", || certify(complex, &shells[..1], &linear.0));
    if domain.settings.reference.is_none() {
        watch.time("certificate", || film.mend(complex, shells, &problem.importance));
    }
    let binding = shells.iter().find_map(Shell::binding).unwrap_or(binding);
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
    Some(Outcome {
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

/// A complex in numbers.
pub(crate) fn domain_summary(complex: &Complex, resolution: u32, suspected_welds: usize) -> DomainSummary {
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

/// The mesh a picture would be drawn on, what it is, and what would be voxelized. Importance and regions are not needed.
///
/// # Errors
/// As [`warp`].
pub fn inspect_picture(picture: &Flat, resolution: u32) -> Result<(Boundary, InputSummary, DomainSummary)> {
    check_flat_resolution(resolution)?;
    let complex = picture.lattice(resolution)?;
    let boundary = flat_boundary(&picture.name, &complex, picture.size);
    // The lattice's own triangles cross nowhere.
    let input = input_summary(&boundary, 0);
    Ok((boundary, input, domain_summary(&complex, resolution, 0)))
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
