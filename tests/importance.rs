//! Contract of importance: what users say by spheres, attributes, tables and pictures becomes a positive, finite number
//! at every point of the surface, layers apply in the order given, and what cannot be meant is refused with the
//! file, the row, the value and what to do.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

use std::path::{Path, PathBuf};

use glam::DVec3;
use homunculus::boundary::{self, Attribute, Boundary};
use homunculus::importance::{CLAMP_MAX, CLAMP_MIN, Layer, Sample, Stack};
use tempfile::TempDir;

/// A square of two triangles in the plane z = 0, corners 0 (0,0), 1 (1,0), 2 (1,1), 3 (0,1).
fn square() -> Boundary {
    let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
    let positions = corners.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec();
    Boundary::from_triangles("square", positions, vec![[0, 1, 2], [0, 2, 3]])
}

fn with_attribute(values: [f32; 4]) -> Boundary {
    let mut boundary = square();
    boundary.attributes.push(Attribute { name: "heat".into(), values: values.to_vec() });
    boundary
}

fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

fn sphere(x: f64, radius: f64, value: f32) -> Layer {
    Layer::Sphere { centre: [x, 0.0, 0.0], radius, value }
}

fn values() -> Layer {
    Layer::Values { path: "v.csv".into() }
}

fn regions() -> Layer {
    Layer::Regions { regions: "r.csv".into(), values: "v.csv".into(), per_area: false }
}

fn refusal(layer: Layer, files: &[(&str, &str)], boundary: &Boundary) -> String {
    let folder = folder(files);
    let error = Stack::load(&[layer], 1.0, false, boundary, folder.path()).unwrap_err();
    error.to_string().replace(&format!("{}/", folder.path().display()), "")
}

fn near(found: &[f32], expected: &[f32]) -> bool {
    found.len() == expected.len() && found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= 1e-6 * b)
}

#[test]
fn values_set_what_they_list() {
    let folder = folder(&[("v.csv", "\u{feff}note, vertex ,Importance\nx,2,3.5\n\n,0,0.5\n")]);
    let stack = Stack::load(&[values()], 1.25, false, &square(), folder.path()).unwrap();
    assert!(near(&stack.at_vertices(&square()), &[0.5, 1.25, 3.5, 1.25]));
    assert!(stack.warnings().is_empty());
}

#[test]
fn each_bad_value_is_named() {
    let header = "vertex,importance\n";
    let cases = [
        ("0,1\n4,2", "v.csv: row 3: unknown vertex 4: the mesh has 4 vertices"),
        ("1,1\n0,2\n1,3", "v.csv: row 4: vertex 1 was already given on row 2"),
        ("-1,1", "v.csv: row 2: vertex `-1` is not a whole number"),
        ("nose,1", "v.csv: row 2: vertex `nose` is not a whole number"),
        ("0,much", "v.csv: row 2: importance `much` is not a number"),
        ("0,1\n1,0", "v.csv: row 3: importance 0 is not greater than 0"),
        ("0,-2", "v.csv: row 2: importance -2 is not greater than 0"),
        ("0,nan", "v.csv: row 2: importance nan is not finite"),
        ("0,1e99", "v.csv: row 2: importance 1e99 is not finite"),
        ("0", "v.csv: row 2: `importance` is missing"),
        ("0,", "v.csv: row 2: `importance` is missing"),
        ("", "v.csv: there is no row below the header"),
    ];
    for (rows, expected) in cases {
        let found = refusal(values(), &[("v.csv", &format!("{header}{rows}\n"))], &square());
        assert!(found.starts_with(expected), "{rows:?} gave {found:?}, not {expected:?}");
        assert!(found.contains("; ") || found.contains("pass --clamp"), "{found:?} does not say what to do");
    }
}

