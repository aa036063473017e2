//! Contract of the whole: on every real mesh, with any smooth importance, every frame is certified.
//!
//! The number of seeds and the resolution are small here; `HOMUNCULUS_SEEDS=10 HOMUNCULUS_RESOLUTION=64` runs what the
//! README states.

mod common;

use common::{Random, files, number, shared, warp};
use glam::Vec3A;
use homunculus::{
    boundary::{self, Boundary},
    certificate::Surface,
    run,
};

#[test]
fn every_frame_of_every_mesh_is_certified() {
    let Some(folder) = shared("meshes") else { return };
    let (seeds, resolution) = (number("HOMUNCULUS_SEEDS", 1_u64), number("HOMUNCULUS_RESOLUTION", 24_u32));
    let only = std::env::var("HOMUNCULUS_MESH").unwrap_or_default();
    let mut failed = Vec::new();
    for file in files(&folder).into_iter().filter(|f| f.to_string_lossy().contains(&only)) {
        let boundary = boundary::read(&file).unwrap_or_else(|error| panic!("{error}"));
        for seed in 0..seeds {
            let layers = Random(seed).layers(&boundary, 8, 0.5, 3.0);
            let start = std::time::Instant::now();
            let outcome = warp(&boundary, &layers, resolution, 0.5).unwrap_or_else(|error| panic!("{error}"));
            let fine = outcome.frames.iter().all(|f| f.certificate.certified());
            println!(
                "{} seed {seed}: {} cells, input crosses {}, classic {}/{}, certified {fine}, {} frames, size error p95 {:.3}, distortion p99 {:.2}, {:.1} s",
                boundary.name,
                outcome.domain.cells,
                outcome.input.self_intersections,
                outcome.classic.map_or(0, |c| c.inverted),
                outcome.classic.map_or(0, |c| c.crossings),
                outcome.frames.len(),
                outcome.fidelity.p95,
                outcome.distortion.p99,
                start.elapsed().as_secs_f64(),
            );
            assert_eq!(outcome.frames.first().map(|f| f.lambda), Some(0.0));
            assert_eq!(outcome.frames.last().map(|f| f.lambda), Some(1.0));
            if !fine {
                for f in &outcome.frames {
                    println!("   {} {:?}", f.lambda, f.certificate);
                }
                failed.push(format!("{} seed {seed}", boundary.name));
            }
        }
    }
    assert!(failed.is_empty(), "not certified: {failed:?}");
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

/// Thin spokes that the lattice cannot keep apart: the case in which blends between keyframes once crossed.
fn spokes() -> Option<Boundary> {
    let file = shared("meshes")?.join("wheel_scaled.stl");
    Some(boundary::read(&file).unwrap_or_else(|error| panic!("{error}")))
}

#[test]
fn blends_of_frames_do_not_cross_either() {
    let Some(boundary) = spokes() else { return };
    let outcome = warp(&boundary, &Random(3).layers(&boundary, 8, 0.5, 3.0), 32, 0.5).unwrap_or_else(|e| panic!("{e}"));
    assert!(outcome.frames.iter().all(|f| f.certificate.certified()));
    assert_eq!(crossings_between(&boundary, &outcome.frames), 0);
}

#[test]
fn sabotage_crossing_blends_are_seen() {
    let Some(boundary) = spokes() else { return };
    let mut outcome =
        warp(&boundary, &Random(3).layers(&boundary, 8, 0.5, 3.0), 32, 0.5).unwrap_or_else(|e| panic!("{e}"));
    // A frame seen from behind: on the way there everything passes through everything.
    for p in &mut outcome.frames[4].positions {
        *p = -*p;
    }
    assert!(crossings_between(&boundary, &outcome.frames) > 0);
}
