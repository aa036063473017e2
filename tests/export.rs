//! Contract of `export`: what was read is written again with other positions and nothing else changed, in every format that can
//! hold it; the growth plays as the frames say; a failed write leaves nothing behind.
#![expect(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test that cannot be set up has failed; one that is skipped says so"
)]

use std::collections::HashSet;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use glam::{DVec3, Vec2, Vec3};
use homunculus::Error;
use homunculus::boundary::{self, Boundary};
use homunculus::export::{self, GrowthFrame};
use homunculus::file::write_atomically;

const FORMATS: [&str; 5] = ["glb", "obj", "ply", "stl", "off"];

/// A box with sharp edges, texture, colours and a value: everything an OBJ can say at once.
const BOX: &str = "\
# a comment that stays
mtllib box.mtl
o box
v 0 0 0 1 0 0\nv 2.1 0 0 1 0 0\nv 2.1 2 0 1 0 0\nv 0 2 0 1 0 0\nv 0 0 2 0 0 1\nv 2.1 0 2 0 0 1\nv 2.1 2 2 0 0 1\nv 0 2 2 0 0 1
vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1
vn 0 0 -1\nvn 0 0 1\nvn 0 -1 0\nvn 1 0 0\nvn 0 1 0\nvn -1 0 0
usemtl wood
s off
f 4/1/1 3/2/1 2/3/1 1/4/1
f 5/1/2 6/2/2 7/3/2 8/4/2
f 1/1/3 2/2/3 6/3/3 5/4/3
usemtl steel
f -7/1/4 -6/2/4 -2/3/4 -3/4/4
f 3/1/5 4/2/5 8/3/5 7/4/5
f 4/1/6 1/2/6 5/3/6 8/4/6
";

fn png() -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image::RgbImage::from_pixel(2, 2, image::Rgb([200, 100, 50]))
        .write_to(&mut bytes, image::ImageFormat::Png)
        .unwrap();
    bytes.into_inner()
}

/// The box in a folder, with its library and texture.
fn textured_box() -> (tempfile::TempDir, Boundary) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("textures")).unwrap();
    std::fs::write(folder.path().join("textures/wood grain.png"), png()).unwrap();
    let library =
        "newmtl wood\nKd 1 1 1\nmap_Kd -s 1 1 1 textures/wood grain.png\nnewmtl steel\nKd 0.2 0.4 0.6\nd 0.5\n";
    std::fs::write(folder.path().join("box.mtl"), library).unwrap();
    std::fs::write(folder.path().join("box.obj"), BOX).unwrap();
    let boundary = boundary::read(&folder.path().join("box.obj")).unwrap();
    (folder, boundary)
}

fn json_of(glb: &[u8]) -> serde_json::Value {
    let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    serde_json::from_slice(&glb[20..20 + length]).unwrap()
}

/// A warp that keeps numbers plain: grows with height.
fn warped(boundary: &Boundary, amount: f64) -> Vec<DVec3> {
    let (low, high) = boundary.bounds().unwrap();
    let size = (high - low).max_element();
    boundary.positions.iter().map(|&p| p + (p - low) * amount * (p.y - low.y) / size).collect()
}

/// What the triangles are made of, whatever vertices they share: corner positions, rounded to single precision.
fn corners(boundary: &Boundary, positions: &[DVec3]) -> Vec<[Vec3; 3]> {
    boundary.triangles.iter().map(|t| t.map(|v| positions[v as usize].as_vec3())).collect()
}

