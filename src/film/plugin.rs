//! Certify: turns a settled state into a keyframe of the film, and goes on to the next λ.

use bevy::prelude::*;

use super::{Film, Keyframe, blend};
use crate::{
    certificate::{Certificate, certify},
    collision::{
        Shell, guard,
        plugin::{Growing, Shells, Sizes, Warped},
    },
    diagnostics::Stopwatch,
    schedule::{Solve, Stage},
    voxel::{Complex, plugin::Lattice},
};

/// The film of a domain.
#[derive(Component, Debug, Default)]
pub struct Reel(pub Film);

/// Blends between two keyframes are mended by halving the interval at most this often: 2⁻⁴ of a step of λ is less than
/// a frame of any recording.
const MENDINGS: u32 = 4;

/// Adds the stage.
pub struct FilmPlugin;

impl Plugin for FilmPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Solve, (open, keep).chain().in_set(Stage::Certify));
    }
}

fn open(
    mut commands: Commands,
    mut domains: Query<(Entity, &Lattice, &mut Shells), (With<Growing>, Without<Reel>)>,
    mut watch: ResMut<Stopwatch>,
) {
    for (entity, Lattice(complex), mut shells) in &mut domains {
        let mut film = Film::default();
        let certificate = watch.time("certificate", || certify(complex, &mut shells.0, &complex.rest));
        film.push(Keyframe { lambda: 0.0, positions: complex.rest.clone(), certificate });
        commands.entity(entity).insert(Reel(film));
    }
}

fn keep(
    mut domains: Query<(&Lattice, &Sizes, &mut Growing, &mut Warped, &mut Shells, &mut Reel)>,
    mut watch: ResMut<Stopwatch>,
) {
    for (Lattice(complex), sizes, mut growing, mut warped, mut shells, mut reel) in &mut domains {
        if growing.0.done() || !growing.0.settled() {
            continue;
        }
        let lambda = growing.0.lambda();
        let certificate = commit(complex, &sizes.0.size, &mut shells.0, &reel.0, &mut warped.0, &mut watch);
        let keyframe = Keyframe { lambda, positions: warped.0.clone(), certificate };
        mend_blend(complex, &sizes.0.size, &mut shells.0, &mut reel.0, &keyframe, MENDINGS, &mut watch);
        reel.0.push(keyframe);
        growing.0.advance();
    }
}

/// Certifies the state; where the written surface crosses itself, draws it back towards the last keyframe first.
fn commit(
    complex: &Complex,
    size: &[f32],
    shells: &mut [Shell],
    film: &Film,
    warped: &mut Vec<glam::Vec3A>,
    watch: &mut Stopwatch,
) -> Certificate {
    let certificate = watch.time("certificate", || certify(complex, shells, warped));
    let Some(last) = film.keyframes().last().filter(|k| !certificate.certified() && k.certificate.certified()) else {
        return certificate;
    };
    watch.time("guard", || guard::guard(complex, shells, size, &last.positions, warped));
    watch.time("certificate", || certify(complex, shells, warped))
}

/// Makes sure that the blend half-way from the film's last keyframe to `next` is valid, by a keyframe there if need be.
fn mend_blend(
    complex: &Complex,
    size: &[f32],
    shells: &mut [Shell],
    film: &mut Film,
    next: &Keyframe,
    mendings: u32,
    watch: &mut Stopwatch,
) {
    let Some(last) = film.keyframes().last().cloned() else { return };
    if !(last.certificate.certified() && next.certificate.certified()) || mendings == 0 {
        return;
    }
    let mut middle = blend(&last.positions, &next.positions, 0.5);
    if watch.time("certificate", || certify(complex, shells, &middle).certified()) {
        return;
    }
    watch.time("guard", || guard::guard(complex, shells, size, &last.positions, &mut middle));
    let certificate = watch.time("certificate", || certify(complex, shells, &middle));
    let keyframe = Keyframe { lambda: 0.5 * (last.lambda + next.lambda), positions: middle, certificate };
    mend_blend(complex, size, shells, film, &keyframe, mendings - 1, watch);
    film.push(keyframe);
    mend_blend(complex, size, shells, film, next, mendings - 1, watch);
}
