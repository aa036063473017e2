//! Contract judged by others: where MeshLib (PyPI `meshlib`) finds no self-intersection in the input, it finds none in the
//! warped mesh as written. Says `skipped` where Python or MeshLib is missing.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests panic and speak as tests do")]

mod common;

use std::path::{Path, PathBuf};
use std::process::Command;

use common::{Quiet, Random, cuboids, shared, warp};
use homunculus::{
    boundary::{self, Boundary},
    export,
    importance::{Layer, Stack},
    run,
    settings::{Reference, Settings},
};

/// Meshes that are free of self-intersections, and some that are not, for which nothing is promised.
const MESHES: [&str; 6] =
    ["hand.off", "JapaneseLantern.obj", "makehuman_lowpoly_3pc.obj", "wheel_scaled.stl", "teddy.obj", "airplane.ply"];

/// What the script answers where MeshLib is not installed.
const MISSING: i32 = 3;

/// Self-intersections of each mesh, or `None` with a word where the tool is missing.
fn judged(meshes: &[PathBuf]) -> Option<Vec<usize>> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/independent.py");
    let Ok(output) = Command::new("python3").arg(script).args(meshes).output() else {
        println!("skipped: no python3");
        return None;
    };
    let complaint = String::from_utf8_lossy(&output.stderr);
    if output.status.code() == Some(MISSING) {
        println!("skipped: {}", complaint.trim());
        return None;
    }
    assert!(output.status.success(), "{complaint}");
    let counts: Vec<usize> =
        String::from_utf8_lossy(&output.stdout).lines().map(|line| line.trim().parse().unwrap()).collect();
    assert_eq!(counts.len(), meshes.len());
    Some(counts)
}

/// Writes a mesh as it was read and as it was warped, and returns both paths.
fn written(folder: &Path, boundary: &Boundary, warped: &[glam::DVec3]) -> [PathBuf; 2] {
    let [before, after] = ["in", "out"].map(|which| folder.join(format!("{}-{which}.obj", boundary.name)));
    export::mesh(boundary, &boundary.positions, None, &before).unwrap();
    export::mesh(boundary, warped, None, &after).unwrap();
    [before, after]
}

#[test]
fn what_comes_without_self_intersections_leaves_without() {
    let Some(folder) = shared("meshes") else { return };
    if judged(&[]).is_none() {
        return;
    }
    let out = tempfile::tempdir().unwrap();
    let mut paths = Vec::new();
    for (seed, name) in MESHES.iter().enumerate() {
        let boundary = boundary::read(&folder.join(name)).unwrap();
        let layers = Random(seed as u64).layers(&boundary, 8, 0.5, 3.0);
        let outcome = warp(&boundary, &layers, 32, 0.5).unwrap();
        assert!(outcome.certificate.certified(), "{name}");
        paths.extend(written(out.path(), &boundary, &outcome.frames.last().unwrap().positions));
    }
    let counts = judged(&paths).unwrap();
    let mut clean = 0;
    for (name, count) in MESHES.iter().zip(counts.chunks(2)) {
        println!("{name}: {} before, {} after", count[0], count[1]);
        assert!(count[0] > 0 || count[1] == 0, "{name}: {} self-intersections came of none", count[1]);
        clean += usize::from(count[0] == 0);
    }
    assert!(clean >= 3, "only {clean} meshes come without self-intersections, which proves little");
}

#[test]
fn sabotage_what_eq1_lets_cross_is_found() {
    if judged(&[]).is_none() {
        return;
    }
    let bars = cuboids("bars", &[([0.0; 3], [1.0, 1.0, 4.0]), ([1.5, 0.0, 0.0], [2.5, 1.0, 4.0])]);
    let layers = [Layer::Sphere { centre: [1.25, 0.5, 2.0], radius: 100.0, value: 3.0 }];
    let stack = Stack::load(&layers, 1.0, false, &bars, Path::new("")).unwrap();
    let last = |reference| {
        let settings = Settings { resolution: 16, fidelity: 0.5, keys: 2, reference };
        let outcome = run::warp(&bars, &stack, &settings, &Quiet).unwrap();
        outcome.frames.last().unwrap().positions.clone()
    };
    let out = tempfile::tempdir().unwrap();
    let [before, crossed] = written(out.path(), &bars, &last(Some(Reference::Eq1)));
    let certified = out.path().join("certified.obj");
    export::mesh(&bars, &last(None), None, &certified).unwrap();
    let counts = judged(&[before, crossed, certified]).unwrap();
    assert!(counts[0] == 0 && counts[1] > 0 && counts[2] == 0, "{counts:?}");
}
