//! Contract of the whole: on every real mesh, with any smooth importance, every frame is certified.
//!
//! The number of seeds and the resolution are small here; `HOMUNCULUS_SEEDS=10 HOMUNCULUS_RESOLUTION=64` runs what the
//! README states.

mod common;

use common::{Random, files, number, shared, warp};
use homunculus::boundary;

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
