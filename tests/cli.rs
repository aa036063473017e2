//! Contract of the command line: its words, their order, what is written where, and how the program ends. Others script
//! by all of it.

#![cfg(feature = "cli")]
#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Output, Stdio};

use homunculus::app::options::{Colour, Order, ReferenceName, WarpOrder, parse};
use homunculus::importance::Layer;
use homunculus::scene::Source;
use tempfile::TempDir;

const PROGRAM: &str = env!("CARGO_BIN_EXE_homunculus");

/// Boxes `[x, x + 1] × [0, 4] × [0, 1]` as OBJ.
fn bars(at: &[f64]) -> String {
    let mut text = String::new();
    for x in at {
        for corner in 0..8 {
            let (i, j, k) = (corner & 1, corner >> 1 & 1, corner >> 2);
            text += &format!("v {} {} {}\n", x + f64::from(i), 4 * j, k);
        }
    }
    let sides = [[1, 3, 4, 2], [5, 6, 8, 7], [1, 2, 6, 5], [3, 7, 8, 4], [1, 5, 7, 3], [2, 4, 8, 6]];
    for bar in 0..at.len() {
        for side in sides {
            let [a, b, c, d] = side.map(|v| v + 8 * bar);
            text += &format!("f {a} {b} {c}\nf {a} {c} {d}\n");
        }
    }
    text
}

/// A folder with `bar.obj` and `bars.obj`.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("bar.obj"), bars(&[0.0])).unwrap();
    std::fs::write(folder.path().join("bars.obj"), bars(&[0.0, 2.0])).unwrap();
    folder
}

fn run(folder: &Path, arguments: &str) -> Output {
    Command::new(PROGRAM).args(arguments.split_whitespace()).current_dir(folder).output().unwrap()
}

