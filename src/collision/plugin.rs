//! Grow, flow in the plane, local, contact, global, guard: one iteration of the collision optimization per run of the
//! schedule.

use std::sync::Arc;

use bevy::prelude::*;
use glam::{Mat3A, Quat, Vec3A};
use rayon::prelude::*;

use super::{
    Asked, CellEnergy, Contacts, Flow, Growth, Guarded, Mixture, Problem, Trail,
    areas::{AreaCorrection, Corrected},
    contact, contact_step, flow, global_step, grow, guard_step, largest_motion, local_step, near_step,
};
use crate::{
    certificate::{CarriedState, Surfaces},
    diagnostics::Stopwatch,
    edge::plugin::LinearSolution,
    importance::{asked_sizes, plugin::Importance, smoothed},
    schedule::{Failed, Solve, Stage},
    settings::Settings,
    voxel::{
        CHUNK, Dimension, blend,
        plugin::{DomainBoundary, DomainPicture, Lattice, PixelShares},
    },
};

/// What the collision optimization of a domain is about.
#[derive(Component, Debug)]
pub struct CollisionProblem(pub Problem);

/// Where its growth is.
#[derive(Component, Debug)]
pub struct Growing(pub Growth);

/// Sizes and radii asked for at the present λ.
#[derive(Component, Debug, Default)]
pub struct Sizes(pub Asked);

/// `[cells]` R_c.
#[derive(Component, Debug, Default)]
pub struct Rotations(pub Vec<Quat>);

/// `[cells]` A_c.
#[derive(Component, Debug, Default)]
pub struct Targets(pub Vec<Mat3A>);

/// Pairs of boundary nodes that are too close.
#[derive(Component, Debug, Default)]
pub struct Touching(pub Contacts);

/// `[nodes]` where the global step would like to go.
#[derive(Component, Debug, Default)]
pub struct Proposed(pub Vec<Vec3A>);

/// V'', `[nodes]`, in cells: always a valid state.
#[derive(Component, Debug)]
pub struct Warped(pub Vec<Vec3A>);

/// An extrapolated step to the next keyframe, while nobody has looked whether it is valid.
#[derive(Component, Debug, Default)]
pub struct ExtrapolatedStep {
    /// `[nodes]` where it is now; V'' stays at the last keyframe meanwhile.
    pub positions: Vec<Vec3A>,
    /// Pairs of boundary nodes that were near each other when it began.
    pub near: Vec<(u32, u32)>,
    /// The last keyframe, if an extrapolated step ended there.
    pub start: Option<CarriedState>,
    /// λ and `[nodes]` positions of the keyframe before the last.
    pub before: Option<(f32, Vec<Vec3A>)>,
}

/// Whether the boundary as it will be written is guarded in every iteration, and not only when a keyframe is made: once
/// it had to be drawn back, it will have to be again, and many small corrections are better than few large ones.
#[derive(Component, Debug, Default)]
pub struct BoundaryAtRisk(pub bool);

/// `[nodes]` how often the guard halved each node's last step.
#[derive(Component, Debug, Default)]
pub struct Backtracking(pub Vec<u8>);

/// What the guard held back in the last iteration.
#[derive(Component, Debug, Default)]
pub struct Backtracked(pub Guarded);

/// Marks domains that are led by a flow: maps, whose areas matter more than the shape of a cell. Where single parts of
/// a picture grow, the teeth of a crocodile, a flow gives them their area and takes their outline.
#[derive(Component, Debug)]
pub struct Flowing(pub Flow);

/// From where growth begins when something else is asked for. Set anew, it begins again.
#[derive(Component, Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Start {
    /// From the rest shape.
    #[default]
    Rest,
    /// From the present state, if it is valid, or the last one that is; else from rest.
    Present,
}

/// A valid state that growth goes on from, once; from rest where there is none.
#[derive(Component, Debug, Default)]
pub struct Resume(pub Option<Valid>);

/// Marks domains whose growth went on from a valid state rather than from rest.
#[derive(Component, Debug)]
pub struct Resumed;

/// A valid state.
#[derive(Debug)]
pub struct Valid {
    /// `[nodes]` in cells.
    pub positions: Vec<Vec3A>,
    /// `[cells]` sizes that it was asked for.
    pub size: Vec<f32>,
}