/// Whether `after` is `before` at `positions`, in vertex order and triangle order. Says what is not.
fn is_same(before: &Boundary, positions: &[DVec3], after: &Boundary, format: &str) -> Result<(), String> {
    let close = |a: Vec3, b: Vec3| (a - b).abs().max_element() <= 1e-6 * a.abs().max_element().max(1.0);
    if before.triangles.len() != after.triangles.len() {
        return Err(format!("{} triangles became {}", before.triangles.len(), after.triangles.len()));
    }
    let mine = |b: &Boundary, p: &[DVec3]| {
        let mut triangles = corners(b, p);
        // Parts of several materials may come out sorted by material.
        triangles.sort_by(|a, b| a.map(|v| v.to_array()).partial_cmp(&b.map(|v| v.to_array())).unwrap());
        triangles
    };
    let (was, is) = if format == "glb" {
        (mine(before, positions), mine(after, &after.positions))
    } else {
        (corners(before, positions), corners(after, &after.positions))
    };
    if !was.iter().flatten().zip(is.iter().flatten()).all(|(&a, &b)| close(a, b)) {
        return Err("triangles moved".into());
    }
    if format == "stl" {
        return Ok(());
    }
    let extra = after.positions.len().checked_sub(positions.len()).ok_or("vertices are missing")?;
    if extra > 0 && format != "glb" {
        return Err(format!("{extra} vertices more"));
    }
    if !positions.iter().zip(&after.positions).all(|(a, b)| close(a.as_vec3(), b.as_vec3())) {
        return Err("vertices changed their order".into());
    }
    if format == "off" {
        return Ok(());
    }
    let near =
        |a: &Option<Vec2>, b: &Option<Vec2>| (a.unwrap_or_default() - b.unwrap_or_default()).abs().max_element() < 1e-5;
    match (before.vertex_uvs(), after.vertex_uvs()) {
        (None, None) => {}
        (Some(was), Some(is)) if was.iter().zip(&is).all(|(a, b)| near(a, b)) => {}
        _ => return Err("texture coordinates changed".into()),
    }
    match (before.base_colours(), after.base_colours()) {
        (None, None) => {}
        (Some(was), Some(is)) if was.iter().flatten().zip(is.iter().flatten()).all(|(a, b)| (a - b).abs() < 0.01) => {}
        (Some(_), None) | (None, Some(_)) | (Some(_), Some(_)) => return Err("colours changed".into()),
    }
    Ok(())
}

fn real_meshes() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data/meshes");
    let Ok(entries) = std::fs::read_dir(&folder) else {
        println!("skipped: {} is not there", folder.display());
        return Vec::new();
    };
    let mut paths: Vec<_> =
        entries.map(|e| e.unwrap().path()).filter(|p| p.extension().is_some_and(|e| e != "bin")).collect();
    paths.sort();
    paths
}

#[test]
fn every_format_goes_through_every_format() {
    let out = tempfile::tempdir().unwrap();
    let (_folder, textured) = textured_box();
    let mut meshes: Vec<Boundary> = real_meshes().iter().map(|path| boundary::read(path).unwrap()).collect();
    meshes.push(textured);
    for mesh in &meshes {
        for amount in [0.0, 0.7] {
            let positions = warped(mesh, amount);
            for format in FORMATS {
                let path = out.path().join(format!("{}.{format}", mesh.name));
                export::mesh(mesh, &positions, None, &path).unwrap();
                let again = boundary::read(&path).unwrap();
                is_same(mesh, &positions, &again, format)
                    .unwrap_or_else(|what| panic!("{} as {format}: {what}", mesh.name));
                // And back into the format it came from, by way of this one.
                let back = out.path().join(format!("{}-back.ply", mesh.name));
                export::mesh(&again, &again.positions, None, &back).unwrap();
                is_same(&again, &again.positions, &boundary::read(&back).unwrap(), "ply")
                    .unwrap_or_else(|what| panic!("{} {format} → ply: {what}", mesh.name));
            }
        }
    }
}

