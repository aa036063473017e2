//! Contract of `boundary`: every format gives the vertices and triangles of the file, in its order, in world positions, with
//! the attributes, texture coordinates and regions it names.
#![expect(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test that cannot be set up has failed; one that is skipped says so"
)]

use std::path::{Path, PathBuf};

use glam::{DVec3, Vec2};
use homunculus::boundary::{self, Boundary};
use serde_json::{Value, json};

/// Writes bytes to a file of a fresh folder and reads them.
fn read_bytes(name: &str, bytes: &[u8]) -> Boundary {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    let boundary = boundary::read(&path).unwrap_or_else(|error| panic!("{error}"));
    assert!(boundary.is_sound());
    boundary
}

fn attribute<'a>(boundary: &'a Boundary, name: &str) -> &'a [f32] {
    &boundary.attributes.iter().find(|a| a.name == name).unwrap_or_else(|| panic!("no attribute {name}")).values
}

/// Six times the enclosed volume, by the divergence theorem: exact for the cubes here.
fn volume(boundary: &Boundary) -> f64 {
    let corner = |v: u32| boundary.positions[v as usize];
    boundary.triangles.iter().map(|&[a, b, c]| corner(a).dot(corner(b).cross(corner(c)))).sum::<f64>() / 6.0
}

const CORNERS: [[f32; 3]; 8] =
    [[0., 0., 0.], [2., 0., 0.], [2., 2., 0.], [0., 2., 0.], [0., 0., 2.], [2., 0., 2.], [2., 2., 2.], [0., 2., 2.]];
const QUADS: [[u32; 4]; 6] = [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];

fn lines(items: impl IntoIterator<Item = String>) -> String {
    items.into_iter().collect::<Vec<_>>().join("\n") + "\n"
}

fn words<T: ToString>(items: &[T]) -> String {
    items.iter().map(T::to_string).collect::<Vec<_>>().join(" ")
}

