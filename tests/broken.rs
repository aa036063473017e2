//! Contract of `boundary` with bad input: one sentence that names the file, the place and what to do; never a panic, a hang or
//! gigabytes.
#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use homunculus::Error;
use homunculus::boundary::{self, Boundary};
use proptest::prelude::*;

/// What a reader may take for any of the files here, which are small.
const PATIENCE: Duration = Duration::from_secs(10);

/// Reads within the time, and checks the form of an error or the soundness of a mesh.
fn read(path: &Path) -> Result<Boundary, String> {
    let start = Instant::now();
    let result = boundary::read(path);
    assert!(start.elapsed() < PATIENCE, "{} took {:?}", path.display(), start.elapsed());
    match result {
        Ok(boundary) => {
            assert!(boundary.is_sound(), "{}", path.display());
            Ok(boundary)
        }
        Err(error) => {
            let text = error.to_string();
            is_good_sentence(path, &error).unwrap_or_else(|what| panic!("{what}: {text}"));
            Err(text)
        }
    }
}

/// One line, which names the file and, after what is wrong, says what to do.
fn is_good_sentence(path: &Path, error: &Error) -> Result<(), &'static str> {
    let text = error.to_string();
    if text.contains('\n') || text.len() > 600 {
        return Err("more than a sentence");
    }
    if !text.starts_with(&path.display().to_string()) {
        return Err("which file?");
    }
    match error {
        Error::Input(_) if !(text.contains(';') || text.contains(", so ")) => Err("what to do?"),
        Error::Input(_) | Error::File { .. } => Ok(()),
        _ => Err("not the input's fault?"),
    }
}

fn write(name: &str, bytes: &[u8]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    (folder, path)
}

