//! Every format holds a boundary in pieces: read back it has the same vertices and triangles, and all that goes with them.

use std::collections::HashMap;
use std::path::Path;

use glam::{DVec3, Vec2};
use homunculus::boundary::{self, Attribute, Boundary, Split, split_edges, split_long};
use homunculus::export;

use crate::{cracks, is_same_surface, read};

/// A box with sharp edges, texture, colours, two materials and polygons; two objects, vertices between faces, indices backwards.
const BOX: &str = "\
# a comment that stays
mtllib box.mtl
v 0 0 0 1 0 0\nv 2.1 0 0 1 0 0\nv 2.1 2 0 1 0 0\nv 0 2 0 1 0 0\nv 0 0 2 0 0 1\nv 2.1 0 2 0 0 1\nv 2.1 2 2 0 0 1\nv 0 2 2 0 0 1
vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1
vn 0 0 -1\nvn 0 0 1\nvn 0 -1 0\nvn 1 0 0\nvn 0 1 0\nvn -1 0 0
o box
usemtl wood
s off
f 4/1/1 3/2/1 2/3/1 1/4/1
f 5/1/2 6/2/2 7/3/2 8/4/2
g front
f 1/1/3 2/2/3 6/3/3 5/4/3
usemtl steel
f -7/1/4 -6/2/4 -2/3/4 -3/4/4
f 3/1/5 4/2/5 8/3/5 7/4/5
f 4/1/6 1/2/6 5/3/6 8/4/6
l -8 -7
o lid
v 5 0 0 0 1 0\nv 5 0 4 0 1 0\nv 9 0 4 0 1 0\nv 9 0 0 0 1 0
f -4/1 -3/2 -2/3 -1/4
";

fn textured() -> (tempfile::TempDir, Boundary) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("box.mtl"), "newmtl wood\nKd 1 1 1\nnewmtl steel\nKd 0.2 0.4 0.6\n").unwrap();
    let boundary = read(folder.path(), "box.obj", BOX.as_bytes());
    assert_eq!((boundary.positions.len(), boundary.triangles.len()), (12, 14));
    (folder, boundary)
}

fn writes(boundary: &Boundary, name: &str) -> (tempfile::TempDir, Boundary, Vec<u8>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    export::mesh(boundary, &boundary.positions, None, &path).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let again = boundary::read(&path).unwrap();
    (folder, again, bytes)
}

/// Whether what was read is what was written: vertices and triangles in order to the bit, colours and texture coordinates.
fn is_same(was: &Boundary, is: &Boundary) -> Result<(), String> {
    if (was.positions.len(), was.triangles.len()) != (is.positions.len(), is.triangles.len()) {
        return Err(format!(
            "{} and {} became {} and {}",
            was.positions.len(),
            was.triangles.len(),
            is.positions.len(),
            is.triangles.len()
        ));
    }
    // Texts have the shortest digits of single precision, which in double precision are another number.
    let single = |p: &DVec3| p.as_vec3();
    if !was.positions.iter().map(single).eq(is.positions.iter().map(single)) {
        return Err("vertices moved".into());
    }
    if was.triangles != is.triangles {
        return Err("triangles differ".into());
    }
    let near = |a: &[f32], b: &[f32]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 0.02);
    match (was.base_colours(), is.base_colours()) {
        (None, None) => {}
        (Some(a), Some(b)) if near(a.as_flattened(), b.as_flattened()) => {}
        _ => return Err("colours differ".into()),
    }
    let flat =
        |uvs: Vec<Option<Vec2>>| uvs.into_iter().map(|uv| uv.unwrap_or(Vec2::NEG_ONE).to_array()).collect::<Vec<_>>();
    match (was.vertex_uvs().map(flat), is.vertex_uvs().map(flat)) {
        (None, None) => Ok(()),
        (Some(a), Some(b)) if near(a.as_flattened(), b.as_flattened()) => Ok(()),
        (a, b) => Err(format!("texture coordinates differ: {a:?} {b:?}")),
    }
}