/// The cube of edge 2 in every format and encoding.
fn cubes() -> Vec<(&'static str, Vec<u8>)> {
    let obj = lines(
        CORNERS
            .iter()
            .map(|c| format!("v {}", words(c)))
            .chain(QUADS.iter().map(|q| format!("f {}", words(&q.map(|i| i + 1))))),
    );
    let off = format!(
        "OFF\n8 6 0\n{}{}",
        lines(CORNERS.iter().map(|c| words(c))),
        lines(QUADS.iter().map(|q| format!("4 {}", words(q))))
    );
    let head = |encoding: &str| {
        format!(
            "ply\nformat {encoding} 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\nelement face 6\nproperty list uchar int vertex_indices\nend_header\n"
        )
    };
    let ply_text = head("ascii")
        + &lines(CORNERS.iter().map(|c| words(c)))
        + &lines(QUADS.iter().map(|q| format!("4 {}", words(q))));
    let binary = |encoding: &str, float: fn(f32) -> [u8; 4], int: fn(u32) -> [u8; 4]| {
        let mut out = head(encoding).into_bytes();
        out.extend(CORNERS.iter().flatten().flat_map(|&x| float(x)));
        QUADS.iter().for_each(|q| {
            out.push(4);
            out.extend(q.iter().flat_map(|&i| int(i)));
        });
        out
    };
    let triangles: Vec<[u32; 3]> = QUADS.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
    let facet = |t: &[u32; 3]| {
        format!(
            "facet normal 0 0 0\nouter loop\n{}endloop\nendfacet",
            lines(t.iter().map(|&v| format!("vertex {}", words(&CORNERS[v as usize]))))
        )
    };
    let stl_text = format!("solid cube\n{}endsolid cube\n", lines(triangles.iter().map(facet)));
    // A binary STL may start with the word of the text format all the same.
    let mut stl = b"solid in name only".to_vec();
    stl.resize(80, b' ');
    stl.extend((triangles.len() as u32).to_le_bytes());
    for t in &triangles {
        stl.extend([0; 12]);
        stl.extend(t.iter().flat_map(|&v| CORNERS[v as usize]).flat_map(f32::to_le_bytes));
        stl.extend([0; 2]);
    }
    let flat: Vec<f32> = CORNERS.iter().flatten().copied().collect();
    let glb = glb(
        json!({ "nodes": [{ "mesh": 0 }], "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }] }),
        &[(&flat, "VEC3")],
        &triangles.iter().flatten().copied().collect::<Vec<_>>(),
    );
    vec![
        ("a.obj", obj.into_bytes()),
        ("a.off", off.into_bytes()),
        ("a.ply", ply_text.into_bytes()),
        ("le.ply", binary("binary_little_endian", f32::to_le_bytes, u32::to_le_bytes)),
        ("be.ply", binary("binary_big_endian", f32::to_be_bytes, u32::to_be_bytes)),
        ("a.stl", stl_text.into_bytes()),
        ("b.stl", stl),
        ("a.glb", glb),
    ]
}

/// A GLB of float accessors 0, 1, … and, last, one of indices if there are any. The JSON is completed.
fn glb(mut root: Value, floats: &[(&[f32], &str)], indices: &[u32]) -> Vec<u8> {
    let mut binary: Vec<u8> = Vec::new();
    let (mut views, mut accessors) = (Vec::new(), Vec::new());
    let mut add = |bytes: Vec<u8>, component: u32, count: usize, kind: &str| {
        views.push(json!({ "buffer": 0, "byteOffset": binary.len(), "byteLength": bytes.len() }));
        accessors
            .push(json!({ "bufferView": views.len() - 1, "componentType": component, "count": count, "type": kind }));
        binary.extend(bytes);
    };
    for (values, kind) in floats {
        let width = match *kind {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => 16,
        };
        add(values.iter().flat_map(|v| v.to_le_bytes()).collect(), 5126, values.len() / width, kind);
    }
    if !indices.is_empty() {
        add(indices.iter().flat_map(|i| i.to_le_bytes()).collect(), 5125, indices.len(), "SCALAR");
    }
    root["asset"] = json!({ "version": "2.0" });
    root["bufferViews"] = json!(views);
    if let Some(patches) = root.as_object_mut().unwrap().remove("accessorPatches") {
        for (index, patch) in patches.as_object().unwrap() {
            accessors[index.parse::<usize>().unwrap()]
                .as_object_mut()
                .unwrap()
                .extend(patch.as_object().unwrap().clone());
        }
    }
    root["accessors"] = json!(accessors);
    root["buffers"] = json!([{ "byteLength": binary.len() }]);
    let mut text = root.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut out = b"glTF\x02\0\0\0".to_vec();
    out.extend((28 + text.len() as u32 + binary.len() as u32).to_le_bytes());
    out.extend((text.len() as u32).to_le_bytes());
    out.extend(b"JSON");
    out.extend(text);
    out.extend((binary.len() as u32).to_le_bytes());
    out.extend(b"BIN\0");
    out.extend(binary);
    out
}

const TRIANGLE: &[f32] = &[0., 0., 0., 1., 0., 0., 0., 1., 0.];

#[test]
fn the_cube_is_the_same_in_every_format() {
    for (name, bytes) in cubes() {
        // Neither needs its extension: the content says which it is, save that of an OFF-like OBJ, which is guessed.
        for name in [name, "unnamed"] {
            let cube = read_bytes(name, &bytes);
            let welded = cube.welded();
            assert_eq!(volume(&cube), 8.0, "{name}");
            assert_eq!((cube.components(&welded), cube.boundary_loops(&welded)), (1, 0), "{name}");
            assert_eq!(cube.bounds(), Some((DVec3::ZERO, DVec3::splat(2.0))), "{name}");
            assert_eq!(cube.triangles.len(), 12, "{name}");
            let is_soup = cube.positions.len() == 36;
            assert!(is_soup || cube.positions.iter().zip(CORNERS).all(|(p, c)| p.as_vec3().to_array() == c), "{name}");
        }
    }
}

#[test]
fn sabotage_a_missing_and_a_turned_face_are_seen() {
    let mut cube = read_bytes("a.obj", &cubes()[0].1);
    let top = cube.triangles.remove(2);
    let welded = cube.welded();
    assert_eq!(cube.boundary_loops(&welded), 1);
    cube.triangles.push([top[0], top[2], top[1]]);
    assert_ne!(volume(&cube), 8.0);
    cube.triangles[0][0] = 99;
    assert!(!cube.is_sound());
}

#[test]
fn obj_says_more_than_triangles() {
    let text = "\
# two objects, an arrow head (concave), counted backwards, continued lines
mtllib none.mtl
o arrow\nv 4 -3 0 1 0 0\nv 1 0 0 0 1 0\nv 4 3 0 0 0 1\nv 0 0 0 0.5 0.5 0.5
vt 0.25 0.75\nvt 1 1
vn 0 0 1
usemtl red
f -4/1/1 -3/2/1 \\\n -2/1/1 -1//1
o flat\nv 0 0 1\nv 1 0 1\nv 0 1 1
f 5/2 6/2 7/2 # a comment
l 1 2\nf 1 2
";
    let mesh = read_bytes("a.obj", text.as_bytes());
    assert_eq!(mesh.positions.len(), 7);
    assert_eq!(mesh.triangles.len(), 3);
    let areas = mesh.triangles[..2].iter().map(|t| {
        let [a, b, c] = t.map(|v| mesh.positions[v as usize]);
        (b - a).cross(c - a).z
    });
    assert!(areas.into_iter().all(|z| z > 0.0), "the concave corner is cut right");
    let uvs = mesh.vertex_uvs().unwrap();
    assert_eq!(uvs[0], Some(Vec2::new(0.25, 0.25)), "v counts downwards");
    assert_eq!((uvs[3], uvs[4]), (None, Some(Vec2::new(1.0, 0.0))));
    assert_eq!(attribute(&mesh, "green"), [0.0, 1.0, 0.0, 0.5, 1.0, 1.0, 1.0]);
    let regions = mesh.regions.as_ref().unwrap();
    assert_eq!(regions.names, ["arrow", "flat"]);
    assert_eq!(regions.of_vertex, [0, 0, 0, 0, 1, 1, 1]);
    assert_eq!(mesh.warnings.len(), 2, "{:?}", mesh.warnings);
    let colours = mesh.base_colours().unwrap();
    assert!((colours[3][0] - 0.214).abs() < 1e-3, "sRGB 0.5 is linear 0.214");
}

#[test]
fn materials_name_the_regions_where_objects_do_not() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl skin\nf 1 2 3\nusemtl nail\nf 1 2 4\n";
    let regions = read_bytes("a.obj", text.as_bytes()).regions.unwrap();
    assert_eq!((regions.names, regions.of_vertex), (vec!["skin".to_owned(), "nail".to_owned()], vec![0, 0, 0, 1]));
    assert!(read_bytes("a.obj", text.replace("nail", "skin").as_bytes()).regions.is_none());
}

#[test]
fn ply_keeps_every_property() {
    let text = "ply\nformat ascii 1.0\ncomment by hand\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n\
        property float quality\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty float s\nproperty float t\n\
        element face 1\nproperty list uchar int vertex_index\nproperty int label\nend_header\n\
        0.1 0 0 7 255 0 0 0 1\n1 0 0 8 0 255 0 1 1\n0 1 0 9 0 0 51 0 0\n3 0 1 2 5\n";
    let mesh = read_bytes("a.ply", text.as_bytes());
    assert_eq!(mesh.positions[0].x, 0.1);
    assert_eq!(attribute(&mesh, "quality"), [7.0, 8.0, 9.0]);
    assert_eq!(attribute(&mesh, "blue"), [0.0, 0.0, 0.2]);
    assert_eq!(mesh.vertex_uvs().unwrap()[0], Some(Vec2::ZERO));
}

#[test]
fn ply_is_read_as_writers_write_it() {
    let text = "ply\rformat ascii 1.0\rcomment gr@n\robj_info two\relement vertex 3\rproperty float x\rproperty float y\rproperty float z\r\
        property float velocity.x\relement face 1\rproperty list uchar int vertex_indices\rend_header\r0 0 0 nan\r.5 0 0 1.\r\r0 1\r0 -inf\r3 0 1 2";
    for ends in ["\r", "\n", "\r\n"] {
        let mut bytes = text.replace('\r', ends).into_bytes();
        // Latin-1.
        *bytes.iter_mut().find(|b| **b == b'@').unwrap() = 0xFC;
        let mesh = read_bytes("a.ply", &bytes);
        let values = attribute(&mesh, "velocity.x");
        assert!(values[0].is_nan() && values[1..] == [1.0, f32::NEG_INFINITY], "{values:?}");
        assert_eq!((mesh.positions[1].x, mesh.triangles.len()), (0.5, 1));
    }
}

#[test]
fn stl_texts_keep_every_solid_and_digit() {
    let solid = |name: &str, x: &str| {
        format!(
            "solid {name}\nfacet normal nan nan nan\nouter loop\nvertex {x} 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid {name}\n"
        )
    };
    let mesh = read_bytes("a.stl", (solid("a", "500123.456") + &solid("b", "0")).as_bytes());
    assert_eq!((mesh.triangles.len(), mesh.positions[0].x), (2, 500_123.456));
    assert_eq!(mesh.regions.unwrap().names, ["a", "b"]);
}

#[test]
fn off_variants_are_read() {
    let coff =
        "COFF # colours\n3 1 0\n0 0 0 255 0 0 255\n1 0 0 0 255 0 255 # green\n\n0 1 0 0 0 255 255\n3 0 1 2 10 20 30\n";
    let mesh = read_bytes("a.off", coff.as_bytes());
    assert_eq!(attribute(&mesh, "green"), [0.0, 1.0, 0.0]);
    let noff = "NOFF 3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n";
    assert_eq!(read_bytes("a.off", noff.as_bytes()).positions.len(), 3);
    assert!(mesh.attributes.iter().all(|a| a.name != "alpha"));
}

#[test]
fn gltf_nodes_are_baked_and_mirrors_turned() {
    let root = json!({
        "nodes": [{ "children": [1, 2], "translation": [0, 0, 5] }, { "mesh": 0, "name": "one", "scale": [2, 2, 2] }, { "mesh": 0, "name": "two", "scale": [-1, 1, 1] }],
        "scenes": [{ "nodes": [0] }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "_PRESSURE": 1, "COLOR_0": 2 }, "material": 7 }] }],
    });
    let colours = [0.5f32; 9];
    let mesh =
        read_bytes("a.glb", &glb(root, &[(TRIANGLE, "VEC3"), (&[1., 2., 3.], "SCALAR"), (&colours, "VEC3")], &[]));
    assert_eq!(mesh.positions[1], DVec3::new(2.0, 0.0, 5.0));
    assert_eq!(mesh.positions[4], DVec3::new(-1.0, 0.0, 5.0));
    let up = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| mesh.positions[v as usize]);
        (b - a).cross(c - a).z
    };
    assert!(mesh.triangles.iter().all(|t| up(t) > 0.0), "a mirrored instance keeps its outside");
    assert_eq!(attribute(&mesh, "_PRESSURE"), [1.0, 2.0, 3.0, 1.0, 2.0, 3.0]);
    assert_eq!(attribute(&mesh, "COLOR_0.g")[5], 0.5);
    assert_eq!(mesh.base_colours().unwrap()[0], [0.5, 0.5, 0.5, 1.0], "glTF colours are linear already");
    assert_eq!(mesh.regions.unwrap().names, ["one", "two"]);
}