/// Adds the stages.
#[derive(Debug, Clone, Copy)]
pub struct CollisionPlugin {
    /// What the cells of a domain would like to be.
    pub energy: fn(&Settings) -> Arc<dyn CellEnergy>,
}

impl Default for CollisionPlugin {
    fn default() -> Self {
        Self { energy: |settings| Arc::new(Mixture::from(settings)) }
    }
}

/// The energies of new domains.
#[derive(Resource, Debug)]
struct Energies(fn(&Settings) -> Arc<dyn CellEnergy>);

impl Plugin for CollisionPlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(Energies(self.energy)).add_systems(
            Solve,
            (
                (begin, grow_sizes, lead, extrapolate).chain().in_set(Stage::Grow),
                fit_cells.in_set(Stage::Local),
                find_contacts.in_set(Stage::Contact),
                propose.in_set(Stage::Global),
                (accept, correct_areas).chain().in_set(Stage::Guard),
            ),
        );
    }
}

type Renewed = (Without<Failed>, Or<(Changed<LinearSolution>, Changed<Settings>, Changed<Start>)>);

type Asking<'a> = (
    Entity,
    &'a Settings,
    &'a DomainBoundary,
    Option<&'a DomainPicture>,
    &'a Lattice,
    &'a Importance,
    Option<&'a mut CollisionProblem>,
    Option<&'a mut Resume>,
);

/// Begins to grow, from rest or from a state that is valid, whenever something else is asked for.
fn begin(
    mut commands: Commands,
    mut domains: Query<Asking, Renewed>,
    energies: Res<Energies>,
    mut watch: ResMut<Stopwatch>,
) {
    for (entity, settings, DomainBoundary(boundary), picture, Lattice(complex), importance, problem, resume) in
        &mut domains
    {
        let mut entity = commands.entity(entity);
        let regional = picture.map(|picture| &picture.0).filter(|picture| picture.regions.is_some());
        match regional {
            Some(picture) => {
                let correction = watch.time("grow", || AreaCorrection::new(picture, boundary));
                entity.insert(correction);
            }
            None => {
                entity.remove::<AreaCorrection>();
            }
        }
        let (asked, energy) = (asked_sizes(complex, &importance.cells), (energies.0)(settings));
        let is_new = problem.is_none();
        let resume = resume.and_then(|mut resume| resume.0.take());
        let growth = match &resume {
            Some(state) => {
                let change = state.size.iter().zip(&asked).map(|(a, b)| (b / a).ln().abs()).fold(0.0, f32::max);
                Growth::change(complex.dimension, change)
            }
            None => Growth::of(complex.dimension, settings.keys, &asked),
        };
        let (positions, from) = match resume {
            Some(Valid { positions, size }) => (positions, Some(size)),
            None => (complex.rest.clone(), None),
        };
        let is_from_rest = from.is_none();
        match problem {
            Some(mut problem) => {
                let problem = &mut problem.0;
                (problem.importance, problem.energy, problem.from) = (asked, energy, from);
            }
            None => {
                let problem = watch.time("grow", || Problem::of_cells(complex, asked, energy));
                entity.insert(CollisionProblem(problem));
            }
        }
        if is_new && regional.is_some_and(|picture| picture.is_map()) {
            let flow = watch.time("grow", || Flow::new(complex));
            entity.insert(Flowing(flow));
        }
        entity.insert((Growing(growth), Warped(positions), ExtrapolatedStep::default()));
        if is_from_rest {
            entity
                .insert((Rotations::default(), Backtracking::default(), BoundaryAtRisk::default()))
                .remove::<Resumed>();
        } else {
            entity.insert(Resumed);
        }
        if is_new {
            entity.insert((Sizes::default(), Targets::default(), Touching::default(), Proposed::default()));
            entity.insert((Backtracked::default(), Trail::default()));
        }
    }
}

type Regional<'a> = (
    &'a DomainBoundary,
    &'a Lattice,
    &'a PixelShares,
    &'a mut Warped,
    &'a Surfaces,
    &'a mut CollisionProblem,
    &'a mut Growing,
    &'a mut Sizes,
    &'a mut AreaCorrection,
);