fn in_pieces(boundary: &Boundary, longest: f64) -> Split {
    let split = split_long(boundary, longest, usize::MAX);
    assert!(split.added_vertices() > 0);
    is_same_surface(boundary, &split).unwrap();
    split
}

/// The number of values from 1 that the words of faces refer to, face by face.
fn faces_of(obj: &str) -> Vec<Vec<Vec<usize>>> {
    let corner = |word: &str| word.split('/').map(|i| i.parse().unwrap_or(0)).collect();
    obj.lines().filter(|l| l.starts_with("f ")).map(|l| l.split_whitespace().skip(1).map(corner).collect()).collect()
}

/// The largest difference, over all faces, between how much of the texture a face has and how much it should: all of it over
/// `[area of its side]`.
fn texture_error(obj: &str) -> f64 {
    let numbers = |key: &str| -> Vec<Vec<f64>> {
        let lines = obj.lines().filter(|l| l.split_whitespace().next() == Some(key));
        lines.map(|l| l.split_whitespace().skip(1).map(|w| w.parse().unwrap()).collect()).collect()
    };
    let (v, vt) = (numbers("v"), numbers("vt"));
    let mut worst = 0.0f64;
    for face in faces_of(obj) {
        let place = |c: &Vec<usize>| DVec3::from_slice(&v[c[0] - 1]);
        let uv = |c: &Vec<usize>| DVec3::new(vt[c[1] - 1][0], vt[c[1] - 1][1], 0.0);
        let twice = |at: &dyn Fn(&Vec<usize>) -> DVec3| {
            (1..face.len() - 1)
                .map(|i| (at(&face[i]) - at(&face[0])).cross(at(&face[i + 1]) - at(&face[0])))
                .sum::<DVec3>()
        };
        let (on_body, on_texture) = (twice(&place), twice(&uv));
        let side = if place(&face[0]).x >= 5.0 {
            16.0
        } else if on_body.x != 0.0 {
            4.0
        } else {
            4.2
        };
        worst = worst.max((on_body.length() / side - on_texture.z.abs()).abs());
    }
    worst
}

#[test]
fn an_obj_is_written_line_by_line_with_its_pieces() {
    let (_folder, body) = textured();
    for longest in [3.0, 1.1, 0.4] {
        let pieces = in_pieces(&body, longest).boundary;
        let (_out, again, bytes) = writes(&pieces, "a.obj");
        is_same(&pieces, &again).unwrap();
        assert!(again.warnings.is_empty(), "{:?}", again.warnings);
        let text = String::from_utf8(bytes).unwrap();
        assert!(texture_error(&text) < 1e-5, "{}", texture_error(&text));
        // All that faces refer to comes first.
        let first_face = text.find("\nf ").unwrap();
        assert!(["\nv ", "\nvt ", "\nvn "].iter().all(|key| text.rfind(key).unwrap() < first_face));
        let kept =
            ["# a comment that stays", "o box", "usemtl wood", "s off", "g front", "usemtl steel", "l 1 2", "o lid"];
        let at = kept.map(|line| text.find(&format!("{line}\n")).unwrap_or_else(|| panic!("{line}: {text}")));
        assert!(at.is_sorted(), "{text}");
        // Normals of a sharp box stay axes.
        let normals: Vec<Vec<f64>> = text
            .lines()
            .filter(|l| l.starts_with("vn "))
            .map(|l| l.split_whitespace().skip(1).map(|w| w.parse().unwrap()).collect())
            .collect();
        let is_axis = |n: &Vec<f64>| n.iter().any(|x: &f64| x.abs() > 0.9999);
        assert!(!normals.is_empty() && normals.iter().all(is_axis));
        for face in faces_of(&text).iter().filter(|face| face[0].len() == 3) {
            assert!(face.iter().all(|corner| (1..=normals.len()).contains(&corner[2])));
        }
        // And in pieces once more.
        let more = in_pieces(&again, 0.7 * longest).boundary;
        is_same(&more, &writes(&more, "b.obj").1).unwrap();
    }
}