fn listing(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> =
        std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn json(path: &Path) -> serde_json::Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

fn order(arguments: &str) -> Result<WarpOrder, clap::Error> {
    let words = ["homunculus", "warp"].into_iter().chain(arguments.split_whitespace());
    match parse(words.map(Into::into))? {
        Order::Warp(order) => Ok(*order),
        other => panic!("{other:?} is no warp"),
    }
}

// ── words ──

#[test]
fn every_option_is_understood() {
    let order = order(
        "body.obj -o out.ply --growth g.glb --report r.json --resolution 96 --fidelity 0.9 --base 0.8 --clamp \
         --keys 12 --seconds 2.5 --threads 3 --reference fig5 --colour original --save-scene s.ron -q",
    )
    .unwrap();
    let options = &order.options;
    assert_eq!(options.scene.source, Some(Source::File("body.obj".into())));
    assert_eq!(options.output.as_deref(), Some(Path::new("out.ply")));
    assert_eq!(options.growth.as_deref(), Some(Path::new("g.glb")));
    assert_eq!(options.report.as_deref(), Some(Path::new("r.json")));
    assert_eq!(options.scene.save_scene.as_deref(), Some(Path::new("s.ron")));
    assert_eq!((options.seconds, options.scene.threads, options.scene.quiet), (2.5, Some(3), true));
    assert_eq!((options.scene.reference, options.colour), (Some(ReferenceName::Fig5), Some(Colour::Original)));
    let scene = order.scene().unwrap();
    assert_eq!((scene.resolution, scene.fidelity, scene.keys), (96, 0.9, 12));
    assert_eq!((scene.base, scene.clamp), (0.8, true));
}

#[test]
fn importance_keeps_its_order() {
    let order = order(
        "gallery:hand --values a.csv --sphere -1,-2.5,3e-1,0.5,2 --regions r.csv --attribute heat:0.5..3 --values b.csv \
         --image ../m.png:1..2 --sphere 0,0,0,1,0.5 --attribute heat --image m.png",
    )
    .unwrap();
    let heat = |range| Layer::Attribute { name: "heat".into(), range };
    let expected = [
        Layer::Values { path: "a.csv".into() },
        Layer::Sphere { centre: [-1.0, -2.5, 0.3], radius: 0.5, value: 2.0 },
        Layer::Regions { regions: "r.csv".into(), values: "b.csv".into(), per_area: false },
        heat(Some((0.5, 3.0))),
        Layer::Image { path: "../m.png".into(), range: Some((1.0, 2.0)) },
        Layer::Sphere { centre: [0.0; 3], radius: 1.0, value: 0.5 },
        heat(None),
        Layer::Image { path: "m.png".into(), range: None },
    ];
    assert_eq!(order.layers, expected);
    let mut swapped = expected.clone();
    swapped.swap(1, 3); // sabotage: seen to fail
    assert_ne!(order.layers, swapped);
}

#[test]
fn a_colon_may_be_part_of_a_name() {
    let layers = order("a.ply --attribute ns:heat --attribute ns:heat:1..2 --image a:b/../m.png").unwrap().layers;
    assert_eq!(layers[0], Layer::Attribute { name: "ns:heat".into(), range: None });
    assert_eq!(layers[1], Layer::Attribute { name: "ns:heat".into(), range: Some((1.0, 2.0)) });
    assert_eq!(layers[2], Layer::Image { path: "a:b/../m.png".into(), range: None });
}

#[test]
fn each_bad_option_is_refused_in_words() {
    let cases = [
        ("", "required"),
        ("a.obj --sphere 1,2,3", "five numbers"),
        ("a.obj --sphere 1,2,3,4,x", "`x` is not a number"),
        ("a.obj --sphere 1,2,nan,4,1", "not finite"),
        ("a.obj --sphere 1,2,3,0,1", "radius"),
        ("a.obj --attribute heat:1..x", "`x` is not a number"),
        ("a.obj --attribute :1..2", "name is missing"),
        ("a.obj --image :1..2", "file is missing"),
        ("a.obj --regions r.csv", "--values after it"),
        ("a.obj --values v.csv --regions r.csv", "--values after it"),
        ("a.obj --resolution -3", "-3"),
        ("a.obj --resolution many", "many"),
        ("a.obj --resolution 99999999999", "99999999999"),
        ("a.obj --threads 0", "0"),
        ("a.obj --reference fig6", "fig5"),
        ("a.obj --colour red", "importance"),
        ("a.obj --seconds 0", "seconds"),
        ("a.obj --fidelity high", "high"),
        ("a.obj --frobnicate", "--frobnicate"),
        ("a.obj b.obj", "b.obj"),
    ];
    for (arguments, expected) in cases {
        let error = order(arguments).unwrap_err();
        assert!(error.use_stderr() && error.to_string().contains(expected), "{arguments:?} gave {error}");
    }
}

#[test]
fn options_override_the_scene_and_add_to_its_importance() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("s.ron");
    let sphere = "Sphere(centre: (0, 0, 0), radius: 1, value: 2)";
    std::fs::write(&path, format!("(version: 1, source: \"a.obj\", resolution: 32, keys: 5, layers: [{sphere}])"))
        .unwrap();
    let path = path.display();
    let scene = order(&format!("--scene {path}")).unwrap().scene().unwrap();
    assert_eq!(scene.source, Source::File(folder.path().join("a.obj")));
    assert_eq!((scene.resolution, scene.keys, scene.layers.len()), (32, 5, 1));
    let scene = order(&format!("--scene {path} b.obj --resolution 48 --sphere 1,1,1,1,3")).unwrap().scene().unwrap();
    assert_eq!(scene.source, Source::File("b.obj".into()));
    assert_eq!((scene.resolution, scene.keys, scene.layers.len()), (48, 5, 2));
    assert!(matches!(scene.layers[1], Layer::Sphere { value: 3.0, .. }));
}

// ── results ──

const REPORT_KEYS: [&str; 9] =
    ["input", "domain", "classic", "certificate", "fidelity", "distortion", "seconds", "peak_memory_bytes", "version"];