/// The error of a file with this content.
fn complaint(name: &str, content: &[u8]) -> String {
    let (_folder, path) = write(name, content);
    read(&path).map(|_| ()).expect_err(name)
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

#[test]
fn obj_complaints_name_the_line() {
    for (content, expected) in [
        (format!("{TRIANGLE}f 1 2 4\n"), "line 4: a face refers to vertex 4, but the file has 3"),
        (format!("{TRIANGLE}f 0 1 2\n"), "line 4: a face refers to vertex 0"),
        (format!("{TRIANGLE}f -4 1 2\n"), "line 4: a face refers to vertex -4"),
        (format!("{TRIANGLE}f 1 2 x\n"), "line 4: \"x\" is no corner"),
        (format!("{TRIANGLE}f 1 2 99999999999999999999\n"), "line 4"),
        (format!("{TRIANGLE}f -9223372036854775808 1 2\n"), "line 4"),
        (format!("{TRIANGLE}v 0 nan 0\nf 1 2 3\n"), "line 4: vertex 4"),
        (format!("{TRIANGLE}v 1e999 0 0\nf 1 2 3\n"), "line 4: vertex 4"),
        (format!("{TRIANGLE}v 1 0\nf 1 2 3\n"), "line 4"),
        (TRIANGLE.to_owned(), "it has 3 vertices but no faces"),
        ("# nothing\n".to_owned(), "no vertices"),
        (format!("{TRIANGLE}f 1 1 2\nf 3 3 3\n"), "each of its 2 triangles has zero area"),
        ("v 5 5 5\nv 5 5 5\nv 5 5 5\nf 1 2 3\n".to_owned(), "zero area"),
    ] {
        let text = complaint("a.obj", content.as_bytes());
        assert!(text.contains(expected), "{content}: {text}");
    }
}

#[test]
fn degenerate_triangles_among_good_ones_stay() {
    let (_folder, path) = write("a.obj", format!("{TRIANGLE}f 1 2 3\nf 1 1 2\nf 2 2 2\n").as_bytes());
    assert_eq!(read(&path).unwrap().triangles.len(), 3);
    // However small a good triangle is.
    let (_folder, path) = write("a.obj", b"v 0 0 0\nv 1e-200 0 0\nv 0 1e-200 0\nf 1 2 3\n");
    assert_eq!(read(&path).unwrap().triangles.len(), 1);
}

#[test]
fn claims_are_checked_before_anything_is_reserved() {
    let ply = |head: &str, body: &str| {
        format!(
            "ply\nformat {head}\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uint int vertex_indices\nend_header\n{body}"
        )
    };
    let mut stl = vec![0; 84];
    stl[80..84].copy_from_slice(&4_000_000_000u32.to_le_bytes());
    let gltf = |accessor: &str| {
        format!("{{\"asset\":{{\"version\":\"2.0\"}},\"nodes\":[{{\"mesh\":0}}],\"meshes\":[{{\"primitives\":[{{\"attributes\":{{\"POSITION\":0}}}}]}}],\"accessors\":[{accessor}]}}").into_bytes()
    };
    for (name, content, expected) in [
        ("a.off", b"OFF\n1000000000 1 0\n0 0 0\n".to_vec(), "claims 1000000000 vertices"),
        ("a.off", b"OFF\n18446744073709551615 18446744073709551615 0\n0 0 0\n".to_vec(), "claims"),
        ("a.ply", ply("ascii 1.0\nelement vertex 1000000000", "0 0 0\n").into_bytes(), "claims 1000000000 vertex rows"),
        (
            "a.ply",
            ply("binary_little_endian 1.0\nelement vertex 18446744073709551615", "0 0 0\n").into_bytes(),
            "claims",
        ),
        (
            "a.ply",
            ply("ascii 1.0\nelement vertex 1", "0 0 0\n4000000000 0\n").into_bytes(),
            "face 0, property vertex_indices: the file ends",
        ),
        ("a.stl", stl, "it claims 4000000000 triangles but holds 0"),
        (
            "a.gltf",
            gltf("{\"componentType\":5126,\"count\":1000000000,\"type\":\"VEC3\"}"),
            "claims 1000000000 elements",
        ),
        ("a.gltf", gltf("{\"componentType\":5126,\"count\":18446744073709551615,\"type\":\"VEC3\"}"), "claims"),
        ("a.gltf", gltf("{\"componentType\":5126,\"count\":-1,\"type\":\"VEC3\"}"), "malformed"),
    ] {
        let text = complaint(name, &content);
        assert!(text.contains(expected), "{text}");
    }
}

#[test]
fn gltf_complaints_name_the_element() {
    let glb = |json: &str| {
        let mut out = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
        out.extend((json.len() as u32).to_le_bytes());
        out.extend(b"JSON");
        out.extend(json.as_bytes());
        out
    };
    let scene = |rest: &str| format!("{{\"asset\":{{\"version\":\"2.0\"}},{rest}}}");
    for (content, expected) in [
        (glb("{"), "malformed"),
        (glb(&scene("\"nodes\":[{\"mesh\":3}]")), "mesh 3"),
        (glb(&scene("\"nodes\":[{\"children\":[7]}]")), "node 7"),
        (glb(&scene("\"nodes\":[{\"children\":[0]}]")), "node 0 is its own ancestor"),
        (glb(&scene("\"nodes\":[{\"children\":[2]},{\"children\":[2]},{}]")), "node 2 has two parents"),
        (glb(&scene("\"nodes\":[]")), "no vertices"),
        (glb(&scene("\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{}]}]")), "no POSITION"),
        (glb(&scene("\"extensionsRequired\":[\"KHR_draco_mesh_compression\"]")), "without mesh compression"),
        (b"glTF\x01\0\0\0\0\0\0\0".to_vec(), "version 1"),
        (b"glTF".to_vec(), "ends in its header"),
        (glb(&"[".repeat(100_000)), "malformed"),
    ] {
        let text = complaint("a.glb", &content);
        assert!(text.contains(expected), "{text}");
    }
}

#[test]
fn what_is_no_mesh_is_said_to_be_none() {
    let folder = tempfile::tempdir().unwrap();
    assert!(read(folder.path()).unwrap_err().contains("folder"));
    let missing = folder.path().join("missing.obj");
    assert!(matches!(boundary::read(&missing), Err(Error::File { .. })));
    assert!(complaint("a.obj", b"").contains("empty"));
    assert!(complaint("a.txt", b"hello\n").contains("which format"));
    assert!(complaint("a.ply", b"ply\nformat ascii 1.0\n").contains("end_header"));
    assert!(
        complaint("a.stl", b"solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\nendfacet\n")
            .contains("line 7")
    );
    #[cfg(unix)]
    assert!(read(Path::new("/dev/zero")).unwrap_err().contains("no regular file"));
}

#[cfg(unix)]
#[test]
fn a_file_without_permission_is_the_systems_word() {
    use std::os::unix::fs::PermissionsExt as _;
    let (_folder, path) = write("a.obj", TRIANGLE.as_bytes());
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o0)).unwrap();
    if std::fs::read(&path).is_ok() {
        println!("skipped: this user may read everything");
        return;
    }
    assert!(matches!(boundary::read(&path), Err(Error::File { .. })));
}