#[test]
fn sabotage_a_wrong_texture_coordinate_is_seen() {
    let (_folder, body) = textured();
    let (_out, _, bytes) = writes(&in_pieces(&body, 1.1).boundary, "a.obj");
    let text = String::from_utf8(bytes).unwrap();
    let line = text.lines().rfind(|l| l.starts_with("f ")).unwrap();
    let corner: Vec<&str> = line.split_whitespace().nth(1).unwrap().split('/').collect();
    let broken = line.replacen(&corner.join("/"), &format!("{}/3", corner[0]), 1);
    assert!(corner[1] != "3" && texture_error(&text.replace(line, &broken)) > 1e-3);
}

#[test]
fn polygons_stay_where_nothing_of_them_is_split() {
    let (_folder, body) = textured();
    // Belongs to two sides of the box.
    let split = split_edges(&body, &[[0, 1]]);
    assert_eq!((split.added_vertices(), split.added_triangles()), (1, 2));
    for (format, quads) in [("obj", 5), ("ply", 5), ("off", 5)] {
        let (folder, again, _) = writes(&split.boundary, &format!("a.{format}"));
        assert_eq!((again.positions.len(), again.triangles.len()), (13, 16), "{format}");
        let path = folder.path().join("b.off");
        export::mesh(&again, &again.positions, None, &path).unwrap();
        let text = std::fs::read_to_string(path).unwrap();
        assert_eq!(
            text.lines().filter(|line| line.starts_with("4 ") && line.split(' ').count() == 5).count(),
            quads,
            "{format}: {text}"
        );
    }
}

#[test]
fn other_formats_hold_the_pieces_of_an_obj() {
    let (_folder, body) = textured();
    let pieces = in_pieces(&body, 0.9).boundary;
    let (_out, off, _) = writes(&pieces, "a.off");
    assert_eq!((&off.positions, &off.triangles), (&pieces.positions, &pieces.triangles));
    // The lid would be an object of its own, whose vertices follow it.
    let (folder, _) = textured();
    let one = read(folder.path(), "one.obj", BOX.split("o lid").next().unwrap().as_bytes());
    let pieces = in_pieces(&one, 0.9).boundary;
    let single: Vec<DVec3> = pieces.positions.iter().map(|p| p.as_vec3().as_dvec3()).collect();
    let (_out, ply, _) = writes(&pieces, "a.ply");
    is_same(&pieces, &ply).unwrap();
    let (_out, glb, _) = writes(&pieces, "a.glb");
    assert_eq!(glb.triangles.len(), pieces.triangles.len());
    assert_eq!(glb.positions[..single.len()], single, "vertices in their order, further combinations after them");
    let (_out, stl, _) = writes(&pieces, "a.stl");
    let corner = |b: &Boundary, p: &[DVec3]| b.triangles.iter().flatten().map(|&v| p[v as usize]).collect::<Vec<_>>();
    assert_eq!(corner(&stl, &stl.positions), corner(&pieces, &single));
}