#[test]
fn gltf_strips_fans_and_sparse_accessors() {
    let square: Vec<f32> = vec![0., 0., 0., 1., 0., 0., 0., 1., 0., 1., 1., 0.];
    let mesh = |mode: u32| json!({ "nodes": [{ "mesh": 0 }], "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "mode": mode }] }] });
    let strip = read_bytes("a.glb", &glb(mesh(5), &[(&square, "VEC3")], &[]));
    assert_eq!(strip.triangles, [[0, 1, 2], [2, 1, 3]]);
    let fan = read_bytes("a.glb", &glb(mesh(6), &[(&square, "VEC3")], &[]));
    assert_eq!(fan.triangles, [[0, 1, 2], [0, 2, 3]]);
    let mut root = mesh(4);
    root["accessorPatches"] = json!({ "0": { "sparse": { "count": 1, "indices": { "bufferView": 2, "componentType": 5125 }, "values": { "bufferView": 1 } } } });
    let sparse = read_bytes("a.glb", &glb(root, &[(TRIANGLE, "VEC3"), (&[9., 9., 9.], "VEC3")], &[2]));
    assert_eq!(sparse.positions[2], DVec3::splat(9.0));
}

#[test]
fn gltf_numbers_of_every_type_are_read() {
    // Positions in shorts with a gap after each, colours in normalized bytes, and what only viewers with extensions understand.
    let mut binary: Vec<u8> = Vec::new();
    for [x, y, z] in [[-300i16, 0, 0], [300, 0, 0], [0, 300, 0]] {
        binary.extend([x, y, z, 9].into_iter().flat_map(i16::to_le_bytes));
    }
    binary.extend([255, 0, 51, 255, 255, 0, 51, 255, 255, 0, 51, 0]);
    let uri = format!(
        "data:application/octet-stream;base64,{}",
        base64::Engine::encode(&base64::prelude::BASE64_STANDARD, &binary)
    );
    let root = json!({
        "asset": { "version": "2.0" }, "scenes": [{}, { "nodes": [0] }], "scene": 1, "nodes": [{ "mesh": 0 }],
        "extensionsRequired": ["KHR_mesh_quantization"],
        "animations": [{ "channels": [{ "sampler": 0, "target": { "path": "pointer" } }], "samplers": [] }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "COLOR_0": 1, "UNKNOWN": 77 } }, { "mode": 9 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5122, "count": 3, "type": "VEC3" },
            { "bufferView": 1, "componentType": 5121, "normalized": true, "count": 3, "type": "VEC4" },
        ],
        "bufferViews": [{ "buffer": 0, "byteLength": 24, "byteStride": 8 }, { "buffer": 0, "byteOffset": 24, "byteLength": 12 }],
        "buffers": [{ "byteLength": 36, "uri": uri }],
    });
    let mesh = read_bytes("a.gltf", root.to_string().as_bytes());
    assert_eq!(mesh.positions[2], DVec3::new(0.0, 300.0, 0.0));
    assert_eq!(attribute(&mesh, "COLOR_0.b"), [0.2; 3]);
    assert_eq!(attribute(&mesh, "COLOR_0.a"), [1.0, 1.0, 0.0]);
}