#[test]
fn wide_text_is_read() {
    let text = format!("\u{feff}# größer\r\n{TRIANGLE}f 1 2 3\r\n");
    let little: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let big: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
    for bytes in [little, big, text.into_bytes()] {
        let (_folder, path) = write("a.obj", &bytes);
        assert_eq!(read(&path).unwrap().triangles.len(), 1);
    }
}

#[test]
fn a_face_with_very_many_corners_ends() {
    let count = 200_000;
    let angle = |i: usize| i as f64 / count as f64 * std::f64::consts::TAU;
    let mut text: String = (0..count)
        .map(|i| format!("v {} {} 0\n", angle(i).cos() * (1.0 + 0.5 * (i % 2) as f64), angle(i).sin()))
        .collect();
    text.push('f');
    (1..=count).for_each(|i| text.push_str(&format!(" {i}")));
    let (_folder, path) = write("a.obj", text.as_bytes());
    assert_eq!(read(&path).unwrap().triangles.len(), count - 2);
}

#[test]
fn faces_that_cross_themselves_and_crowds_around_a_point_end() {
    let place = |i: usize| ((i * 7919) % 1009, (i * 104_729) % 1013);
    let mut text: String = (0..900).map(|i| format!("v {} {} 0\n", place(i).0, place(i).1)).collect();
    for _ in 0..40 {
        text.push('f');
        (1..=900).for_each(|i| text.push_str(&format!(" {i}")));
        text.push('\n');
    }
    let (_folder, path) = write("a.obj", text.as_bytes());
    assert_eq!(read(&path).unwrap().triangles.len(), 40 * 898);

    let mut stl = vec![b' '; 80];
    let count = 40_000u32;
    stl.extend(count.to_le_bytes());
    for i in 0..count {
        let angle = |i: u32| i as f32 / count as f32 * std::f32::consts::TAU;
        let corners =
            [[0.0; 3], [0.0; 3], [angle(i).cos(), angle(i).sin(), 0.0], [angle(i + 1).cos(), angle(i + 1).sin(), 0.0]];
        stl.extend(corners.into_iter().flatten().flat_map(f32::to_le_bytes));
        stl.extend([0, 0]);
    }
    let (folder, path) = write("a.stl", &stl);
    let disc = read(&path).unwrap();
    let start = Instant::now();
    homunculus::export::mesh(&disc, &disc.positions, None, &folder.path().join("a.glb")).unwrap();
    assert!(start.elapsed() < PATIENCE);
}