#[test]
fn sabotage_changes_on_the_way_are_seen() {
    let (_folder, mesh) = textured_box();
    let same = |after: &Boundary| is_same(&mesh, &mesh.positions, after, "obj");
    assert_eq!(same(&mesh), Ok(()));
    let broken = |break_it: fn(&mut Boundary)| {
        let mut copy = mesh.clone();
        break_it(&mut copy);
        same(&copy)
    };
    assert!(broken(|m| m.positions[3].x += 1e-3).is_err());
    assert!(broken(|m| m.positions.swap(0, 7)).is_err());
    assert!(broken(|m| m.triangles.swap(0, 7)).is_err());
    assert!(broken(|m| m.attributes.clear()).is_err());
    assert!(broken(|m| m.attributes[0].values[2] = 0.0).is_err());
    let plain = Boundary::from_triangles("plain", mesh.positions.clone(), mesh.triangles.clone());
    assert!(same(&plain).is_err());
}

#[test]
fn an_identity_warp_gives_equal_numbers() {
    let out = tempfile::tempdir().unwrap();
    let (folder, _) = textured_box();
    let mut paths = real_meshes();
    paths.push(folder.path().join("box.obj"));
    for path in paths {
        let Some(extension) =
            path.extension().and_then(|e| e.to_str()).filter(|e| ["obj", "off", "ply", "stl"].contains(e))
        else {
            continue;
        };
        let mesh = boundary::read(&path).unwrap();
        let target = out.path().join(path.file_name().unwrap());
        export::mesh(&mesh, &mesh.positions, None, &target).unwrap();
        let again = boundary::read(&target).unwrap();
        let widest =
            mesh.positions.iter().zip(&again.positions).map(|(a, b)| (*a - *b).abs().max_element()).fold(0.0, f64::max);
        assert_eq!(widest, 0.0, "{}", path.display());
        assert_eq!(mesh.triangles, again.triangles);
        if extension == "obj" {
            // Line by line the same, but for numbers' spelling and normals.
            let keep = |text: &str| {
                text.lines()
                    .filter(|l| !l.starts_with("v") && !l.starts_with("f "))
                    .map(str::to_owned)
                    .collect::<Vec<_>>()
            };
            let (was, is) = (std::fs::read_to_string(&path).unwrap(), std::fs::read_to_string(&target).unwrap());
            assert_eq!(keep(&was), keep(&is), "{}", path.display());
            let faces = |text: &str| {
                text.lines().filter(|l| l.starts_with("f ")).map(|l| l.split_whitespace().count()).collect::<Vec<_>>()
            };
            assert_eq!(faces(&was), faces(&is), "polygons stay polygons");
        }
    }
}

#[test]
fn polygons_stay_polygons() {
    let out = tempfile::tempdir().unwrap();
    let (_folder, mesh) = textured_box();
    for format in ["off", "ply", "obj"] {
        let path = out.path().join(format!("box.{format}"));
        export::mesh(&mesh, &mesh.positions, None, &path).unwrap();
        let back = out.path().join("box2.off");
        export::mesh(&boundary::read(&path).unwrap(), &mesh.positions, None, &back).unwrap();
        let text = std::fs::read_to_string(&back).unwrap();
        assert_eq!(text.lines().filter(|line| line.starts_with("4 ")).count(), 6, "{format}: {text}");
    }
}

#[test]
fn an_obj_brings_its_library_and_textures() {
    let out = tempfile::tempdir().unwrap();
    let (_folder, mesh) = textured_box();
    // Something else has the name already, and keeps it.
    std::fs::write(out.path().join("box.mtl"), "mine").unwrap();
    let path = out.path().join("grown.obj");
    export::mesh(&mesh, &warped(&mesh, 1.0), None, &path).unwrap();
    assert_eq!(std::fs::read_to_string(out.path().join("box.mtl")).unwrap(), "mine");
    let again = boundary::read(&path).unwrap();
    assert!(again.warnings.is_empty(), "{:?}", again.warnings);
    assert_eq!(std::fs::read(out.path().join("wood grain.png")).unwrap(), png());
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(
        text.contains("# a comment that stays")
            && text.contains("mtllib grown_box.mtl")
            && text.contains("usemtl steel"),
        "{text}"
    );
}