/// Regions of a picture that have not their area yet ask for more or less, and λ = 1 settles once more.
fn correct_areas(mut domains: Query<Regional>, mut watch: ResMut<Stopwatch>) {
    for (boundary, lattice, shares, mut warped, surfaces, mut problem, mut growing, mut sizes, mut correction) in
        &mut domains
    {
        if !growing.0.at_end() || !correction.is_due(growing.0.iteration(), growing.0.settled()) {
            continue;
        }
        let Some(binding) = surfaces.binding() else { continue };
        let corrected = watch.time("grow", || {
            let cell = lattice.0.grid.cell_size.powi(2);
            let state = (warped.0.as_slice(), binding.apply(&warped.0));
            correction.correct(&shares.0, &boundary.0, (state.0, &state.1), cell)
        });
        let asked = match corrected {
            Corrected::Right => continue,
            Corrected::Ended => {
                growing.0.rest();
                continue;
            }
            Corrected::Ask(importance, is_led) => {
                growing.0.again(is_led);
                importance
            }
            Corrected::Return(nodes, importance) => {
                growing.0.rest();
                warped.0 = nodes;
                importance
            }
        };
        problem.0.importance = smoothed(&lattice.0, &asked);
        sizes.0 = grow(&lattice.0, &problem.0, 1.0);
        problem.0.weigh(&lattice.0, &sizes.0);
    }
}

fn grow_sizes(
    mut domains: Query<(&Lattice, &mut CollisionProblem, &Growing, &mut Sizes)>,
    mut watch: ResMut<Stopwatch>,
) {
    for (Lattice(complex), mut problem, Growing(growth), mut sizes) in &mut domains {
        if !growth.done() && growth.is_new_step() {
            watch.time("grow", || {
                sizes.0 = grow(complex, &problem.0, growth.lambda());
                problem.0.weigh(complex, &sizes.0);
            });
        }
    }
}

type Led<'a> = (
    &'a Lattice,
    &'a mut Flowing,
    &'a Sizes,
    &'a BoundaryAtRisk,
    &'a Growing,
    &'a Surfaces,
    &'a mut Warped,
    &'a mut Trail,
);

/// Maps begin each step of λ by a flow.
fn lead(mut domains: Query<Led>, mut watch: ResMut<Stopwatch>) {
    for (Lattice(complex), mut flowing, Sizes(asked), at_risk, Growing(growth), surfaces, mut warped, mut trail) in
        &mut domains
    {
        if growth.done() || !growth.flows() {
            continue;
        }
        let surfaces = surfaces.all_if(at_risk.0);
        let most = if growth.at_end() { flow::CORRECTING } else { flow::GROWING };
        let proposed = watch.time("grow", || flowing.0.step(complex, asked, &warped.0, most));
        watch.time("guard", || guard_step(complex, asked, surfaces, &mut warped.0, proposed, &mut Vec::new()));
        trail.pass(&warped.0);
    }
}

/// Begins an extrapolated step where the last two keyframes point; the first one on the way to the linear solution.
fn extrapolate(
    mut domains: Query<(&Lattice, &LinearSolution, &Growing, &Warped, &mut ExtrapolatedStep)>,
    mut watch: ResMut<Stopwatch>,
) {
    for (Lattice(complex), LinearSolution(linear), Growing(growth), Warped(warped), mut extrapolated) in &mut domains {
        if growth.done() || !growth.is_new_step() || !growth.is_extrapolated() {
            continue;
        }
        let (last, next) = (growth.last_key(), growth.lambda());
        extrapolated.positions = watch.time("grow", || match &extrapolated.before {
            Some((before, positions)) => blend(positions, warped, (next - before) / (last - before)),
            None => {
                let ahead = |((x, v), rest): ((&Vec3A, &Vec3A), &Vec3A)| *x + (next - last) * (*v - *rest);
                warped.par_iter().zip(linear).zip(&complex.rest).with_min_len(CHUNK).map(ahead).collect()
            }
        });
    }
}