#[test]
fn each_bad_table_is_named() {
    type Case = (Layer, &'static [(&'static str, &'static str)], &'static str);
    let cases: [Case; 9] = [
        (values(), &[], "v.csv: cannot read"),
        (values(), &[("v.csv", "")], "v.csv: row 1: the column `vertex` is missing (the file is empty)"),
        (values(), &[("v.csv", "0,1\n")], "v.csv: row 1: the column `vertex` is missing (it has `0`, `1`)"),
        (values(), &[("v.csv", "vertex,size\n0,1\n")], "v.csv: row 1: the column `importance` is missing"),
        (regions(), &[("r.csv", "vertex,region\n0,arm\n")], "v.csv: cannot read"),
        (
            regions(),
            &[("r.csv", "vertex,region\n0,arm\n"), ("v.csv", "region,importance\narm,2\nleg,1\n")],
            "v.csv: row 3: unknown region `leg`: r.csv has no vertex",
        ),
        (
            regions(),
            &[("r.csv", "vertex,region\n0,arm\n1,leg\n"), ("v.csv", "region,importance\narm,2\n")],
            "v.csv: region `leg` has no value, but r.csv uses it on row 3",
        ),
        (
            regions(),
            &[("r.csv", "vertex,region\n0,arm\n"), ("v.csv", "region,importance\narm,2\narm,3\n")],
            "v.csv: row 3: region `arm` was already given on row 2",
        ),
        (
            regions(),
            &[("r.csv", "vertex,region\n0,arm\n0,leg\n"), ("v.csv", "region,importance\narm,2\n")],
            "r.csv: row 3: vertex 0 was already given on row 2",
        ),
    ];
    for (layer, files, expected) in cases {
        let found = refusal(layer, files, &square());
        assert!(found.starts_with(expected), "{files:?} gave {found:?}, not {expected:?}");
    }
    let latin = tempfile::tempdir().unwrap();
    std::fs::write(latin.path().join("v.csv"), b"vertex,importance\n0,\xff\n").unwrap();
    let error = Stack::load(&[values()], 1.0, false, &square(), latin.path()).unwrap_err().to_string();
    assert!(error.contains("row 2") && error.contains("UTF-8"), "{error}");
}

#[test]
fn a_directory_is_no_table() {
    let folder = tempfile::tempdir().unwrap();
    let layer = Layer::Values { path: PathBuf::new() };
    let error = Stack::load(&[layer], 1.0, false, &square(), folder.path()).unwrap_err().to_string();
    assert!(error.contains("cannot read"), "{error}");
}

#[test]
fn sabotage_a_good_table_is_not_refused() {
    let folder =
        folder(&[("r.csv", "vertex,region\n0,arm\n2,leg\n"), ("v.csv", "region,importance\nleg,0.5\narm,2\n")]);
    let stack = Stack::load(&[regions()], 1.0, false, &square(), folder.path()).unwrap();
    assert!(near(&stack.at_vertices(&square()), &[2.0, 1.0, 0.5, 1.0]));
    let labels = stack.regions().unwrap();
    assert_eq!(labels.names, ["arm", "leg"]);
    assert_eq!(labels.of_vertex, [0, u32::MAX, 1, u32::MAX]);
}

#[test]
fn clamp_admits_and_counts() {
    let folder = folder(&[("v.csv", "vertex,importance\n0,-7\n1,inf\n2,nan\n3,3\n")]);
    let stack = Stack::load(&[values()], 2.0, true, &square(), folder.path()).unwrap();
    assert!(near(&stack.at_vertices(&square()), &[CLAMP_MIN, CLAMP_MAX, 2.0, 3.0]));
    assert_eq!(stack.clamped(), 3);
    assert!(stack.warnings()[0].contains("3 values"), "{:?}", stack.warnings());
}

#[test]
fn extreme_importance_is_warned_of() {
    let stack = Stack::load(&[sphere(0.0, 1.0, 30.0)], 1.0, false, &square(), Path::new("")).unwrap();
    assert!(stack.warnings()[0].contains("30-fold"), "{:?}", stack.warnings());
    let stack = Stack::load(&[sphere(0.0, 1.0, 20.0)], 1.0, false, &square(), Path::new("")).unwrap();
    assert!(stack.warnings().is_empty());
}

#[test]
fn a_sphere_that_touches_nothing_is_warned_of() {
    let warnings = |x, radius| {
        let stack = Stack::load(&[sphere(x, radius, 2.0)], 1.0, false, &square(), Path::new("")).unwrap();
        stack.warnings().to_vec()
    };
    assert!(warnings(5.0, 3.9)[0].contains("[5, 0, 0]"), "{:?}", warnings(5.0, 3.9));
    assert!(warnings(5.0, 4.1).is_empty());
}

#[test]
fn attributes_are_importance_or_mapped_to_a_range() {
    let boundary = with_attribute([2.0, 4.0, 3.0, 2.5]);
    let layer = |range| Layer::Attribute { name: "heat".into(), range };
    let load = |range| Stack::load(&[layer(range)], 1.0, false, &boundary, Path::new(""));
    assert!(near(&load(None).unwrap().at_vertices(&boundary), &[2.0, 4.0, 3.0, 2.5]));
    assert!(near(&load(Some((0.5, 1.5))).unwrap().at_vertices(&boundary), &[0.5, 1.5, 1.0, 0.75]));
    assert!(near(&load(Some((1.5, 0.5))).unwrap().at_vertices(&boundary), &[1.5, 0.5, 1.0, 1.25]));
    assert!(load(Some((0.0, 1.0))).is_err());

    let poisoned = with_attribute([1.0, f32::NAN, 2.0, 3.0]);
    for range in [None, Some((1.0, 2.0))] {
        let error = Stack::load(&[layer(range)], 1.0, false, &poisoned, Path::new("")).unwrap_err().to_string();
        assert!(error.starts_with("attribute `heat`: vertex 1: importance NaN is not finite"), "{error}");
    }
    let clamped = Stack::load(&[layer(Some((1.0, 2.0)))], 4.0, true, &poisoned, Path::new("")).unwrap();
    assert!(near(&clamped.at_vertices(&poisoned), &[1.0, 4.0, 1.5, 2.0]));

    let flat = with_attribute([7.0; 4]);
    let stack = Stack::load(&[layer(Some((1.0, 2.0)))], 1.0, false, &flat, Path::new("")).unwrap();
    assert!(near(&stack.at_vertices(&flat), &[1.5; 4]) && stack.warnings()[0].contains("everywhere"));

    let error = refusal(Layer::Attribute { name: "cold".into(), range: None }, &[], &boundary);
    assert!(error.contains("`cold`") && error.contains("`heat`"), "{error}");
}