#[test]
fn a_glb_from_a_textured_obj_holds_its_image_and_goes_back() {
    let out = tempfile::tempdir().unwrap();
    let (_folder, mesh) = textured_box();
    let path = out.path().join("box.glb");
    export::mesh(&mesh, &mesh.positions, None, &path).unwrap();
    let file = gltf::Gltf::open(&path).unwrap();
    let names: Vec<_> = file.materials().filter_map(|m| m.name().map(str::to_owned)).collect();
    assert_eq!(names, ["wood", "steel"]);
    assert_eq!(file.images().count(), 1);
    let bytes = file.blob.as_deref().unwrap();
    let gltf::image::Source::View { view, mime_type } = file.images().next().unwrap().source() else {
        panic!("the image is outside")
    };
    assert_eq!((mime_type, &bytes[view.offset()..view.offset() + view.length()]), ("image/png", png().as_slice()));

    let obj = out.path().join("back.obj");
    let again = boundary::read(&path).unwrap();
    export::mesh(&again, &again.positions, None, &obj).unwrap();
    assert!(std::fs::read_to_string(out.path().join("back.mtl")).unwrap().contains("newmtl wood\nKd 1 1 1\n"));
    let back = boundary::read(&obj).unwrap();
    assert!(back.warnings.is_empty(), "{:?}", back.warnings);
    assert_eq!(std::fs::read(out.path().join("back_texture_0.png")).unwrap(), png());
}

#[test]
fn gltf_materials_and_extras_survive_word_for_word() {
    for path in real_meshes().into_iter().filter(|p| p.ends_with("Duck.glb") || p.ends_with("hra_female_skin.glb")) {
        let out = tempfile::tempdir().unwrap();
        let mesh = boundary::read(&path).unwrap();
        let target = out.path().join("a.glb");
        export::mesh(&mesh, &mesh.positions, None, &target).unwrap();
        let (was, is) = (json_of(&std::fs::read(&path).unwrap()), json_of(&std::fs::read(&target).unwrap()));
        assert_eq!(was["materials"], is["materials"]);
        assert_eq!(was["textures"], is["textures"]);
        let extras =
            |root: &serde_json::Value| root["nodes"].as_array().unwrap().iter().find_map(|n| n.get("extras").cloned());
        assert_eq!(extras(&was), extras(&is));
        gltf::Gltf::open(&target).unwrap();
    }
}

#[test]
fn attributes_survive_ply_and_glb() {
    let mut mesh = textured_box().1;
    mesh.attributes
        .push(boundary::Attribute { name: "quality".into(), values: (0..8).map(|i| i as f32 / 3.0).collect() });
    let out = tempfile::tempdir().unwrap();
    for (format, name) in [("ply", "quality"), ("glb", "_quality")] {
        let path = out.path().join(format!("a.{format}"));
        export::mesh(&mesh, &mesh.positions, None, &path).unwrap();
        let again = boundary::read(&path).unwrap();
        let kept = again.attributes.iter().find(|a| a.name == name).unwrap();
        assert_eq!(kept.values[..8], mesh.attributes.last().unwrap().values[..], "{format}");
    }
}

#[test]
fn importance_colours_replace_those_of_the_input() {
    let (_folder, mesh) = textured_box();
    let out = tempfile::tempdir().unwrap();
    let colours: Vec<[f32; 3]> = (0..8).map(|i| [i as f32 / 7.0, 0.25, 1.0]).collect();
    for format in ["glb", "obj", "ply", "off"] {
        let path = out.path().join(format!("a.{format}"));
        export::mesh(&mesh, &mesh.positions, Some(&colours), &path).unwrap();
        let again = boundary::read(&path).unwrap().base_colours().unwrap();
        let widest = colours
            .iter()
            .zip(&again)
            .flat_map(|(a, b)| a.iter().zip(b).map(|(x, y)| (x - y).abs()))
            .fold(0.0f32, f32::max);
        assert!(widest < 0.01, "{format}: {widest}");
    }
    assert_eq!(json_of(&std::fs::read(out.path().join("a.glb")).unwrap())["materials"].as_array().unwrap().len(), 1);
}

