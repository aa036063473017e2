//! From the sandbox to the view's components: bodies, poses, colours, the camera.

use std::sync::Arc;

use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::prelude::*;
use glam::Vec3A;

use super::document::Document;
use super::pointer::Viewport;
use super::sandbox::{Look, Sandbox};
use crate::boundary::Boundary;
use crate::panel::{Choice, Compare};
use crate::session::{Lattice, Phase, Snapshot};
use crate::view::{
    Body, Extent, Ghost, Looks, Mode, Orbit, Picker, Placement, Pose, Quality, SizeLegend, Studio, ViewFrame,
    VoxelColour, Wipe,
};
use crate::voxel::{Complex, Dimension};

/// The certified body.
#[derive(Component)]
pub struct Shown;

/// What Eq. 1 alone makes of it.
#[derive(Component)]
pub struct Classic;

/// `[nodes]` V of the lattice that is shown.
#[derive(Component)]
pub(super) struct Rest(Arc<Vec<Vec3A>>);

pub(super) fn spawn_camera(mut commands: Commands, quality: Option<Res<Quality>>) {
    let samples = quality.map_or(1, |quality| quality.samples);
    commands.spawn((Camera3d::default(), Tonemapping::None, Msaa::from_samples(samples), Orbit::default()));
}

/// Side of the reference cube that stands for ×1, view units.
const REFERENCE: f32 = 0.06;

/// A body for the lattice that is there; a second one where it is compared with.
pub(super) fn bodies(
    mut commands: Commands,
    sandbox: Res<Sandbox>,
    shown: Query<(Entity, &Body), With<Shown>>,
    classic: Query<Entity, With<Classic>>,
    mut references: Query<(Entity, &mut SizeLegend)>,
    orbits: Query<&Orbit>,
    mut placed: Local<Option<(u64, SizeLegend)>>,
) {
    let Some(lattice) = &sandbox.snapshot.lattice else { return };
    let is_shown =
        |body: &Body| Arc::ptr_eq(&body.complex, &lattice.complex) && Arc::ptr_eq(&body.binding, &lattice.binding);
    let is_new = !shown.iter().any(|(_, body)| is_shown(body));
    let body = || Body {
        boundary: lattice.boundary.clone(),
        complex: lattice.complex.clone(),
        binding: lattice.binding.clone(),
    };
    if is_new {
        shown.iter().for_each(|(entity, _)| commands.entity(entity).despawn());
        let rest = Arc::new(lattice.complex.rest.clone());
        let picker = sandbox.open.as_ref().map_or_else(Picker::default, |open| open.picker(&lattice.boundary));
        commands.spawn((Shown, body(), picker, Rest(rest)));
    }
    let compares = sandbox.choice.compare != Compare::Off;
    if is_new || !compares {
        classic.iter().for_each(|entity| commands.entity(entity).despawn());
    }
    if compares && (is_new || classic.is_empty()) {
        let rest = Arc::new(lattice.complex.rest.clone());
        commands.spawn((Classic, body(), Rest(rest)));
    }
    let shows_sizes = sandbox.choice.size_legend && !orbits.is_empty();
    if !shows_sizes || is_new {
        references.iter().for_each(|(entity, _)| commands.entity(entity).despawn());
    }
    if !shows_sizes {
        return;
    }
    let version = sandbox.snapshot.version;
    let known = placed.filter(|(known, _)| *known == version).map(|(_, legend)| legend);
    let wanted = known.unwrap_or_else(|| references_of(&sandbox.snapshot, lattice));
    *placed = Some((version, wanted));
    match references.single_mut() {
        Ok((_, mut legend)) if !is_new => drop(legend.set_if_neq(wanted)),
        _ => drop(commands.spawn(wanted)),
    }
}

/// Where the reference shapes are: beside a body's feet and before them, below a picture however it grows. There they hide
/// nothing.
fn references_of(snapshot: &Snapshot, lattice: &Lattice) -> SizeLegend {
    let is_flat = is_flat(&lattice.complex);
    if is_flat {
        let Extent { low, high } = reach(snapshot, false);
        let largest = REFERENCE * SizeLegend::FACTORS[SizeLegend::FACTORS.len() - 1];
        let at = Vec3::new(0.5 * (low.x + high.x), low.y - 0.6 * largest, 0.0);
        return SizeLegend { unit: REFERENCE, is_flat, at };
    }
    let (low, high) = lattice.boundary.bounds().unwrap_or_default();
    let frame = ViewFrame::of(&lattice.boundary);
    let (low, high) = (frame.world_from_source(low), frame.world_from_source(high));
    let row = REFERENCE * SizeLegend::WIDTH;
    let at = Vec3::new(0.5 * (low.x + high.x) + 0.3 * (high.x - low.x) + 0.5 * row, 0.0, high.z + 0.1);
    SizeLegend { unit: REFERENCE, is_flat, at }
}