/// Importance at vertex 0 and 1 under layers that overlap at vertex 0.
fn in_order(layers: &[Layer]) -> bool {
    let folder = folder(&[("v.csv", "vertex,importance\n0,3\n")]);
    let stack = Stack::load(layers, 1.0, false, &square(), folder.path()).unwrap();
    near(&stack.at_vertices(&square())[..2], &[3.0, 1.0])
}

#[test]
fn layers_apply_in_the_order_given() {
    assert!(in_order(&[sphere(0.0, 0.5, 2.0), values()]));
}

#[test]
fn sabotage_another_order_is_another_result() {
    assert!(!in_order(&[values(), sphere(0.0, 0.5, 2.0)]));
}

#[test]
fn samples_see_spheres_between_vertices() {
    let boundary = square();
    let stack = Stack::load(&[sphere(0.5, 0.25, 4.0)], 1.0, false, &boundary, Path::new("")).unwrap();
    let on_edge = |w: f32| Sample { triangle: 0, weights: [1.0 - w, w, 0.0] };
    let found = stack.evaluate(&boundary, &[on_edge(0.0), on_edge(0.5), on_edge(0.625), on_edge(1.0)]);
    assert!(near(&found, &[1.0, 4.0, 2.0, 1.0]), "{found:?}");
    assert!(near(&stack.at_vertices(&boundary), &[1.0; 4]), "no vertex is in the sphere");
}

#[test]
fn samples_between_vertices_blend_in_the_logarithm() {
    let boundary = with_attribute([1.0, 4.0, 1.0, 1.0]);
    let layer = Layer::Attribute { name: "heat".into(), range: None };
    let stack = Stack::load(&[layer], 1.0, false, &boundary, Path::new("")).unwrap();
    let found = stack.evaluate(&boundary, &[Sample { triangle: 0, weights: [0.5, 0.5, 0.0] }]);
    assert!(near(&found, &[2.0]), "half-way from 1 to 4 is 2, not {found:?}");
}

#[test]
fn a_sample_out_of_range_gets_the_base() {
    let stack = Stack::load(&[sphere(0.0, 9.0, 2.0)], 1.5, false, &square(), Path::new("")).unwrap();
    let found = stack.evaluate(&square(), &[Sample { triangle: 99, weights: [1.0, 0.0, 0.0] }]);
    assert!(near(&found, &[1.5]), "{found:?}");
}

/// A picture that is white in its upper right quarter, transparent in its upper left, and black below; or upside down.
fn save_picture(folder: &Path, flip: bool) {
    let mut picture = image::RgbaImage::from_pixel(8, 8, image::Rgba([0, 0, 0, 255]));
    for (x, y, pixel) in picture.enumerate_pixels_mut() {
        if (y < 4) != flip {
            *pixel = if x < 4 { image::Rgba([255, 255, 255, 0]) } else { image::Rgba([255; 4]) };
        }
    }
    picture.save(folder.join("map.png")).unwrap();
}

/// Importance at the vertices of a mesh under the picture, 1.5 where it is transparent.
fn picture_at_corners(folder: &Path, mesh: &str) -> Vec<f32> {
    let boundary = boundary::read(&folder.join(mesh)).unwrap();
    let layer = Layer::Image { path: "map.png".into(), range: Some((0.5, 3.0)) };
    Stack::load(&[layer], 1.5, false, &boundary, folder).unwrap().at_vertices(&boundary)
}

/// The square as OBJ, where v points up.
fn under_picture(flip: bool) -> Vec<f32> {
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n";
    let folder = folder(&[("square.obj", square)]);
    save_picture(folder.path(), flip);
    picture_at_corners(folder.path(), "square.obj")
}

#[test]
fn pictures_stand_upright() {
    assert!(near(&under_picture(false), &[0.5, 0.5, 3.0, 1.5]), "{:?}", under_picture(false));
}

#[test]
fn sabotage_an_inverted_picture_is_seen() {
    assert!(!near(&under_picture(true), &[0.5, 0.5, 3.0, 1.5]));
}