/// Normals of a GLB, with the positions they stand at.
fn normals_of(path: &Path) -> Vec<(Vec3, Vec3)> {
    let file = gltf::Gltf::open(path).unwrap();
    let blob = file.blob.clone().unwrap();
    let of = |primitive: gltf::Primitive| {
        let reader = primitive.reader(|_| Some(&blob));
        reader
            .read_positions()
            .unwrap()
            .map(Vec3::from)
            .zip(reader.read_normals().unwrap().map(Vec3::from))
            .collect::<Vec<_>>()
    };
    file.meshes().flat_map(|mesh| mesh.primitives().flat_map(of).collect::<Vec<_>>()).collect()
}

#[test]
fn hard_edges_stay_hard_and_smooth_ones_smooth() {
    let out = tempfile::tempdir().unwrap();
    let path = out.path().join("a.glb");
    let (_folder, sharp) = textured_box();
    export::mesh(&sharp, &sharp.positions, None, &path).unwrap();
    let is_axis = |n: &Vec3| n.abs().max_element() > 0.9999;
    let normals = normals_of(&path);
    assert_eq!(normals.len(), 24);
    assert!(normals.iter().all(|(_, n)| is_axis(n)));
    // Sabotage: without the input's normals the corners are rounded, so the check above can fail.
    let smooth = Boundary::from_triangles("box", sharp.positions.clone(), sharp.triangles.clone());
    export::mesh(&smooth, &smooth.positions, None, &path).unwrap();
    let normals = normals_of(&path);
    assert_eq!(normals.len(), 8);
    let centre = Vec3::new(1.05, 1.0, 1.0);
    assert!(normals.iter().all(|(p, n)| !is_axis(n) && n.dot(*p - centre) > 0.0), "outwards, rounded");
}

#[test]
fn normals_rounded_apart_at_a_seam_stay_one() {
    let folder = tempfile::tempdir().unwrap();
    let count_for = |normal: &str| {
        let text =
            format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvn 0 0 1\nvn {normal}\nf 1//1 2//1 3//1\nf 3//2 2//2 4//2\n");
        let path = folder.path().join("a.obj");
        std::fs::write(&path, text).unwrap();
        let mesh = boundary::read(&path).unwrap();
        let out = folder.path().join("a.glb");
        export::mesh(&mesh, &mesh.positions, None, &out).unwrap();
        normals_of(&out).len()
    };
    assert_eq!(count_for("0.005 0 1"), 4);
    assert_eq!(count_for("0.5 0 1"), 6);
}

fn frames(mesh: &Boundary, count: usize) -> Vec<Vec<DVec3>> {
    (0..count).map(|k| warped(mesh, k as f64 * k as f64)).collect()
}