type Posed<'a> = (Entity, Option<&'a Pose>, &'a Rest, &'a mut Placement);

/// Which state is shown at which λ.
pub(super) fn poses(
    mut commands: Commands,
    sandbox: Res<Sandbox>,
    mut shown: Query<Posed, (With<Shown>, Without<Classic>)>,
    mut classic: Query<Posed, (With<Classic>, Without<Shown>)>,
    orbits: Query<&Orbit>,
    mut reached: Local<Option<(u64, Extent)>>,
) {
    let snapshot = &sandbox.snapshot;
    let mut offset = Vec3::ZERO;
    if sandbox.choice.compare == Compare::SideBySide
        && let Some(orbit) = orbits.iter().next()
    {
        if reached.is_none_or(|(version, _)| version != snapshot.version) {
            *reached = Some((snapshot.version, reach(snapshot, true)));
        }
        offset = reached.map_or(Vec3::ZERO, |(_, extent)| aside(extent, orbit));
    }
    for (entity, pose, _, mut placement) in &mut shown {
        placement.set_if_neq(Placement { offset });
        set(&mut commands, entity, pose, certified_pose(&sandbox));
    }
    for (entity, pose, rest, mut placement) in &mut classic {
        placement.set_if_neq(Placement { offset: -offset });
        let linear = snapshot.linear.as_ref().filter(|linear| linear.len() == rest.0.len());
        let wanted = linear.map(|linear| Pose {
            from: rest.0.clone(),
            to: linear.clone(),
            blend: sandbox.choice.player.lambda(),
        });
        set(&mut commands, entity, pose, wanted);
    }
}

/// Space between two bodies side by side, as a part of their width.
const GAP: f32 = 0.06;

/// From the middle to the right one of two bodies side by side, as the camera sees them.
fn aside(Extent { low, high }: Extent, orbit: &Orbit) -> Vec3 {
    let right = orbit.rotation() * Vec3::X;
    right * 0.5 * (1.0 + GAP) * (high - low).dot(right.abs())
}

/// Whether it is a picture's.
fn is_flat(complex: &Complex) -> bool {
    complex.dimension == Dimension::Two
}

fn set(commands: &mut Commands, entity: Entity, now: Option<&Pose>, wanted: Option<Pose>) {
    let same = |a: &Pose, b: &Pose| Arc::ptr_eq(&a.from, &b.from) && Arc::ptr_eq(&a.to, &b.to) && a.blend == b.blend;
    match (now, wanted) {
        (Some(now), Some(wanted)) if same(now, &wanted) => {}
        (_, Some(wanted)) => drop(commands.entity(entity).insert(wanted)),
        (Some(_), None) => drop(commands.entity(entity).remove::<Pose>()),
        (None, None) => {}
    }
}

/// The film at λ; at its end, while something newer is being solved, that: the linear solution first, then valid states.
fn certified_pose(sandbox: &Sandbox) -> Option<Pose> {
    let (snapshot, player) = (&*sandbox.snapshot, &sandbox.choice.player);
    let nodes = snapshot.lattice.as_ref()?.complex.nodes();
    let fits = |state: &&Arc<Vec<Vec3A>>| state.len() == nodes;
    let shows_end = !player.is_playing && player.lambda() >= 1.0;
    if shows_end && snapshot.phase != Phase::Done {
        let newest = snapshot.warped.as_ref().or(match snapshot.phase {
            Phase::Adapting | Phase::Stopped => snapshot.linear.as_ref(),
            _ => None,
        });
        return newest.filter(fits).map(|state| Pose::still(state.clone()));
    }
    let (film, lambda) = (&snapshot.film, player.lambda());
    let after = film.iter().position(|state| state.lambda >= lambda).or(film.len().checked_sub(1))?;
    let (from, to) = (&film[after.saturating_sub(1)], &film[after]);
    let span = to.lambda - from.lambda;
    let blend = if span > 0.0 { ((lambda - from.lambda) / span).clamp(0.0, 1.0) } else { 1.0 };
    let pose = Pose { from: from.positions.clone(), to: to.positions.clone(), blend };
    (fits(&&pose.from) && fits(&&pose.to)).then_some(pose)
}