#[test]
fn tables_of_a_ply_grow() {
    let folder = tempfile::tempdir().unwrap();
    let text = "ply\nformat ascii 1.0\ncomment mine\nelement vertex 5\nproperty double x\nproperty double y\nproperty double z\n\
        property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float quality\nproperty int label\n\
        property list uchar int links\nproperty float nx\nproperty float ny\nproperty float nz\n\
        element face 3\nproperty int material\nproperty list uchar uchar vertex_indices\nproperty list uchar float texcoord\n\
        property list uchar int flags\nelement edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n\
        0 0 0 255 0 0 0 3 1 9 0 0 1\n4.1 0 0 0 0 0 4 7 0 0 0 1\n4.1 4 0 0 0 0 8 7 2 1 2 0 0 1\n0 4 0 255 0 0 4 3 0 0 0 1\n\
        0.1 0.1 0.5 9 9 9 1 5 0 0 0 1\n\
        5 4 0 1 2 3 8 0 0 1 0 1 1 0 1 4 1 2 3 4\n6 2 0 1 0 0\n7 3 0 1 4 6 0 0 1 0 0.1 0.1 0\n0 1\n";
    let body = read(folder.path(), "a.ply", text.as_bytes());
    let split = in_pieces(&body, 1.0);
    let pieces = &split.boundary;
    let (_out, again, bytes) = writes(pieces, "b.ply");
    is_same(pieces, &again).unwrap();
    let values = |b: &Boundary, name: &str| b.attributes.iter().find(|a| a.name == name).unwrap().values.clone();
    assert_eq!(values(pieces, "quality"), values(&again, "quality"));
    assert_eq!(values(pieces, "label"), values(&again, "label"));
    assert!(
        values(&again, "label").iter().all(|label| [3.0, 5.0, 7.0].contains(label)),
        "a mean of labels is another label"
    );
    assert!(values(&again, "red").iter().all(|red| (red * 255.0).fract().abs() < 1e-4));
    let text = String::from_utf8(bytes).unwrap();
    let (head, rows) = text.split_once("end_header\n").unwrap();
    assert!(head.contains("comment mine") && head.contains("list uchar uchar vertex_indices"), "{head}");
    let rows: Vec<Vec<&str>> = rows.lines().map(|l| l.split(' ').collect()).collect();
    let faces = &rows[pieces.positions.len()..rows.len() - 1];
    assert_eq!(rows.last().unwrap(), &["0", "1"]);
    // The short one stays; the pieces of each have its material, and its flags; texture is where the vertex is.
    assert_eq!(faces.len(), pieces.triangles.len() + 1);
    assert_eq!(faces.iter().filter(|row| row[..] == ["6", "2", "0", "1", "0", "0"][..]).count(), 1);
    for row in faces.iter().filter(|row| row[0] == "5") {
        assert_eq!((row[1], row[5]), ("3", "6"), "{row:?}");
        assert_eq!(row[12..], ["4", "1", "2", "3", "4"], "{row:?}");
        for corner in 0..3 {
            let p = pieces.positions[row[2 + corner].parse::<usize>().unwrap()];
            let [u, v] = [0, 1].map(|i| row[6 + 2 * corner + i].parse::<f64>().unwrap());
            assert!((u - p.x / 4.1).abs() < 1e-6 && (v - p.y / 4.0).abs() < 1e-6, "{row:?} {p}");
        }
    }
}

#[test]
fn strips_of_a_ply_become_faces_and_indices_wide_enough() {
    let folder = tempfile::tempdir().unwrap();
    let text = "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n\
        element tristrips 1\nproperty list uchar char vertex_indices\nend_header\n\
        0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 1 0\n7 0 1 2 3 -1 3 1 4\n";
    let text = text.replace("7 0 1 2 3 -1 3 1 4", "8 0 1 2 3 -1 3 1 4");
    let body = read(folder.path(), "a.ply", text.as_bytes());
    assert_eq!(body.triangles.len(), 3);
    let pieces = in_pieces(&body, 0.05).boundary;
    assert!(pieces.positions.len() > 255);
    is_same(&pieces, &writes(&pieces, "b.ply").1).unwrap();
    let narrow =
        text.replace("element tristrips 1\nproperty list uchar char", "element face 1\nproperty list uchar uchar");
    let narrow = narrow.replace("8 0 1 2 3 -1 3 1 4", "4 0 1 3 2");
    let pieces = in_pieces(&read(folder.path(), "n.ply", narrow.as_bytes()), 0.05).boundary;
    is_same(&pieces, &writes(&pieces, "b.ply").1).unwrap();
}