/// The same square as glTF, where v points down; texture coordinates as in the OBJ, seen from the other end.
#[test]
fn pictures_stand_upright_on_gltf_too() {
    let floats = [
        [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0].as_slice(),
        [0.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0].as_slice(),
    ];
    let mut bytes: Vec<u8> = floats.concat().iter().flat_map(|f: &f32| f.to_le_bytes()).collect();
    bytes.extend([0u16, 1, 2, 0, 2, 3].iter().flat_map(|i| i.to_le_bytes()));
    let accessor = |view: u32, kind: &str, component: u32, count: u32| {
        serde_json::json!({ "bufferView": view, "type": kind, "componentType": component, "count": count,
            "min": [0.0, 0.0, 0.0], "max": [1.0, 1.0, 0.0] })
    };
    let gltf = serde_json::json!({
        "asset": { "version": "2.0" },
        "buffers": [{ "byteLength": bytes.len(), "uri": "square.bin" }],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": 48 },
            { "buffer": 0, "byteOffset": 48, "byteLength": 32 },
            { "buffer": 0, "byteOffset": 80, "byteLength": 12 },
        ],
        "accessors": [accessor(0, "VEC3", 5126, 4), accessor(1, "VEC2", 5126, 4), accessor(2, "SCALAR", 5123, 6)],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "TEXCOORD_0": 1 }, "indices": 2 }] }],
        "nodes": [{ "mesh": 0 }],
        "scenes": [{ "nodes": [0] }],
        "scene": 0,
    });
    let folder = folder(&[("square.gltf", &gltf.to_string())]);
    std::fs::write(folder.path().join("square.bin"), bytes).unwrap();
    save_picture(folder.path(), false);
    assert_eq!(picture_at_corners(folder.path(), "square.gltf").len(), 4);
    assert!(near(&picture_at_corners(folder.path(), "square.gltf"), &[0.5, 0.5, 3.0, 1.5]));
}

#[test]
fn each_side_of_a_seam_sees_its_own_part_of_the_picture() {
    // Both triangles of the square lie on the whole of the picture's left half and right half in turn.
    let square =
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0.2 0.2\nvt 0.8 0.2\nvt 0.8 0.8\nf 1/1 2/1 3/1\nf 1/3 3/3 4/3\n";
    let folder = folder(&[("square.obj", square)]);
    save_picture(folder.path(), false);
    let boundary = boundary::read(&folder.path().join("square.obj")).unwrap();
    let layer = Layer::Image { path: "map.png".into(), range: Some((0.5, 3.0)) };
    let stack = Stack::load(&[layer], 1.5, false, &boundary, folder.path()).unwrap();
    let at_vertex_0 = |triangle| Sample { triangle, weights: [1.0, 0.0, 0.0] };
    assert!(near(&stack.evaluate(&boundary, &[at_vertex_0(0), at_vertex_0(1)]), &[0.5, 3.0]));
}

#[test]
fn pictures_need_texture_coordinates_and_to_be_pictures() {
    let layer = || Layer::Image { path: "map.png".into(), range: None };
    let found = refusal(layer(), &[("map.png", "no picture")], &square());
    assert!(found.starts_with("map.png: square has no texture coordinates"), "{found}");
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nf 1/1 2/1 3/1\n";
    let folder = folder(&[("map.png", "no picture"), ("t.obj", text)]);
    let boundary = boundary::read(&folder.path().join("t.obj")).unwrap();
    let error = Stack::load(&[layer()], 1.0, false, &boundary, folder.path()).unwrap_err().to_string();
    assert!(error.contains("map.png: not a picture"), "{error}");
}

#[test]
fn the_same_bits_for_any_number_of_threads() {
    let boundary = with_attribute([0.3, 4.0, 1.7, 2.2]);
    let layers = [Layer::Attribute { name: "heat".into(), range: None }, sphere(0.3, 0.9, 5.0)];
    let stack = Stack::load(&layers, 1.0, false, &boundary, Path::new("")).unwrap();
    let sample = |i: u32| {
        let (a, b) = ((i % 97) as f32 / 194.0, (i % 89) as f32 / 178.0);
        Sample { triangle: i % 2, weights: [a, b, 1.0 - a - b] }
    };
    let samples: Vec<_> = (0..10_000).map(sample).collect();
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| stack.evaluate(&boundary, &samples))
    };
    let one = with(1);
    let extreme = |pick: fn(f32, f32) -> f32| one.iter().copied().reduce(pick).unwrap();
    assert!(extreme(f32::max) > 2.0 * extreme(f32::min), "there is something to compare");
    for threads in [2, 3, 7] {
        assert!(with(threads).iter().zip(&one).all(|(a, b)| a.to_bits() == b.to_bits()));
    }
}