#[test]
fn a_small_scene_cannot_unfold_to_gigabytes() {
    let root = |nodes: &str, primitives: &str, skin: &str| {
        format!(
            "{{\"asset\":{{\"version\":\"2.0\"}},\"nodes\":[{nodes}],\"meshes\":[{{\"primitives\":[{primitives}]}}],\"skins\":[{{\"joints\":[{skin}]}}],\"accessors\":[{{\"componentType\":5126,\"count\":100000,\"type\":\"VEC3\"}}]}}"
        )
    };
    let primitive = "{\"attributes\":{\"POSITION\":0}}";
    let many = |item: &str, count: usize| vec![item; count].join(",");
    for text in [
        root(&many("{\"mesh\":0}", 10_000), primitive, ""),
        root("{\"mesh\":0}", &many(primitive, 10_000), ""),
        root(&many("{\"mesh\":0,\"skin\":0}", 10_000), primitive, &many("0", 10_000)),
    ] {
        let (_folder, path) = write("a.gltf", text.as_bytes());
        let text = read(&path).map(|_| ()).unwrap_err();
        assert!(text.contains("more than can be real"), "{text}");
    }
}

/// Paths of all numbers in a JSON, as pointers.
fn numbers(value: &serde_json::Value, path: &str, found: &mut Vec<String>) {
    match value {
        serde_json::Value::Object(map) => map.iter().for_each(|(key, v)| numbers(v, &format!("{path}/{key}"), found)),
        serde_json::Value::Array(list) => {
            list.iter().enumerate().for_each(|(i, v)| numbers(v, &format!("{path}/{i}"), found));
        }
        serde_json::Value::Number(_) => found.push(path.to_owned()),
        _ => {}
    }
}

#[test]
fn no_number_in_a_gltf_is_believed() {
    use serde_json::json;
    let accessor = |view: u32, kind: u32, shape: &str, count: u32| json!({ "bufferView": view, "byteOffset": 0, "componentType": kind, "type": shape, "count": count });
    let mut sparse = accessor(0, 5126, "VEC3", 3);
    sparse["sparse"] = json!({ "count": 2, "indices": { "bufferView": 2, "byteOffset": 0, "componentType": 5121 }, "values": { "bufferView": 0, "byteOffset": 0 } });
    let positions: Vec<u8> = [0f32, 0., 0., 1., 0., 0., 0., 1., 0.].into_iter().flat_map(f32::to_le_bytes).collect();
    let binary = [positions, vec![0; 64], vec![0, 1, 2, 0]].concat();
    let uri = format!("data:;base64,{}", base64::Engine::encode(&base64::prelude::BASE64_STANDARD, &binary));
    let root = json!({
        "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0, "skin": 0, "children": [1], "scale": [1, 1, 1], "weights": [0.5] }, { "rotation": [0, 0, 0, 1] }],
        "skins": [{ "joints": [1], "inverseBindMatrices": 2 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "JOINTS_0": 3, "WEIGHTS_0": 3, "COLOR_0": 3, "_X": 4 }, "indices": 4, "mode": 4, "material": 0, "targets": [{ "POSITION": 1 }] }] }],
        "materials": [{}], "images": [{ "bufferView": 0, "mimeType": "image/png" }],
        "accessors": [accessor(0, 5126, "VEC3", 3), sparse, accessor(1, 5126, "MAT4", 1), accessor(1, 5121, "VEC4", 3), accessor(2, 5121, "SCALAR", 3)],
        "bufferViews": [{ "buffer": 0, "byteOffset": 0, "byteLength": 36, "byteStride": 12 }, { "buffer": 0, "byteOffset": 36, "byteLength": 64 }, { "buffer": 0, "byteOffset": 100, "byteLength": 3 }],
        "buffers": [{ "byteLength": 104, "uri": uri }],
    });
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gltf");
    std::fs::write(&path, root.to_string()).unwrap();
    read(&path).unwrap();
    let mut found = Vec::new();
    numbers(&root, "", &mut found);
    assert!(found.len() > 60);
    let mut refused = 0;
    for pointer in found {
        for bad in [
            json!(0),
            json!(1),
            json!(2),
            json!(5),
            json!(99),
            json!(5125),
            json!(u32::MAX),
            json!(u64::MAX),
            json!(-1),
            json!(0.5),
            json!(null),
            json!("x"),
        ] {
            let mut broken = root.clone();
            *broken.pointer_mut(&pointer).unwrap() = bad;
            std::fs::write(&path, broken.to_string()).unwrap();
            refused += u32::from(read(&path).is_err());
        }
    }
    assert!(refused > 300, "{refused}");
    // Sparse elements out of order, which the decoder would pass over.
    let mut turned = root.clone();
    turned["accessors"][1]["sparse"]["indices"]["byteOffset"] = json!(1);
    std::fs::write(&path, turned.to_string()).unwrap();
    read(&path).unwrap();
    turned["bufferViews"][2]["byteOffset"] = json!(101);
    turned["accessors"][4]["bufferView"] = json!(1);
    std::fs::write(&path, turned.to_string()).unwrap();
    assert!(read(&path).unwrap_err().contains("accessor 1 replaces element 0 of 3, after element 3"));
}