#[test]
fn gltf_skins_stand_at_rest_and_their_joints_are_regions() {
    let identity: Vec<f32> = glam::Mat4::IDENTITY.to_cols_array().into();
    let raised: Vec<f32> = glam::Mat4::from_translation(glam::Vec3::Y).to_cols_array().into();
    let matrices = [identity, raised].concat();
    let root = json!({
        // The node's own transform has no part in a skinned mesh; the joints' have.
        "nodes": [{ "mesh": 0, "skin": 0, "translation": [100, 0, 0] }, { "name": "root", "translation": [0, 0, 1] }, { "name": "tip", "translation": [0, 0, 2] }],
        "skins": [{ "joints": [1, 2], "inverseBindMatrices": 3 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "JOINTS_0": 1, "WEIGHTS_0": 2 } }] }],
    });
    let joints = [0., 1., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0.];
    let weights = [1., 0., 0., 0., 1., 0., 0., 0., 0.25, 0.75, 0., 0.];
    let mesh = read_bytes(
        "a.glb",
        &glb(root, &[(TRIANGLE, "VEC3"), (&joints, "VEC4"), (&weights, "VEC4"), (&matrices, "MAT4")], &[]),
    );
    assert_eq!(mesh.positions, [DVec3::new(0., 0., 1.), DVec3::new(1., 1., 2.), DVec3::new(0., 1.75, 1.75)]);
    let regions = mesh.regions.unwrap();
    assert_eq!((regions.names, regions.of_vertex), (vec!["root".to_owned(), "tip".to_owned()], vec![0, 1, 1]));
}