#[test]
fn a_certified_warp_ends_with_0_and_writes_what_was_named() {
    let folder = folder();
    let before = std::fs::read(folder.path().join("bar.obj")).unwrap();
    let arguments = "warp bar.obj --sphere 0.5,0,0.5,1.5,1.6 --resolution 12 --keys 3 --threads 2 \
                     -o out.obj --growth g.glb --report r.json --save-scene s.ron";
    let output = run(folder.path(), arguments);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert_eq!(listing(folder.path()), ["bar.obj", "bars.obj", "g.glb", "out.obj", "r.json", "s.ron"]);
    assert_eq!(std::fs::read(folder.path().join("bar.obj")).unwrap(), before);

    let summary = text(&output.stdout);
    assert_eq!(summary.lines().count(), 1, "{summary}");
    assert!(summary.starts_with("certified: 0 inverted, 0 crossings"), "{summary}");
    assert!(summary.contains("size error p95") && summary.contains("out.obj"), "{summary}");

    let progress = text(&output.stderr);
    assert!(progress.contains('%') && !progress.contains(['\r', '\u{1b}']), "plain lines in a pipe: {progress:?}");

    let report = json(&folder.path().join("r.json"));
    for key in REPORT_KEYS {
        assert!(report.get(key).is_some(), "{key} is missing");
    }
    assert!(report.get("sabotage").is_none());
    for key in ["vertices", "triangles", "components", "boundary_loops", "self_intersections"] {
        assert!(report["input"][key].is_u64(), "input.{key}");
    }
    for key in ["resolution", "cell_size", "cells", "nodes", "edges", "elements", "suspected_welds"] {
        assert!(report["domain"][key].is_number(), "domain.{key}");
    }
    for key in ["mu", "median", "p95", "max"] {
        assert!(report["fidelity"][key].is_number(), "fidelity.{key}");
    }
    for key in ["median", "p95", "p99"] {
        assert!(report["distortion"][key].is_number(), "distortion.{key}");
    }
    assert!(report["fidelity"]["regions"].is_array() && report["seconds"].is_object());
    assert_eq!(report["input"]["vertices"], 8);
    let certificate = &report["certificate"];
    assert_eq!(
        (&certificate["certified"], &certificate["inverted"], &certificate["crossings"]),
        (&true.into(), &0.into(), &0.into())
    );
    assert!(certificate["min_volume_ratio"].is_number());
    let frames = certificate["frames"].as_array().unwrap();
    assert_eq!((&frames[0]["lambda"], &frames[frames.len() - 1]["lambda"]), (&0.0.into(), &1.0.into()));

    let again = run(folder.path(), "warp --scene s.ron -o again.obj -q");
    assert_eq!(again.status.code(), Some(0), "{}", text(&again.stderr));
    assert!((again.stdout.is_empty(), again.stderr.is_empty()) == (true, true), "quiet is quiet");
    assert_eq!(
        std::fs::read(folder.path().join("again.obj")).unwrap(),
        std::fs::read(folder.path().join("out.obj")).unwrap()
    );
}

#[test]
fn without_names_the_warped_mesh_lies_beside_the_user() {
    let folder = folder();
    let output = run(folder.path(), "warp bar.obj --base 1.2 --resolution 8 --keys 1");
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert_eq!(listing(folder.path()), ["bar-warped.obj", "bar.obj", "bars.obj"]);
}

#[test]
fn regions_reach_the_report_and_warnings_the_user() {
    let folder = folder();
    std::fs::write(folder.path().join("r.csv"), "vertex,region\n0,foot\n1,foot\n7,head\n").unwrap();
    std::fs::write(folder.path().join("w.csv"), "region,importance\nfoot,0\nhead,1.5\n").unwrap();
    let arguments = "warp bar.obj --regions r.csv --values w.csv --resolution 8 --keys 1 --report r.json";
    let refused = run(folder.path(), arguments);
    assert_eq!(refused.status.code(), Some(2));
    assert!(
        text(&refused.stderr).contains("w.csv: row 2: importance 0 is not greater than 0"),
        "{}",
        text(&refused.stderr)
    );
    assert!(!folder.path().join("r.json").exists());
    let clamped = run(folder.path(), &format!("{arguments} --clamp"));
    assert!(text(&clamped.stderr).contains("warning: importance clamped to 0.05..20: 1 value"));
    assert_eq!(json(&folder.path().join("r.json"))["clamped"], 1);
}

#[test]
fn not_certified_ends_with_3_and_lies_next_to_its_report() {
    let folder = folder();
    // Eq. 1 alone lets two bars, each three times as wide as now, grow into each other.
    let output = run(folder.path(), "warp bars.obj --base 3 --resolution 16 --keys 2 --reference eq1 -o out.obj");
    assert_eq!(output.status.code(), Some(3), "{}", text(&output.stderr));
    assert!(text(&output.stdout).starts_with("NOT CERTIFIED"), "{}", text(&output.stdout));
    assert_eq!(listing(folder.path()), ["bar.obj", "bars.obj", "out.obj", "out.report.json"]);
    let certificate = &json(&folder.path().join("out.report.json"))["certificate"];
    assert_eq!(certificate["certified"], false);
    assert!(certificate["crossings"].as_u64().unwrap() > 0);
}