#[test]
fn a_growth_plays_as_its_frames_say() {
    let (_folder, mesh) = textured_box();
    let out = tempfile::tempdir().unwrap();
    let path = out.path().join("growth.glb");
    let states = frames(&mesh, 5);
    let lambdas = [0.0, 0.1, 0.3, 0.6, 1.0];
    let frames: Vec<_> =
        states.iter().zip(lambdas).map(|(positions, lambda)| GrowthFrame { lambda, positions }).collect();
    export::growth(&mesh, &frames, None, 4.0, &path, &|| false).unwrap();

    let file = gltf::Gltf::open(&path).unwrap();
    let blob = file.blob.clone().unwrap();
    let animation = file.animations().next().unwrap();
    let reader = animation.channels().next().unwrap();
    let reader = reader.reader(|_| Some(&blob));
    let times: Vec<f32> = reader.read_inputs().unwrap().collect();
    let Some(gltf::animation::util::ReadOutputs::MorphTargetWeights(weights)) = reader.read_outputs() else {
        panic!("no weights")
    };
    let weights: Vec<f32> = weights.into_f32().collect();
    assert_eq!(weights.len(), times.len() * 4);
    assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "{times:?}");
    let close = |a: f32, b: f32| (a - b).abs() < 1e-5;
    assert!(
        close(times[3], 2.4)
            && close(times[4], 4.0)
            && close(times[5], 5.0)
            && close(times[9], 9.0)
            && close(times[10], 10.0),
        "{times:?}"
    );

    let primitive = file.meshes().next().unwrap().primitives().next().unwrap();
    let primitive = primitive.reader(|_| Some(&blob));
    let base: Vec<Vec3> = primitive.read_positions().unwrap().map(Vec3::from).collect();
    let targets: Vec<Vec<Vec3>> =
        primitive.read_morph_targets().map(|(p, _, _)| p.unwrap().map(Vec3::from).collect()).collect();
    let shown = |key: usize| -> Vec<Vec3> {
        let own = &weights[4 * key..4 * key + 4];
        (0..8).map(|v| base[v] + (0..4).map(|t| own[t] * targets[t][v]).sum::<Vec3>()).collect()
    };
    for (key, frame) in (0..5).chain((0..5).rev()).chain([0]).enumerate() {
        let widest = shown(key)
            .iter()
            .zip(&states[frame])
            .map(|(a, b)| (*a - b.as_vec3()).abs().max_element())
            .fold(0.0f32, f32::max);
        assert!(widest < 1e-5, "key {key} shows frame {frame} up to {widest}");
        let used: HashSet<usize> =
            weights[4 * key..].iter().take(8).enumerate().filter(|(_, w)| **w != 0.0).map(|(i, _)| i % 4).collect();
        assert!(used.len() <= 2, "two frames blend at most");
    }
    // Sabotage: another frame is not what the key shows, so the comparison can fail.
    let off =
        shown(3).iter().zip(&states[2]).map(|(a, b)| (*a - b.as_vec3()).abs().max_element()).fold(0.0f32, f32::max);
    assert!(off > 0.1);
    // The rest shape, read back, is the input.
    is_same(&mesh, &mesh.positions, &boundary::read(&path).unwrap(), "glb").unwrap();
}

#[test]
fn a_growth_needs_frames_and_time() {
    let (_folder, mesh) = textured_box();
    let path = Path::new("never.glb");
    let frame = GrowthFrame { lambda: 0.0, positions: &mesh.positions };
    for (frames, seconds) in [(vec![], 1.0), (vec![frame], 1.0), (vec![frame; 2], 0.0), (vec![frame; 2], f32::NAN)] {
        assert!(matches!(export::growth(&mesh, &frames, None, seconds, path, &|| false), Err(Error::Input(_))));
    }
    assert!(!path.exists());
}

#[test]
fn a_failed_write_leaves_what_was_there() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.txt");
    write_atomically(&path, |file| file.write_all(b"old")).unwrap();
    let failed = write_atomically(&path, |file| {
        file.write_all(b"half of the n")?;
        Err(std::io::Error::other("the disk is full"))
    });
    assert!(failed.unwrap_err().to_string().contains("the disk is full"));
    assert_eq!(std::fs::read(&path).unwrap(), b"old");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "no temporary file stays");
    let missing = folder.path().join("no/such/folder/a.txt");
    assert!(matches!(write_atomically(&missing, |_| Ok(())), Err(Error::File { .. })));
    let (_box, mesh) = textured_box();
    for name in ["a.xyz", "a.gltf", "a"] {
        let error = export::mesh(&mesh, &mesh.positions, None, &folder.path().join(name)).unwrap_err();
        assert!(error.to_string().contains(".glb"), "{error}");
    }
}