#[test]
fn gltf_primitives_that_share_accessors_share_vertices() {
    let root = json!({ "nodes": [{ "mesh": 0 }], "meshes": [{ "primitives": [
        { "attributes": { "POSITION": 0 }, "indices": 1 }, { "attributes": { "POSITION": 0 }, "indices": 1 }, { "attributes": { "POSITION": 0 }, "mode": 1 } ] }] });
    let mesh = read_bytes("a.glb", &glb(root, &[(TRIANGLE, "VEC3")], &[0, 1, 2]));
    assert_eq!((mesh.positions.len(), mesh.triangles.len()), (3, 2));
    assert_eq!(mesh.warnings.len(), 1);
}

/// Real meshes, or `None`, said aloud, where they are not there.
fn shared(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data/meshes").join(name);
    if !path.exists() {
        println!("skipped: {} is not there", path.display());
    }
    path.exists().then_some(path)
}

#[test]
fn real_meshes_have_the_counts_their_makers_say() {
    let expected = [
        ("CesiumMan.glb", 3273, 4672),
        ("Duck.glb", 2399, 4212),
        ("armadillo.obj", 14587, 29170),
        ("hand.off", 1197, 2390),
        ("airplane.ply", 1335, 2452),
        ("spider.stl", 4104, 1368),
        ("wheel_scaled.stl", 12168, 4056),
        ("JapaneseLantern.obj", 400, 888),
        ("makehuman_lowpoly_3pc.obj", 369, 734),
        ("hra_female_skin.glb", 62176, 124_348),
        ("streetlight.gltf", 190, 176),
    ];
    for (name, vertices, triangles) in expected {
        let Some(path) = shared(name) else { continue };
        let mesh = boundary::read(&path).unwrap();
        assert_eq!((mesh.positions.len(), mesh.triangles.len()), (vertices, triangles), "{name}");
        assert!(mesh.is_sound(), "{name}");
    }
}

#[test]
fn the_skinned_man_stands_upright() {
    let Some(path) = shared("CesiumMan.glb") else { return };
    let (low, high) = boundary::read(&path).unwrap().bounds().unwrap();
    let size = high - low;
    assert!(size.y > size.x && size.y > size.z && (1.4..1.6).contains(&size.y), "{size}");
}