/// Where the iteration is: in an extrapolated step, or at V''.
fn present<'a>(growth: &Growth, warped: &'a Warped, extrapolated: &'a ExtrapolatedStep) -> &'a [Vec3A] {
    if growth.is_extrapolated() { &extrapolated.positions } else { &warped.0 }
}

type Fitted<'a> = (
    &'a Lattice,
    &'a CollisionProblem,
    &'a Growing,
    &'a Sizes,
    &'a Warped,
    &'a ExtrapolatedStep,
    &'a mut Rotations,
    &'a mut Targets,
);

fn fit_cells(mut domains: Query<Fitted>, mut watch: ResMut<Stopwatch>) {
    for (
        Lattice(complex),
        CollisionProblem(problem),
        Growing(growth),
        sizes,
        warped,
        extrapolated,
        mut rotations,
        mut targets,
    ) in &mut domains
    {
        if !growth.done() {
            let positions = present(growth, warped, extrapolated);
            watch.time("local", || {
                local_step(complex, problem, &sizes.0, positions, &mut rotations.0, &mut targets.0);
            });
        }
    }
}

fn find_contacts(
    mut domains: Query<(&Lattice, &CollisionProblem, &Growing, &Sizes, &Warped, &mut ExtrapolatedStep, &mut Touching)>,
    mut watch: ResMut<Stopwatch>,
) {
    for (
        Lattice(complex),
        CollisionProblem(problem),
        Growing(growth),
        Sizes(sizes),
        warped,
        mut extrapolated,
        mut touching,
    ) in &mut domains
    {
        if growth.done() {
            continue;
        }
        touching.0 = watch.time("contact", || {
            if !growth.is_extrapolated() {
                return contact_step(complex, problem, sizes, &warped.0);
            }
            if growth.is_new_step() {
                extrapolated.near = near_step(complex, problem, sizes, &extrapolated.positions);
            }
            contact::among(complex, &extrapolated.near, &sizes.radius, &extrapolated.positions)
        });
    }
}

type Pulled<'a> = (
    &'a Lattice,
    &'a CollisionProblem,
    &'a Growing,
    &'a Warped,
    &'a ExtrapolatedStep,
    &'a Targets,
    &'a Touching,
    &'a mut Proposed,
);

fn propose(mut domains: Query<Pulled>, mut watch: ResMut<Stopwatch>) {
    for (
        Lattice(complex),
        CollisionProblem(problem),
        Growing(growth),
        warped,
        extrapolated,
        targets,
        touching,
        mut proposed,
    ) in &mut domains
    {
        if !growth.done() {
            let positions = present(growth, warped, extrapolated);
            proposed.0 = watch.time("global", || global_step(complex, problem, positions, &targets.0, &touching.0).0);
        }
    }
}

type Accepted<'a> = (
    &'a Lattice,
    &'a Sizes,
    &'a BoundaryAtRisk,
    &'a mut Growing,
    &'a Surfaces,
    &'a mut Warped,
    &'a mut Proposed,
    &'a mut Backtracked,
    &'a mut Backtracking,
    &'a mut ExtrapolatedStep,
);

fn accept(mut domains: Query<Accepted>, mut watch: ResMut<Stopwatch>) {
    for (
        Lattice(complex),
        sizes,
        at_risk,
        mut growing,
        surfaces,
        mut warped,
        mut proposed,
        mut backtracked,
        mut backtracking,
        mut extrapolated,
    ) in &mut domains
    {
        if growing.0.done() {
            continue;
        }
        let proposed = std::mem::take(&mut proposed.0);
        if growing.0.is_extrapolated() {
            // The certificate of the whole extrapolated step takes the guard's place.
            growing.0.iterated(largest_motion(&extrapolated.positions, &proposed));
            extrapolated.positions = proposed;
            backtracked.0 = Guarded::default();
            continue;
        }
        let surfaces = surfaces.all_if(at_risk.0);
        let (motion, guarded) = watch
            .time("guard", || guard_step(complex, &sizes.0, surfaces, &mut warped.0, proposed, &mut backtracking.0));
        growing.0.iterated(motion);
        if guarded.backtracked > 0 || complex.dimension == Dimension::Two {
            growing.0.backtracked();
        }
        backtracked.0 = guarded;
    }
}