#[test]
fn an_off_is_written_line_by_line_with_its_pieces() {
    let folder = tempfile::tempdir().unwrap();
    let texts = [
        "COFF # mine\n5 3 0\n\n0 0 0 255 0 0 255\n2.1 0 0 0 255 0 255\n2.1 2 0 0 0 255 255\n0 2 0 9 9 9 255 # last\n1 1 1 0 0 0 255\n4 0 1 2 3 7 8 9\n2 0 1\n3 0 1 4\n# end\n",
        "NOFF 5 3 0\n0 0 0 0 0 1\n2.1 0 0 0 0 1\n2.1 2 0 0 0 1\n0 2 0 0 0 1\n1 1 1 0 0 1\n4 0 1 2 3\n2 0 1\n3 0 1 4\n",
        "STOFF\n5 3 0\n0 0 0 0 0\n2.1 0 0 1 0\n2.1 2 0 1 1\n0 2 0 0 1\n1 1 1 0.5 0.5\n4 0 1 2 3\n2 0 1\n3 0 1 4\n",
        "5 3 0\n0 0 0\n2.1 0 0\n2.1 2 0\n0 2 0\n1 1 1\n4 0 1 2 3\n2 0 1\n3 0 1 4\n",
    ];
    for text in texts {
        let body = read(folder.path(), "a.off", text.as_bytes());
        assert_eq!(body.triangles.len(), 3, "{text}");
        let pieces = in_pieces(&body, 0.7).boundary;
        let (_out, again, bytes) = writes(&pieces, "b.off");
        let written = String::from_utf8(bytes).unwrap();
        is_same(&pieces, &again).unwrap_or_else(|what| panic!("{what}: {written}"));
        assert_eq!(again.warnings, body.warnings);
        if text.starts_with("COFF") {
            assert!(
                written.contains("\n3 0 ") && written.contains(" 7 8 9\n") && written.contains("# end\n"),
                "{written}"
            );
        }
    }
}

#[test]
fn an_stl_keeps_solids_and_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let facet = |z: f64| {
        format!("facet normal 0 0 1\nouter loop\nvertex 0 0 {z}\nvertex 1.1 0 {z}\nvertex 0 1 {z}\nendloop\nendfacet\n")
    };
    let text = format!("solid one\n{}endsolid one\nsolid two\n{}endsolid two\n", facet(0.0), facet(1.0));
    let body = read(folder.path(), "a.stl", text.as_bytes());
    let pieces = in_pieces(&body, 0.8).boundary;
    let (_out, again, bytes) = writes(&pieces, "b.stl");
    let corner = |b: &Boundary| b.triangles.iter().flatten().map(|&v| b.positions[v as usize]).collect::<Vec<_>>();
    assert_eq!(corner(&again), corner(&pieces));
    let written = String::from_utf8(bytes).unwrap();
    assert_eq!((written.matches("\nsolid ").count(), written.matches("solid two\n").count()), (1, 2), "{written}");

    let mut binary = vec![b' '; 80];
    binary.extend(2u32.to_le_bytes());
    for (index, z) in [0.0f32, 1.0].into_iter().enumerate() {
        for number in [0., 0., 1., 0., 0., z, 1.1, 0., z, 0., 1., z] {
            binary.extend(f32::to_le_bytes(number));
        }
        binary.extend([7 + index as u8, 9]);
    }
    let body = read(folder.path(), "c.stl", &binary);
    let split = in_pieces(&body, 0.8);
    let (_out, again, bytes) = writes(&split.boundary, "d.stl");
    assert_eq!(corner(&again), corner(&split.boundary));
    let marks: Vec<u32> = bytes[84..].chunks_exact(50).map(|t| u32::from(t[48]) - 7).collect();
    assert_eq!(marks, split.parents);
}

/// Two objects of one file, as nodes with a mesh each; the second in two materials.
fn objects(folder: &Path) -> Boundary {
    let floats: Vec<f32> = vec![0., 0., 0., 2., 0., 0., 0., 2., 0., 5., 0., 0., 7., 0., 0., 5., 2., 0., 7., 2., 1.];
    let mut binary: Vec<u8> = floats.iter().flat_map(|f| f.to_le_bytes()).collect();
    binary.extend([0u16, 1, 2, 0, 1, 2, 1, 3, 2, 0].iter().flat_map(|i| i.to_le_bytes()));
    let uri = base64::Engine::encode(&base64::prelude::BASE64_STANDARD, &binary);
    let root = serde_json::json!({
        "asset": { "version": "2.0" }, "scenes": [{ "nodes": [0, 1] }],
        "nodes": [{ "name": "one", "mesh": 0, "extras": { "kept": 1 } }, { "name": "two", "mesh": 1, "extras": { "kept": 2 } }],
        "materials": [{ "name": "red" }, { "name": "blue" }],
        "meshes": [
            { "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 2, "material": 0 }] },
            { "primitives": [
                { "attributes": { "POSITION": 1 }, "indices": 2, "material": 0 },
                { "attributes": { "POSITION": 1 }, "indices": 3, "material": 1 },
            ] },
        ],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [2, 2, 0] },
            { "bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC3", "min": [5, 0, 0], "max": [7, 2, 1] },
            { "bufferView": 2, "componentType": 5123, "count": 3, "type": "SCALAR" },
            { "bufferView": 3, "componentType": 5123, "count": 3, "type": "SCALAR" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": 36 }, { "buffer": 0, "byteOffset": 36, "byteLength": 48 },
            { "buffer": 0, "byteOffset": 84, "byteLength": 6 }, { "buffer": 0, "byteOffset": 90, "byteLength": 6 },
        ],
        "buffers": [{ "byteLength": binary.len(), "uri": format!("data:application/octet-stream;base64,{uri}") }],
    });
    read(folder, "a.gltf", root.to_string().as_bytes())
}