#[test]
fn bad_input_ends_with_2_in_one_sentence_and_writes_nothing() {
    let folder = folder();
    std::fs::write(folder.path().join("empty.obj"), "").unwrap();
    std::fs::write(folder.path().join("bad.ron"), "(version: 1,\nsource: \"bar.obj\",\nkeyz: 1)").unwrap();
    std::fs::create_dir(folder.path().join("folder.obj")).unwrap();
    std::fs::write(folder.path().join("v.csv"), "vertex,importance\n8,2\n").unwrap();
    let before = listing(folder.path());
    let cases = [
        ("warp", "required"),
        ("warp absent.obj", "absent.obj: cannot read"),
        ("warp empty.obj", "empty.obj"),
        ("warp folder.obj", "folder.obj"),
        ("warp gallery:nothing", "nothing"),
        ("warp bar.obj --resolution 0", "resolution 0 is not within 8 to 256"),
        ("warp bar.obj --resolution 100000", "EB of memory"),
        ("warp bar.obj --fidelity 2", "fidelity 2"),
        ("warp bar.obj --fidelity -1", "fidelity -1"),
        ("warp bar.obj --keys 65", "keys 65"),
        ("warp bar.obj --base 0", "base 0"),
        ("warp bar.obj --base -2", "base -2"),
        ("warp bar.obj --sphere 0,0,0,1,-2", "importance -2 is not greater than 0"),
        ("warp bar.obj --values v.csv", "v.csv: row 2: unknown vertex 8"),
        ("warp bar.obj --attribute heat", "`heat`"),
        ("warp bar.obj --image m.png", "texture coordinates"),
        ("warp bar.obj -o bar.obj", "another name"),
        ("warp bar.obj -o ./folder.obj/../bar.obj", "another name"),
        ("warp bar.obj --save-scene v.csv", ".ron"),
        ("warp bar.obj --values bars.obj -o bars.obj", "another name"),
        ("warp bar.obj -o x.glb --growth x.glb", "another name"),
        ("warp bar.obj -o out.txt", ".glb, .obj, .ply, .stl or .off"),
        ("warp bar.obj -o out", ".glb"),
        ("warp bar.obj --growth g.obj", ".glb"),
        ("warp bar.obj -o nowhere/out.obj", "nowhere does not exist"),
        ("warp bar.obj -o folder.obj", "directory"),
        ("warp --scene bad.ron", "bad.ron: line 3"),
        ("warp --scene absent.ron", "absent.ron: cannot read"),
        ("inspect absent.obj", "absent.obj: cannot read"),
        ("inspect bar.obj --resolution 100000", "EB of memory"),
        ("dance", "dance"),
    ];
    for (arguments, expected) in cases {
        let output = run(folder.path(), arguments);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?} said {said:?}");
        assert!(said.contains(expected), "{arguments:?} said {said:?}, not {expected:?}");
        assert!(!said.contains("panicked") && output.stdout.is_empty(), "{arguments:?}");
    }
    assert_eq!(listing(folder.path()), before);
}

#[cfg(target_os = "linux")]
#[test]
fn what_cannot_be_written_ends_with_1() {
    let folder = folder();
    let output = run(folder.path(), "warp bar.obj --base 1.1 --resolution 8 --keys 1 -o /proc/out.obj");
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("/proc/out.obj: cannot write"), "{}", text(&output.stderr));
}

/// Runs a long warp over an old result, and interrupts it after its first word if asked to. Returns the exit code, what
/// lies there, and whether the old result still does.
#[cfg(unix)]
fn long_warp(interrupt: bool, resolution: u32) -> (Option<i32>, Vec<String>, bool) {
    let folder = folder();
    std::fs::write(folder.path().join("out.obj"), "old").unwrap();
    let resolution = resolution.to_string();
    let arguments =
        ["warp", "bars.obj", "--base", "1.3", "--resolution", &resolution, "-o", "out.obj", "--report", "r.json"];
    let mut program = Command::new(PROGRAM);
    let program = program.args(arguments).current_dir(folder.path()).stderr(Stdio::piped()).stdout(Stdio::null());
    let mut child = program.spawn().unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
    assert!(lines.next().is_some(), "it says something while it works");
    if interrupt {
        let kill = format!("kill -INT {}", child.id());
        assert!(Command::new("sh").args(["-c", &kill]).status().unwrap().success());
    }
    let rest: Vec<_> = lines.map_while(Result::ok).collect();
    let code = child.wait().unwrap().code();
    assert_eq!(rest.iter().any(|line| line.contains("stopped at your request")), interrupt, "{rest:?}");
    let is_old = std::fs::read(folder.path().join("out.obj")).unwrap() == b"old";
    (code, listing(folder.path()), is_old)
}

#[cfg(unix)]
#[test]
fn an_interrupted_warp_leaves_nothing() {
    let files = ["bar.obj", "bars.obj", "out.obj"].map(String::from).to_vec();
    assert_eq!(long_warp(true, 96), (Some(1), files, true));
}

#[cfg(unix)]
#[test]
fn sabotage_one_that_is_not_interrupted_leaves_its_files() {
    let files = ["bar.obj", "bars.obj", "out.obj", "r.json"].map(String::from).to_vec();
    assert_eq!(long_warp(false, 12), (Some(0), files, false));
}