/// What each of the broken files is met with: a part of the complaint, or the triangles it has all the same.
const COLLECTED: [(&str, Result<usize, &str>); 15] = [
    ("assimp_BoxWithInfinites-glTF-Binary_BoxWithInfinites.glb", Err("vertex 0 is at")),
    ("assimp_IndexOutOfRange_IndexOutOfRange.gltf", Err("index 0 refers to vertex 255, but there are 24")),
    ("assimp_MissingBin_BoxTextured.gltf", Err("BoxTextured0.bin it refers to is missing")),
    ("assimp_OutOfMemory.off", Err("line 2: it claims 353535235358 vertices")),
    ("assimp_RecursiveNodes_RecursiveNodes.gltf", Err("node 0 is its own ancestor")),
    ("assimp_box_UTF16BE.obj", Ok(12)),
    ("assimp_empty.off", Err("empty")),
    ("assimp_malformed.obj", Err("line 28")),
    ("assimp_point_cloud.obj", Err("3 vertices but no faces")),
    ("cgal_holes.off", Ok(8288)),
    ("cgal_negative.off", Ok(6)),
    ("khr_TriangleWithoutIndices.gltf", Ok(1)),
    ("tm_empty.stl", Err("no vertices")),
    ("tm_nancolor.obj", Ok(12)),
    ("tm_soup.stl", Ok(100)),
];

#[test]
fn collected_broken_files_are_met_as_expected() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data/broken");
    for (name, expected) in COLLECTED {
        let path = folder.join(name);
        if !path.exists() {
            println!("skipped: {} is not there", path.display());
            continue;
        }
        match (read(&path), expected) {
            (Ok(mesh), Ok(triangles)) => assert_eq!(mesh.triangles.len(), triangles, "{name}"),
            (Err(text), Err(part)) => assert!(text.contains(part), "{name}: {text}"),
            (result, _) => panic!("{name}: {:?}", result.map(|mesh| mesh.triangles.len())),
        }
    }
}

#[test]
fn sabotage_bad_sentences_are_seen() {
    let path = Path::new("a.obj");
    let judge = |text: &str| is_good_sentence(path, &Error::Input(text.into()));
    assert!(judge("a.obj: line 3: the vertex is broken; repair it").is_ok());
    assert!(judge("line 3: the vertex is broken; repair it").is_err());
    assert!(judge("a.obj: failed").is_err());
    assert!(judge("a.obj: one;\ntwo").is_err());
    assert!(is_good_sentence(path, &Error::Fault("a.obj".into())).is_err());
}