#[test]
fn objects_of_a_glb_stay_and_their_vertices_come_first_in_each() {
    let folder = tempfile::tempdir().unwrap();
    let mut body = objects(folder.path());
    assert_eq!((body.positions.len(), body.triangles.len()), (7, 3));
    body.attributes
        .push(Attribute { name: "_height".into(), values: body.positions.iter().map(|p| p.y as f32).collect() });
    let split = in_pieces(&body, 0.8);
    let pieces = &split.boundary;
    let (out, again, _) = writes(pieces, "b.glb");
    assert_eq!((again.positions.len(), again.triangles.len()), (pieces.positions.len(), pieces.triangles.len()));
    let file = gltf::Gltf::open(out.path().join("b.glb")).unwrap();
    let names: Vec<_> =
        file.nodes().map(|n| (n.name().unwrap().to_owned(), n.extras().as_ref().unwrap().get().to_owned())).collect();
    assert_eq!(names, [("one".to_owned(), "{\"kept\":1}".to_owned()), ("two".to_owned(), "{\"kept\":2}".to_owned())]);
    let blob = file.blob.as_deref().unwrap();
    for (mesh, own) in file.meshes().zip([&body.positions[..3], &body.positions[3..]]) {
        for primitive in mesh.primitives() {
            let reader = primitive.reader(|_| Some(blob));
            let places: Vec<DVec3> =
                reader.read_positions().unwrap().map(|p| DVec3::from_array(p.map(f64::from))).collect();
            assert_eq!(places[..own.len()], *own);
        }
    }
    // The same triangles, and as much of each material.
    let corners = |b: &Boundary| {
        b.triangles.iter().map(|t| t.map(|v| b.positions[v as usize].to_array().map(f64::to_bits))).collect::<Vec<_>>()
    };
    assert_eq!(corners(&again), corners(pieces));
    let mut of_material: HashMap<usize, usize> = HashMap::new();
    for primitive in file.meshes().flat_map(|mesh| mesh.primitives()) {
        *of_material.entry(primitive.material().index().unwrap()).or_default() +=
            primitive.indices().unwrap().count() / 3;
    }
    let of = |wanted: &[u32]| split.parents.iter().filter(|p| wanted.contains(p)).count();
    assert_eq!((of_material[&0], of_material[&1]), (of(&[0, 1]), of(&[2])));
    let heights = again.attributes.iter().find(|a| a.name == "_height").unwrap();
    assert!(heights.values.iter().zip(&again.positions).all(|(h, p)| (f64::from(*h) - p.y).abs() < 1e-6));
    // In pieces once more, through the file.
    let more = in_pieces(&again, 0.5).boundary;
    assert_eq!(writes(&more, "c.glb").1.positions.len(), more.positions.len());
}

#[test]
fn closed_pieces_are_closed_in_every_format() {
    let body = crate::seams();
    let pieces = in_pieces(&body, 0.5).boundary;
    for format in ["glb", "obj", "ply", "stl", "off"] {
        let (_out, again, _) = writes(&pieces, &format!("a.{format}"));
        assert_eq!(cracks(&again), 0, "{format}");
        if format != "stl" {
            is_same(&pieces, &again).unwrap_or_else(|what| panic!("{format}: {what}"));
        }
    }
}
