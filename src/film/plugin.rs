//! Certify: turns a settled state into a keyframe of the film, and goes on to the next λ.

use bevy::prelude::*;
use glam::Vec3A;

use super::{Film, Keyframe, is_clear};
use crate::{
    certificate::{Certificate, Placed, Shell, certify, certify_rest, certify_way},
    collision::{
        Watch, guard,
        plugin::{BoundaryAtRisk, Growing, Leap, Shells, Sizes, Warped},
    },
    diagnostics::Stopwatch,
    schedule::{Solve, Stage},
    voxel::{Complex, Dimension, plugin::Lattice},
};

/// The film of a domain.
#[derive(Component, Debug, Default)]
pub struct Reel(pub Film);

/// Adds the stage.
pub struct FilmPlugin;

impl Plugin for FilmPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Solve, (open, keep).chain().in_set(Stage::Certify));
    }
}

type Unfilmed = (With<Growing>, Without<Reel>);

fn open(mut commands: Commands, domains: Query<(Entity, &Lattice, &Shells), Unfilmed>, mut watch: ResMut<Stopwatch>) {
    for (entity, Lattice(complex), shells) in &domains {
        let mut film = Film::default();
        let certificate = watch.time("certificate", || certify_rest(complex, &shells.0));
        film.push(Keyframe { lambda: 0.0, positions: complex.rest.clone(), certificate, way_is_clear: true });
        commands.entity(entity).insert(Reel(film));
    }
}

type Filmed<'a> = (
    &'a Lattice,
    &'a Sizes,
    &'a mut Growing,
    &'a mut Warped,
    &'a mut Shells,
    &'a mut Reel,
    &'a mut BoundaryAtRisk,
    &'a mut Leap,
);

fn keep(mut domains: Query<Filmed>, mut watch: ResMut<Stopwatch>) {
    for (Lattice(complex), sizes, mut growing, mut warped, mut shells, mut reel, mut at_risk, mut leap) in &mut domains
    {
        let (shells, film, warped) = (&mut shells.0, &mut reel.0, &mut warped.0);
        if growing.0.done() {
            continue;
        }
        // In the plane parts flow far between two keyframes, further than straight ways lead.
        let is_flat = complex.dimension == Dimension::Two;
        if is_flat {
            film.pass(warped);
        }
        if !growing.0.settled() {
            continue;
        }
        if growing.0.leaps() {
            let landed = watch.time("certificate", || {
                // Where the last way ended, most often.
                let start = leap.start.take().filter(|start| start.nodes() == warped.as_slice());
                let start = start.unwrap_or_else(|| Placed::new(shells, warped.clone()));
                let end = Placed::new(shells, std::mem::take(&mut leap.positions));
                land(complex, shells, &sizes.0.size, &start, &end).map(|certificate| (certificate, start, end))
            });
            let Some((certificate, start, end)) = landed else {
                growing.0.walk();
                continue;
            };
            warped.copy_from_slice(end.nodes());
            leap.before = Some((growing.0.last_key(), start.into_nodes()));
            leap.start = Some(end);
            film.push(Keyframe {
                lambda: growing.0.lambda(),
                positions: warped.clone(),
                certificate,
                way_is_clear: true,
            });
            growing.0.advance();
            continue;
        }
        if !growing.0.is_key() {
            growing.0.advance();
            continue;
        }
        let mut certificate = watch.time("certificate", || certify(complex, shells, warped));
        while !certificate.certified() && film.straighten(shells, [warped, warped]) {
            certificate = watch.time("certificate", || certify(complex, shells, warped));
        }
        if !certificate.certified() {
            at_risk.0 = true;
            growing.0.hurry();
            growing.0.held_back();
            certificate = draw_back(complex, &sizes.0.size, shells, film, warped, &mut watch);
        }
        if !is_flat {
            leap.before = film.keyframes().last().map(|k| (k.lambda, k.positions.clone()));
        }
        let (lambda, positions) = (growing.0.lambda(), warped.clone());
        let mut keyframe = Keyframe { lambda, positions, certificate, way_is_clear: false };
        if is_flat && let Some(last) = film.keyframes().last() {
            keyframe.way_is_clear = watch.time("certificate", || is_clear(complex, shells, last, &keyframe));
        }
        film.push(keyframe);
        growing.0.advance();
    }
}

/// The certificate of a leap's end, if all of the way there is valid and no element comes out flatter than the guard
/// would let it.
fn land(complex: &Complex, shells: &[Shell], size: &[f32], from: &Placed, to: &Placed) -> Option<Certificate> {
    let (certificate, clear) = certify_way(complex, shells, from, to);
    let least = size.iter().copied().fold(f32::INFINITY, f32::min);
    let floor = f64::from(guard::VOLUME_FLOOR * complex.dimension.measure(least));
    (clear && certificate.min_volume_ratio() > floor).then_some(certificate)
}

/// Draws a state that cannot be reached without crossing back towards the last keyframe, and certifies it.
fn draw_back(
    complex: &Complex,
    size: &[f32],
    shells: &mut [Shell],
    film: &Film,
    warped: &mut [Vec3A],
    watch: &mut Stopwatch,
) -> Certificate {
    if let Some(last) = film.keyframes().last().filter(|k| k.certificate.certified()) {
        watch.time("guard", || {
            guard::guard(complex, shells, size, &last.positions, warped, Watch::Way, &mut Vec::new())
        });
    }
    watch.time("certificate", || certify(complex, shells, warped))
}