/// The version of what was painted, what it was painted on, and what is drawn.
type PaintedAt = (u64, [Arc<Boundary>; 2]);

/// Colours, ghost, wipe.
pub(super) fn looks(
    mut commands: Commands,
    sandbox: Res<Sandbox>,
    mut painted: Local<Option<(PaintedAt, Arc<Vec<f32>>)>>,
    mut shown: Query<(Entity, &mut Looks, Has<Ghost>, Has<Classic>)>,
) {
    let snapshot = &sandbox.snapshot;
    let Some((open, lattice)) = sandbox.open.as_ref().zip(snapshot.lattice.as_ref()) else { return };
    let version = open.painting.version();
    let vertices = lattice.boundary.positions.len();
    let fits = open.is_flat() == is_flat(&lattice.complex) && (open.is_flat() || open.painting.ln().len() == vertices);
    let boundaries = [open.painting.under().boundary.clone(), lattice.boundary.clone()];
    let is_of = |(at, known): &PaintedAt| {
        *at == version && known.iter().zip(&boundaries).all(|(known, boundary)| Arc::ptr_eq(known, boundary))
    };
    if fits && painted.as_ref().is_none_or(|(at, _)| !is_of(at)) {
        let importance = match open.painting.under().subject.carried(open.painting.ln(), &lattice.boundary) {
            Some(ln) => ln.into_iter().map(|ln| ln.exp() as f32).collect(),
            None => open.painting.importance(),
        };
        *painted = Some(((version, boundaries), Arc::new(importance)));
    }
    let importance = painted.as_ref().filter(|_| fits).map(|(_, values)| values.clone());
    let choice = &sandbox.choice;
    let lambda = choice.player.lambda();
    let marked = (choice.compare != Compare::Off).then(|| sandbox.marked()).flatten();
    for (entity, mut looks, has_ghost, is_classic) in &mut shown {
        let voxels = match (choice.mode, &snapshot.importance) {
            (Mode::Voxels(VoxelColour::Growth), Some(importance)) if lambda < 1.0 => {
                Some(Arc::new(importance.iter().map(|f| 1.0 + lambda * (f - 1.0)).collect()))
            }
            (Mode::Voxels(_), importance) => importance.clone(),
            _ => None,
        };
        let wiped = choice.compare == Compare::Wipe;
        let wanted = Looks {
            mode: match choice.mode {
                Mode::Fidelity if snapshot.reached.is_none() => Mode::Plain,
                // In grey, on which red tells.
                Mode::Importance | Mode::Fidelity if is_classic => Mode::Plain,
                mode => mode,
            },
            importance: importance.clone(),
            fidelity: snapshot.reached.clone(),
            voxels,
            range: None,
            marked: marked.clone().filter(|_| is_classic),
            wipe: wiped.then_some(Wipe { at: choice.wipe, keeps_left: is_classic }),
        };
        if !same_looks(&looks, &wanted) {
            *looks = wanted;
        }
        if choice.ghost != has_ghost && !is_classic {
            let mut entity = commands.entity(entity);
            if choice.ghost {
                entity.insert(Ghost::default())
            } else {
                entity.remove::<Ghost>()
            };
        }
    }
}

/// The same arrays and settings: without comparing what is in the arrays.
fn same_looks(a: &Looks, b: &Looks) -> bool {
    let same = |a: &Option<Arc<Vec<f32>>>, b: &Option<Arc<Vec<f32>>>| match (a, b) {
        (Some(a), Some(b)) => Arc::ptr_eq(a, b),
        (None, None) => true,
        _ => false,
    };
    let same_marks = match (&a.marked, &b.marked) {
        (Some(a), Some(b)) => Arc::ptr_eq(a, b),
        (a, b) => a.is_none() && b.is_none(),
    };
    same_marks
        && a.mode == b.mode
        && a.wipe == b.wipe
        && same(&a.importance, &b.importance)
        && same(&a.fidelity, &b.fidelity)
        && same(&a.voxels, &b.voxels)
}

/// Radians a second.
const TURNTABLE: f32 = 0.6;

