//! Contract of scenes: what is saved comes back the same from any directory, and what cannot be meant is refused with
//! the file, the line, the value and its range.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

use std::path::{Path, PathBuf};

use homunculus::importance::Layer;
use homunculus::scene::{Draft, Scene, Source, VERSION};

fn full(folder: &Path) -> Draft {
    Draft {
        version: VERSION,
        source: Source::File(folder.join("body.obj")),
        base: 0.75,
        clamp: true,
        layers: vec![
            Layer::Sphere { centre: [-1.0, 0.5, 1e-3], radius: 0.2, value: 2.5 },
            Layer::Attribute { name: "heat".into(), range: Some((0.5, 2.0)) },
            Layer::Attribute { name: "size".into(), range: None },
            Layer::Values { path: folder.join("tables/v.csv") },
            Layer::Regions { regions: folder.join("r.csv"), values: folder.join("w.csv"), per_area: false },
            Layer::Image { path: folder.join("map.png"), range: None },
        ],
        hidden: Vec::new(),
        strokes: Vec::new(),
        resolution: 96,
        fidelity: 0.9,
        keys: 12,
        background: None,
    }
}

fn refusal(text: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("s.ron");
    std::fs::write(&path, text).unwrap();
    Scene::load(&path).unwrap_err().to_string().replace(&format!("{}/", folder.path().display()), "")
}

fn plain(path: &Path) -> PathBuf {
    // The files need not exist, so `..` is resolved by words.
    path.components().fold(PathBuf::new(), |mut so_far, part| {
        if part == std::path::Component::ParentDir {
            so_far.pop();
        } else {
            so_far.push(part);
        }
        so_far
    })
}

/// Saves to `saved`, loads again, and brings paths to their plain form.
fn round_trip(scene: &Scene, saved: &Path) -> Draft {
    scene.save(saved).unwrap();
    let mut draft = Scene::load(saved).unwrap().into_draft();
    if let Source::File(path) = &mut draft.source {
        *path = plain(path);
    }
    draft.layers = draft.layers.into_iter().map(|layer| layer.map_files(plain)).collect();
    draft
}

#[test]
fn what_is_saved_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path().canonicalize().unwrap();
    std::fs::create_dir(folder.join("scenes")).unwrap();
    let scene = Scene::new(full(&folder)).unwrap();
    assert_eq!(round_trip(&scene, &folder.join("s.ron")), *scene);
    assert_eq!(round_trip(&scene, &folder.join("scenes/s.ron")), *scene);
    let text = std::fs::read_to_string(folder.join("scenes/s.ron")).unwrap();
    assert!(text.contains("\"../body.obj\""), "paths are relative to the scene file: {text}");
    assert!(!text.contains(&folder.display().to_string()), "a scene moves with its folder: {text}");
}

#[test]
fn sabotage_a_change_is_seen() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path().canonicalize().unwrap();
    let scene = Scene::new(full(&folder)).unwrap();
    let mut draft = full(&folder);
    draft.layers.swap(1, 2);
    let changed = Scene::new(draft).unwrap();
    assert_ne!(round_trip(&changed, &folder.join("s.ron")), *scene);
}

#[test]
fn galleries_and_defaults() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("s.ron");
    std::fs::write(&path, "(version: 1, source: \"gallery:hand\")").unwrap();
    let scene = Scene::load(&path).unwrap();
    assert_eq!(scene.source, Source::Gallery("hand".into()));
    assert_eq!((scene.resolution, scene.fidelity, scene.keys, scene.base), (64, 0.5, 8, 1.0));
    assert!(scene.files().is_empty());
    assert_eq!(round_trip(&scene, &path), *scene);
}

#[test]
fn ranges_need_no_some() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("s.ron");
    let text = "(version: 1, source: \"a.obj\", layers: [Image(path: \"m.png\", range: (0.5, 2.0))])";
    std::fs::write(&path, text).unwrap();
    let expected = Layer::Image { path: folder.path().join("m.png"), range: Some((0.5, 2.0)) };
    assert_eq!(Scene::load(&path).unwrap().layers, [expected]);
}

#[test]
fn each_bad_scene_is_named() {
    let cases = [
        ("(version: 1,\n source: \"a.obj\",\n resolutoin: 64)", "s.ron: line 3: ", "resolutoin"),
        ("(version: 1,\n source: \"a.obj\",\n layers: [\n Sphere(center: (0, 0, 0))])", "s.ron: line 4: ", "center"),
        ("(version: 1,\n source: \"a.obj\",\n layers: [\n Blob(r: 1)])", "s.ron: line 4: ", "Blob"),
        ("(version: 1,\n source: 7)", "s.ron: line 2: ", ""),
        ("(version: 1)", "s.ron: line 1: ", "source"),
        ("(source: \"a.obj\")", "s.ron: line 1: ", "version"),
        ("", "s.ron: line 1: ", ""),
        ("(version: 2, source: \"a.obj\", news: 1)", "s.ron: scene version 2 is not known", "1"),
        ("(version: 1, source: \"a.obj\", resolution: 7)", "s.ron: resolution 7 is not within 8 to 256", ""),
        ("(version: 1, source: \"\", keys: 4)", "s.ron: ", "source is empty"),
    ];
    for (text, begins, contains) in cases {
        let found = refusal(text);
        assert!(found.starts_with(begins) && found.contains(contains), "{text:?} gave {found:?}");
    }
}

#[test]
fn each_value_has_its_range() {
    let draft = || Draft::of(Source::Gallery("hand".into()));
    let refused = |draft: Draft| Scene::new(draft).unwrap_err().to_string();
    assert!(refused(Draft { resolution: 0, ..draft() }).contains("about 0 B of memory"));
    let huge = refused(Draft { resolution: 100_000, ..draft() });
    assert!(huge.contains("100000") && huge.contains("EB of memory"), "{huge}");
    assert!(refused(Draft { resolution: 257, ..draft() }).contains("GB of memory"));
    for fidelity in [-0.1, 1.1, f32::NAN] {
        assert!(refused(Draft { fidelity, ..draft() }).contains("0 to 1"));
    }
    for keys in [0, 65] {
        assert!(refused(Draft { keys, ..draft() }).contains("1 to 64"));
    }
    for base in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert!(refused(Draft { base, ..draft() }).contains("base"));
    }
    assert!(Scene::new(Draft { resolution: 8, fidelity: 0.0, keys: 1, ..draft() }).is_ok());
    assert!(Scene::new(Draft { resolution: 256, fidelity: 1.0, keys: 64, ..draft() }).is_ok());
}