/// At so fine a lattice it looks for the wish seldom.
#[cfg(unix)]
#[test]
fn a_second_interrupt_ends_it_at_once_and_leaves_no_half_file() {
    let folder = folder();
    std::fs::write(folder.path().join("out.obj"), "old").unwrap();
    let mut program = Command::new(PROGRAM);
    let program = program.args(["warp", "bars.obj", "--base", "1.3", "--resolution", "256", "-o", "out.obj"]);
    let program = program.current_dir(folder.path()).stderr(Stdio::piped()).stdout(Stdio::null());
    let mut child = program.spawn().unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
    assert!(lines.next().is_some(), "it says something while it works");
    let kill = format!("kill -INT {0}; sleep 0.1; kill -INT {0}", child.id());
    assert!(Command::new("sh").args(["-c", &kill]).status().unwrap().success());
    let start = std::time::Instant::now();
    let rest: Vec<_> = lines.map_while(Result::ok).collect();
    assert_eq!(child.wait().unwrap().code(), Some(1));
    assert!(start.elapsed() < std::time::Duration::from_secs(2), "{rest:?}");
    assert!(rest.iter().any(|line| line.contains("ended at once") || line.contains("stopped at your request")));
    assert_eq!(std::fs::read(folder.path().join("out.obj")).unwrap(), b"old");
    assert!(listing(folder.path()).iter().all(|name| name.starts_with("bar") || name == "out.obj"));
}

// ── other faces ──

#[test]
fn inspect_tells_people_and_programs() {
    let folder = folder();
    let before = listing(folder.path());
    let output = run(folder.path(), "inspect bars.obj --resolution 16");
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let said = text(&output.stdout);
    for word in ["vertices", "triangles", "components", "self-intersections", "cells", "elements", "memory", "16"] {
        assert!(said.contains(word), "{word} is missing in {said}");
    }
    let output = run(folder.path(), "inspect bars.obj --resolution 16 --json");
    let said: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&said["input"]["vertices"], &said["input"]["triangles"]), (&16.into(), &24.into()));
    assert_eq!(said["extents"]["max"], serde_json::json!([3.0, 4.0, 1.0]));
    assert_eq!((&said["uv"], &said["colours"]), (&false.into(), &false.into()));
    assert_eq!(said["domain"]["resolution"], 16);
    assert_eq!(listing(folder.path()), before);
}

#[test]
fn help_and_version_end_with_0() {
    let folder = folder();
    for (arguments, expected) in [
        ("--version", env!("CARGO_PKG_VERSION")),
        ("--help", "warp"),
        ("warp --help", "--sphere -0.7,1.4,0,0.2,2.5"),
        ("inspect --help", "--json"),
    ] {
        let output = run(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(0));
        assert!(text(&output.stdout).contains(expected), "{arguments}");
    }
}

#[cfg(feature = "window")]
#[test]
fn the_gallery_opens_one_scene_by_its_name() {
    let folder = folder();
    let said = |names: &[&str]| {
        let mut program = Command::new(PROGRAM);
        let program = program.args(["gallery", "--open"]).args(names).env("XDG_DATA_HOME", folder.path());
        // Nothing opens here: names are looked at before the display is.
        let output = program.env("DISPLAY", ":63").env_remove("WAYLAND_DISPLAY").output().unwrap();
        (output.status.code(), text(&output.stderr))
    };
    let (code, sentence) = said(&["nothing"]);
    assert!(code == Some(2) && sentence.contains("nothing"), "{sentence}");
    let (code, sentence) = said(&["hand", "lamp"]);
    assert!(code == Some(2) && sentence.contains("one scene at a time"), "{sentence}");
    let (code, sentence) = said(&["gallery:hand"]);
    assert!(code == Some(2) && !sentence.contains("hand"), "{sentence}");
}

#[test]
fn the_gallery_is_listed_a_line_each() {
    let run = Command::new(PROGRAM).arg("gallery").output().unwrap();
    let text = String::from_utf8_lossy(&run.stdout);
    assert!(run.status.success());
    for name in ["homunculus", "hand", "elephant", "crocodile"] {
        assert!(text.lines().any(|line| line.starts_with(&format!("gallery:{name} "))), "{name} in {text}");
    }
}

#[test]
fn threads_are_as_many_as_asked_for_of_what_is_built_in_too() {
    let folder = folder();
    for scene in ["gallery:snake", "gallery:hand"] {
        let output =
            run(folder.path(), &format!("warp {scene} --resolution 16 --keys 1 --threads 1 --report r.json -q"));
        assert_eq!(output.status.code(), Some(0), "{scene}: {}", text(&output.stderr));
    }
}
