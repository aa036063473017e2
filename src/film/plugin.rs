//! Certify: turns a settled state into a keyframe of the film, and goes on to the next λ.

use bevy::prelude::*;
use glam::Vec3A;

use super::{Film, Keyframe, is_proven};
use crate::{
    certificate::{CarriedState, Certificate, Surfaces, certify, certify_motion, certify_rest},
    collision::{
        Extent, Trail, grow, guard,
        plugin::{BoundaryAtRisk, CollisionProblem, ExtrapolatedStep, Growing, Resume, Sizes, Start, Valid, Warped},
    },
    diagnostics::Stopwatch,
    edge::plugin::LinearSolution,
    schedule::{Failed, Solve, Stage},
    settings::Settings,
    voxel::{Complex, Dimension, plugin::Lattice},
};

/// The film of a domain.
#[derive(Component, Debug, Default)]
pub struct Reel(pub Film);

/// Adds the stage.
pub struct FilmPlugin;

impl Plugin for FilmPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Solve, reset.in_set(Stage::Reset))
            .add_systems(Solve, (open, keep).chain().in_set(Stage::Certify));
    }
}

type Renewed = (With<Reel>, Or<(Changed<LinearSolution>, Changed<Settings>, Changed<Start>)>);

type Filming<'a> = (
    Entity,
    &'a Start,
    &'a Lattice,
    &'a Surfaces,
    &'a CollisionProblem,
    &'a Warped,
    &'a Sizes,
    &'a mut Reel,
    &'a mut Trail,
);

/// Something else is asked for: the film begins anew, at rest or at the state that growth goes on from.
fn reset(mut commands: Commands, mut domains: Query<Filming, Renewed>, mut watch: ResMut<Stopwatch>) {
    for (entity, start, Lattice(complex), surfaces, CollisionProblem(problem), warped, sizes, mut reel, mut trail) in
        &mut domains
    {
        let valid = || {
            let certificate = certify(complex, surfaces, &warped.0);
            if certificate.certified() {
                return Some((warped.0.clone(), certificate, sizes.0.size.clone()));
            }
            let last = reel.0.keyframes().last().filter(|last| last.certificate.certified())?;
            let size = grow(complex, problem, last.lambda).size;
            Some((last.positions.clone(), last.certificate.clone(), size))
        };
        let state = match start {
            Start::Rest => None,
            Start::Present => watch.time("certificate", valid),
        };
        let mut entity = commands.entity(entity);
        match state.filter(|(_, _, size)| size.len() == complex.cells.len()) {
            Some((positions, certificate, size)) => {
                let mut film = Film::default();
                let state = positions.clone();
                film.push(Keyframe { lambda: 0.0, positions: state, certificate, motion_is_proven: true });
                reel.0 = film;
                trail.clear();
                entity.insert(Resume(Some(Valid { positions, size })));
            }
            None => {
                entity.remove::<Reel>();
            }
        }
    }
}

type Unfilmed = (With<Growing>, Without<Reel>, Without<Failed>);

fn open(
    mut commands: Commands,
    mut domains: Query<(Entity, &Lattice, &Surfaces, &mut Trail), Unfilmed>,
    mut watch: ResMut<Stopwatch>,
) {
    for (entity, Lattice(complex), surfaces, mut trail) in &mut domains {
        let mut film = Film::default();
        // What was passed before there was a film leads to no keyframe of it.
        trail.clear();
        let certificate = watch.time("certificate", || certify_rest(complex, surfaces));
        film.push(Keyframe { lambda: 0.0, positions: complex.rest.clone(), certificate, motion_is_proven: true });
        commands.entity(entity).insert(Reel(film));
    }
}

type Filmed<'a> = (
    &'a Lattice,
    &'a Sizes,
    &'a mut Growing,
    &'a mut Warped,
    &'a mut Surfaces,
    &'a mut Reel,
    &'a mut BoundaryAtRisk,
    &'a mut ExtrapolatedStep,
    &'a mut Trail,
);