/// One small valid file of each kind to be damaged.
fn seeds() -> Vec<(&'static str, Vec<u8>)> {
    let obj = "mtllib m\no a\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 1\nv 0 1 0 1 1 1\nv 0 0 1\nvt 0 0\nvt 1 1\nvn 0 0 1\nusemtl x\nf 1/1/1 2/2/1 3/1/1 -2/2/1\nf 1 2 5\nf 1 3 4 5 2\n";
    let off = "COFF\n4 2 0\n0 0 0 255 0 0\n1 0 0 0 255 0\n1 1 0 0 0 255\n0 1 0.5 9 9 9\n3 0 1 2\n4 0 1 2 3\n";
    let head = "ply\nformat binary_little_endian 1.0\ncomment c\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
    let mut ply = head.as_bytes().to_vec();
    for corner in [[0f32, 0., 0.], [1., 0., 0.], [0., 1., 0.]] {
        ply.extend(corner.into_iter().flat_map(f32::to_le_bytes));
        ply.push(200);
    }
    ply.push(3);
    ply.extend([0u32, 1, 2].into_iter().flat_map(u32::to_le_bytes));
    let ply_text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 6 0 0 1 0 0 1\n";
    let mut stl = vec![b' '; 80];
    stl.extend(1u32.to_le_bytes());
    stl.extend([0f32, 0., 1., 0., 0., 0., 1., 0., 0., 0., 1., 0.].into_iter().flat_map(f32::to_le_bytes));
    stl.extend([0, 0]);
    let stl_text = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n";
    let json = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"skin":0,"children":[1],"rotation":[0,0,0,1]},{"name":"j","scale":[1,2,1]}],"skins":[{"joints":[0,1]}],"meshes":[{"weights":[0.5],"primitives":[{"mode":5,"attributes":{"POSITION":0,"COLOR_0":1,"_X":2,"JOINTS_0":3,"WEIGHTS_0":1},"indices":2,"material":0,"targets":[{"POSITION":0}]}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":1,"componentType":5121},"values":{"bufferView":0}}},{"bufferView":0,"componentType":5121,"normalized":true,"count":3,"type":"VEC4"},{"bufferView":1,"componentType":5121,"count":3,"type":"SCALAR"},{"bufferView":2,"componentType":5121,"count":3,"type":"VEC4"}],"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":4},{"buffer":0,"byteOffset":40,"byteLength":12,"byteStride":4}],"buffers":[{"byteLength":52}],"materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],"textures":[{"source":0}],"images":[{"bufferView":0,"mimeType":"image/png"}]}"#;
    let mut binary: Vec<u8> = [0f32, 0., 0., 1., 0., 0., 0., 1., 0.].into_iter().flat_map(f32::to_le_bytes).collect();
    binary.extend([0, 1, 2, 0]);
    binary.extend([0, 1, 0, 0].repeat(3));
    let mut glb = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
    glb.extend((json.len() as u32).to_le_bytes());
    glb.extend(b"JSON");
    glb.extend(json.as_bytes());
    glb.extend((binary.len() as u32).to_le_bytes());
    glb.extend(b"BIN\0");
    glb.extend(binary);
    vec![
        ("a.obj", obj.into()),
        ("a.off", off.into()),
        ("a.ply", ply),
        ("b.ply", ply_text.into()),
        ("a.stl", stl),
        ("b.stl", stl_text.into()),
        ("a.glb", glb),
    ]
}

#[test]
fn the_seeds_are_whole() {
    for (name, bytes) in seeds() {
        let (_folder, path) = write(name, &bytes);
        read(&path).unwrap();
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn damaged_files_never_panic(which in 0usize..7, damage in prop::collection::vec((any::<prop::sample::Index>(), 0u8..4, any::<u8>()), 1..6), cut in prop::option::of(any::<prop::sample::Index>())) {
        let (name, mut bytes) = seeds().swap_remove(which);
        for (at, kind, value) in damage {
            let at = at.index(bytes.len());
            match kind {
                0 => bytes[at] ^= 1 << (value % 8),
                1 => bytes[at] = value,
                2 => bytes[at] = b"0123456789-.eE /\n"[usize::from(value) % 17],
                _ => { bytes.remove(at); }
            }
        }
        if let Some(cut) = cut {
            let length = cut.index(bytes.len());
            bytes.truncate(length);
        }
        let (folder, path) = write(name, &bytes);
        // What is read must also be written, and read once more.
        if let Ok(mesh) = read(&path) {
            for format in ["glb", "obj", "ply", "stl", "off"] {
                let out = folder.path().join(format!("out.{format}"));
                match homunculus::export::mesh(&mesh, &mesh.positions, None, &out) {
                    Ok(()) => { let _ = read(&out); }
                    Err(error) => prop_assert!(matches!(error, Error::Input(_)), "{error}"),
                }
            }
        }
    }
}
