//! What is certified is the file: places far from the origin keep their digits in every format, or are refused.

use std::path::{Path, PathBuf};

use glam::{DMat3, DVec3};
use homunculus::Error;
use homunculus::boundary::{self, Boundary, split_long};
use homunculus::export::{self, GrowthFrame};
use homunculus::importance::Layer;

use crate::common;

/// A turned box of 0.4 × 0.3 × 1.8 metres in metres of a national grid.
fn far() -> Boundary {
    let (positions, triangles) = common::cuboid([-0.2, -0.15, 0.0], [0.2, 0.15, 1.8]);
    let turn = DMat3::from_rotation_z(0.3);
    let places = positions.iter().map(|&p| turn * p + DVec3::new(448_262.0, 5_411_932.0, 115.0)).collect();
    split_long(&Boundary::from_triangles("far", places, triangles), 0.3, 5000).boundary
}

fn grown(boundary: &Boundary, amount: f64) -> Vec<DVec3> {
    let (low, _) = boundary.bounds().unwrap();
    boundary.positions.iter().map(|&p| p + (p - low) * amount * (p.z - low.z)).collect()
}

fn farthest(a: &[DVec3], b: &[DVec3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (*a - *b).abs().max_element()).fold(0.0, f64::max)
}

fn json_of(path: &Path) -> serde_json::Value {
    let glb = std::fs::read(path).unwrap();
    let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    serde_json::from_slice(&glb[20..20 + length]).unwrap()
}

#[test]
fn a_glb_far_from_the_origin_keeps_its_digits() {
    let out = tempfile::tempdir().unwrap();
    let path = out.path().join("a.glb");
    let body = far();
    let positions = grown(&body, 0.4);
    export::mesh(&body, &positions, None, &path).unwrap();
    let again = boundary::read(&path).unwrap();
    assert!(farthest(&positions, &again.positions) < 1e-6, "{}", farthest(&positions, &again.positions));
    // Sabotage: without a translation half a metre is gone.
    let single: Vec<DVec3> = positions.iter().map(|p| p.as_vec3().as_dvec3()).collect();
    assert!(farthest(&positions, &single) > 0.1);
    // What is certified comes out to the bit, and a second time too.
    let certified = body.rounded(&positions);
    assert_eq!(body.rounded(&certified), certified);
    for format in ["glb", "obj", "ply", "off"] {
        let path = out.path().join(format!("b.{format}"));
        export::mesh(&body, &certified, None, &path).unwrap();
        assert_eq!(boundary::read(&path).unwrap().positions, certified, "{format}");
    }
    // Readers of single precision see the translation as it is.
    let translation = json_of(&path)["nodes"][0]["translation"].clone();
    for axis in 0..3 {
        let value = translation[axis].as_f64().unwrap();
        assert_eq!(f64::from(value as f32), value);
        assert_eq!(value, body.origin()[axis]);
    }
}

#[test]
fn a_growth_far_from_the_origin_keeps_its_digits() {
    let out = tempfile::tempdir().unwrap();
    let path = out.path().join("growth.glb");
    let body = far();
    let states: Vec<Vec<DVec3>> = [0.0, 0.2, 0.6].iter().map(|&amount| grown(&body, amount)).collect();
    let frames: Vec<GrowthFrame> =
        states.iter().zip([0.0, 0.5, 1.0]).map(|(positions, lambda)| GrowthFrame { lambda, positions }).collect();
    export::growth(&body, &frames, None, 2.0, &path, &|| false).unwrap();
    assert!(farthest(&states[0], &boundary::read(&path).unwrap().positions) < 1e-6);
    let file = gltf::Gltf::open(&path).unwrap();
    let blob = file.blob.clone().unwrap();
    let (translation, _, _) = file.nodes().next().unwrap().transform().decomposed();
    let origin = DVec3::from_array(translation.map(f64::from));
    let primitive = file.meshes().next().unwrap().primitives().next().unwrap();
    let reader = primitive.reader(|_| Some(&blob));
    let rest: Vec<[f32; 3]> = reader.read_positions().unwrap().collect();
    for (target, state) in reader.read_morph_targets().zip(&states[1..]) {
        let single = |p: [f32; 3]| DVec3::from_array(p.map(f64::from));
        let shown: Vec<DVec3> =
            rest.iter().zip(target.0.unwrap()).map(|(&p, moved)| origin + single(p) + single(moved)).collect();
        assert!(farthest(&shown, state) < 2e-6);
    }
}