fn keep(mut domains: Query<Filmed>, mut watch: ResMut<Stopwatch>) {
    for (
        Lattice(complex),
        sizes,
        mut growing,
        mut warped,
        mut surfaces,
        mut reel,
        mut at_risk,
        mut extrapolated,
        mut trail,
    ) in &mut domains
    {
        if growing.0.done() {
            continue;
        }
        let (film, warped, trail) = (&mut reel.0, &mut warped.0, &mut *trail);
        // In the plane parts flow far between two keyframes, further than straight motions lead.
        let is_flat = complex.dimension == Dimension::Two;
        if is_flat {
            trail.pass(warped);
        }
        if !growing.0.settled() {
            continue;
        }
        if growing.0.is_extrapolated() {
            let certified = watch.time("certificate", || {
                // Where the last motion ended, most often.
                let start = extrapolated.start.take().filter(|start| start.nodes() == warped.as_slice());
                let start = start.unwrap_or_else(|| CarriedState::new(&*surfaces, warped.clone()));
                let end = CarriedState::new(&*surfaces, std::mem::take(&mut extrapolated.positions));
                certify_extrapolated(complex, &surfaces, &sizes.0.size, &start, &end)
                    .map(|certificate| (certificate, start, end))
            });
            let Some((certificate, start, end)) = certified else {
                growing.0.walk();
                continue;
            };
            warped.copy_from_slice(end.nodes());
            extrapolated.before = Some((growing.0.last_key(), start.into_nodes()));
            extrapolated.start = Some(end);
            film.push_after(
                Keyframe { lambda: growing.0.lambda(), positions: warped.clone(), certificate, motion_is_proven: true },
                trail,
            );
            growing.0.advance();
            continue;
        }
        if !growing.0.is_key() {
            growing.0.advance();
            continue;
        }
        let mut certificate = watch.time("certificate", || certify(complex, &*surfaces, warped));
        while !certificate.certified() && film.straighten(&mut surfaces, [warped, warped]) {
            certificate = watch.time("certificate", || certify(complex, &*surfaces, warped));
        }
        if !certificate.certified() {
            at_risk.0 = true;
            growing.0.hurry();
            growing.0.backtracked();
            certificate = draw_back(complex, &sizes.0.size, &surfaces, film, warped, &mut watch);
        }
        if !is_flat {
            extrapolated.before = film.keyframes().last().map(|k| (k.lambda, k.positions.clone()));
        }
        let (lambda, positions) = (growing.0.lambda(), warped.clone());
        let mut keyframe = Keyframe { lambda, positions, certificate, motion_is_proven: false };
        if is_flat && let Some(last) = film.keyframes().last() {
            keyframe.motion_is_proven = watch.time("certificate", || is_proven(complex, &*surfaces, last, &keyframe));
        }
        film.push_after(keyframe, trail);
        growing.0.advance();
    }
}

/// The certificate of an extrapolated step's end, if the motion there is proven to be valid and no element comes out
/// flatter than the guard would let it.
fn certify_extrapolated(
    complex: &Complex,
    surfaces: &Surfaces,
    size: &[f32],
    from: &CarriedState,
    to: &CarriedState,
) -> Option<Certificate> {
    let (certificate, proven) = certify_motion(complex, surfaces, from, to);
    let least = size.iter().copied().fold(f32::INFINITY, f32::min);
    let floor = f64::from(guard::VOLUME_FLOOR * complex.dimension.measure(least));
    (proven && certificate.min_volume_ratio() > floor).then_some(certificate)
}

/// Draws a state that cannot be reached without crossing back towards the last keyframe, and certifies it.
fn draw_back(
    complex: &Complex,
    size: &[f32],
    surfaces: &Surfaces,
    film: &Film,
    warped: &mut [Vec3A],
    watch: &mut Stopwatch,
) -> Certificate {
    if let Some(last) = film.keyframes().last().filter(|k| k.certificate.certified()) {
        watch.time("guard", || {
            guard::guard(complex, surfaces, size, &last.positions, warped, Extent::Motion, &mut Vec::new())
        });
    }
    watch.time("certificate", || certify(complex, &*surfaces, warped))
}