/// Fulfils what the camera was asked for, and turns the turntable.
pub(super) fn camera(
    mut sandbox: ResMut<Sandbox>,
    mut orbits: Query<&mut Orbit>,
    viewport: Res<Viewport>,
    time: Res<Time>,
    studio: Option<ResMut<Studio>>,
    (mut framed, mut was_flat): (Local<Option<(Vec3, f32)>>, Local<bool>),
) {
    let Ok(mut orbit) = orbits.single_mut() else { return };
    let mut wanted = *orbit;
    let is_flat = sandbox.open.as_ref().is_some_and(Document::is_flat);
    wanted.orthographic = sandbox.choice.orthographic || is_flat;
    wanted.turntable = if sandbox.choice.turntable && !is_flat { TURNTABLE } else { 0.0 };
    wanted.turn(time.delta_secs());
    if is_flat {
        // Straight on, whatever is asked for.
        (wanted.yaw, wanted.pitch) = (0.0, 0.0);
    }
    if let Some(mut studio) = studio {
        studio.set_if_neq(Studio { floor: !is_flat, ..studio.clone() });
    }
    // A body after a picture is looked at as at first.
    if std::mem::replace(&mut *was_flat, is_flat) && !is_flat {
        wanted = Orbit { orthographic: sandbox.choice.orthographic, ..Orbit::default() };
    }
    // What was framed before it had grown is framed again when it has, unless the user has looked elsewhere since.
    if sandbox.snapshot.phase == Phase::Done && framed.take() == Some((orbit.target, orbit.distance)) {
        sandbox.looks.push(Look::Frame);
    }
    if sandbox.snapshot.lattice.is_some() && !sandbox.looks.is_empty() {
        let sandbox = sandbox.bypass_change_detection();
        for look in std::mem::take(&mut sandbox.looks) {
            match look {
                Look::From(_) if is_flat => {}
                Look::From(axis) => wanted.look_from(axis),
                Look::Frame => {
                    let extent = bounds(&sandbox.snapshot, &sandbox.choice, &wanted);
                    wanted.frame(extent, viewport.size.x / viewport.size.y.max(1.0));
                    // Room for the legend and for what the eye wants around a thing.
                    wanted.distance *= 1.12;
                    *framed = (sandbox.snapshot.phase != Phase::Done).then_some((wanted.target, wanted.distance));
                }
                Look::At(place) => {
                    if let Some(lattice) = &sandbox.snapshot.lattice {
                        wanted.target = ViewFrame::of(&lattice.boundary).world_from_source(place);
                        wanted.distance = wanted.distance.min(1.2);
                    }
                }
            }
        }
    }
    orbit.set_if_neq(wanted);
    sandbox.bypass_change_detection().seen_from = wanted;
}

/// The box around what is shown, view space.
fn bounds(snapshot: &Snapshot, choice: &Choice, orbit: &Orbit) -> Extent {
    let is_beside = choice.compare == Compare::SideBySide;
    let one = reach(snapshot, is_beside);
    let aside = if is_beside { aside(one, orbit) } else { Vec3::ZERO };
    let all = one.moved(aside).union(one.moved(-aside));
    match &snapshot.lattice {
        Some(lattice) if choice.size_legend => all.union(references_of(snapshot, lattice).extent()),
        _ => all,
    }
}

/// The box around the body at rest and grown, with Eq. 1's solution if that is shown too; view space.
fn reach(snapshot: &Snapshot, with_linear: bool) -> Extent {
    let Some(lattice) = &snapshot.lattice else { return Extent { low: Vec3::ZERO, high: Vec3::ONE } };
    let frame = ViewFrame::of(&lattice.boundary);
    let (mut low, mut high) = lattice.boundary.bounds().unwrap_or_default();
    let is_flat = is_flat(&lattice.complex);
    let last = snapshot.film.last().map(|state| &state.positions);
    let linear = snapshot.linear.as_ref().filter(|_| with_linear || last.is_none());
    for state in last.into_iter().chain(linear).filter(|state| state.len() == lattice.complex.nodes()) {
        for p in state.iter() {
            let p = lattice.complex.grid.source_from_lattice(p.as_dvec3());
            (low, high) = (low.min(p), high.max(p));
        }
    }
    let (mut low, mut high) = (frame.world_from_source(low), frame.world_from_source(high));
    if !is_flat {
        // What has grown downwards is lifted onto the floor.
        (low.y, high.y) = (0.0, high.y - low.y);
    }
    Extent { low, high }
}
