//! Real inputs whose states were certified while what was shown between them crossed.

use std::sync::Arc;

use glam::Vec3A;
use homunculus::{
    boundary::{self, Boundary},
    certificate::{Checked, Surface},
    run::{self, Domain, solve as solve_domain},
    settings::Settings,
    voxel::blend,
};

use super::common::{Quiet, Random, flat, shared, states, warp};

/// On the map of the states of the USA, with population as area, a tip passed another within an eighth of the motion
/// between two keyframes, which no look at the eighths told; mended on 22 November 2026, when motions in the plane came
/// to be proven.
#[test]
fn the_map_on_which_a_tip_passed_another() {
    let Some((picture, field)) = states() else { return };
    let settings = Settings { resolution: 320, fidelity: 1.0, keys: 8, reference: None };
    let solved = solve_domain(Domain::picture(Arc::new(flat(&picture, &field)), settings), &Quiet).expect("solved");
    let crossings = |from: &[Vec3A], to: &[Vec3A]| -> usize {
        let states = (0..=32).map(|part| blend(from, to, part as f32 / 32.0));
        states
            .flat_map(|state| Checked::from(&solved.surfaces).iter().map(move |shell| shell.crossings(&state).len()))
            .sum()
    };
    let keyframes = solved.film.keyframes();
    for pair in keyframes.windows(2) {
        assert_eq!(crossings(&pair[0].positions, &pair[1].positions), 0, "after λ {}", pair[0].lambda);
    }
    // Sabotage: on the way to the linear solution things do pass through each other.
    assert!(crossings(&solved.complex.rest, &solved.linear) > 0);
}

/// Pairs of triangles that cross in the blends of neighbouring frames, judged from the written surfaces alone.
fn crossings_between(boundary: &Boundary, frames: &[run::Frame]) -> usize {
    let welded = boundary.welded();
    let identities = boundary.triangles.iter().map(|t| t.map(|v| welded[v as usize])).collect();
    let rest: Vec<Vec3A> = frames[0].positions.iter().map(|p| p.as_vec3a()).collect();
    let surface = Surface::welded(boundary.triangles.clone(), identities, &rest);
    let blends = frames.windows(2).flat_map(|pair| [0.25, 0.5, 0.75, 1.0].map(|t| (pair, t)));
    blends
        .map(|(pair, t)| {
            let (a, b) = (&pair[0].positions, &pair[1].positions);
            let state: Vec<Vec3A> = a.iter().zip(b).map(|(a, b)| a.lerp(*b, t).as_vec3a()).collect();
            surface.crossings(&state).len()
        })
        .sum()
}

/// Thin spokes that the lattice cannot keep apart.
fn spokes() -> Option<Boundary> {
    let file = shared("meshes")?.join("wheel_scaled.stl");
    Some(boundary::read(&file).unwrap_or_else(|error| panic!("{error}")))
}

/// The blends between certified keyframes of this wheel crossed; mended on 22 November 2026, when what cannot be
/// reached came to be drawn back.
#[test]
fn the_wheel_whose_blends_crossed() {
    let Some(boundary) = spokes() else { return };
    let outcome = warp(&boundary, &Random(3).layers(&boundary, 8, 0.5, 3.0), 32, 0.5).unwrap_or_else(|e| panic!("{e}"));
    assert!(outcome.frames.iter().all(|f| f.certificate.certified()));
    assert_eq!(crossings_between(&boundary, &outcome.frames), 0);
}

#[test]
fn sabotage_the_wheel_seen_from_behind() {
    let Some(boundary) = spokes() else { return };
    let mut outcome =
        warp(&boundary, &Random(3).layers(&boundary, 8, 0.5, 3.0), 32, 0.5).unwrap_or_else(|e| panic!("{e}"));
    // A frame seen from behind: on the way there everything passes through everything.
    for p in &mut outcome.frames[4].positions {
        *p = -*p;
    }
    assert!(crossings_between(&boundary, &outcome.frames) > 0);
}