#[test]
fn what_is_certified_far_from_the_origin_is_the_file() {
    let out = tempfile::tempdir().unwrap();
    let path = out.path().join("a.glb");
    let body = far();
    let centre = body.positions[0].to_array();
    let layers = [Layer::Sphere { centre, radius: 0.6, value: 1.6 }];
    let outcome = common::warp(&body, &layers, 16, 1.0).unwrap();
    assert!(outcome.certificate.certified());
    let positions = &outcome.frames.last().unwrap().positions;
    assert!(farthest(positions, &body.positions) > 0.05, "nothing grew");
    export::mesh(&body, positions, None, &path).unwrap();
    assert_eq!(boundary::read(&path).unwrap().positions, *positions);
    // Sabotage: what is not rounded comes out otherwise.
    let other: Vec<DVec3> = positions.iter().map(|&p| p + DVec3::splat(1e-9)).collect();
    export::mesh(&body, &other, None, &path).unwrap();
    assert_ne!(boundary::read(&path).unwrap().positions, other);
}

#[test]
fn near_the_origin_nothing_is_translated() {
    let out = tempfile::tempdir().unwrap();
    let path = out.path().join("a.glb");
    let near = common::cuboids("near", &[([3.0, 0.0, 0.0], [4.0, 1.0, 1.0])]);
    assert_eq!(near.origin(), DVec3::ZERO);
    export::mesh(&near, &near.positions, None, &path).unwrap();
    assert!(json_of(&path)["nodes"][0].get("translation").is_none());
    // A vertex of no triangle says nothing of where the shape is.
    let mut stray = far();
    stray.positions.push(DVec3::ZERO);
    assert_eq!(stray.origin(), far().origin());
    let flat = Boundary::from_triangles("none", vec![DVec3::splat(1e9); 3], vec![[0, 1, 2]]);
    assert_eq!(flat.origin(), DVec3::ZERO);
}

#[test]
fn stl_refuses_what_it_cannot_say() {
    let out = tempfile::tempdir().unwrap();
    let path = out.path().join("a.stl");
    let body = far();
    let error = export::mesh(&body, &body.positions, None, &path).unwrap_err();
    let text = error.to_string();
    assert!(matches!(error, Error::Input(_)) && text.contains("STL") && text.contains(".obj"), "{text}");
    assert!(!path.exists());
    let near: Vec<DVec3> = body.positions.iter().map(|&p| p - body.origin()).collect();
    export::mesh(&Boundary::from_triangles("near", near.clone(), body.triangles.clone()), &near, None, &path).unwrap();
}

#[test]
fn a_ply_of_floats_far_away_gets_doubles() {
    let out = tempfile::tempdir().unwrap();
    let text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                element face 1\nproperty list uchar int vertex_indices\nend_header\n\
                448262 5411932 115\n448264 5411932 115\n448262 5411934 115\n3 0 1 2\n";
    let body = crate::read(out.path(), "a.ply", text.as_bytes());
    let path = out.path().join("b.ply");
    let head = |path: &Path| String::from_utf8_lossy(&std::fs::read(path).unwrap()).into_owned();
    export::mesh(&body, &body.positions, None, &path).unwrap();
    assert!(head(&path).contains("property float x"), "whole metres are held");
    let moved: Vec<DVec3> = body.positions.iter().map(|&p| p + DVec3::splat(0.123)).collect();
    export::mesh(&body, &moved, None, &path).unwrap();
    assert!(head(&path).contains("property double x"));
    assert_eq!(boundary::read(&path).unwrap().positions, moved);
}

#[test]
fn a_statue_in_metres_of_a_grid_comes_out_where_it_is() {
    let folder: PathBuf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/cases/08-utm-georeferenced");
    let (Ok(grid), Ok(local)) =
        (boundary::read(&folder.join("statue-utm.obj")), boundary::read(&folder.join("statue-local.obj")))
    else {
        println!("skipped: {} is not there", folder.display());
        return;
    };
    let out = tempfile::tempdir().unwrap();
    let path = out.path().join("a.glb");
    export::mesh(&grid, &grid.positions, None, &path).unwrap();
    let again = boundary::read(&path).unwrap();
    assert!(farthest(&grid.positions, &again.positions) < 2e-4, "{}", farthest(&grid.positions, &again.positions));
    // The same shape as the one near the origin, which has no translation.
    let shift = grid.positions[0] - local.positions[0];
    let back: Vec<DVec3> = again.positions.iter().map(|&p| p - shift).collect();
    assert!(farthest(&local.positions, &back) < 2e-4, "{}", farthest(&local.positions, &back));
    assert_eq!(local.origin(), DVec3::ZERO);
}
