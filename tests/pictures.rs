//! Contract of pictures before the camera and under the glass: `record` shows a picture's own colours, its own outline and
//! its growth, proven frame by frame; `inspect` says what is in it. Tests say `skipped` where there is no Vulkan driver.

#![cfg(all(feature = "cli", feature = "record"))]
#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

use std::path::Path;
use std::process::{Command, Output};

use image::{Rgba, RgbaImage};
use serde_json::Value;

/// Colours of the test picture's four fields.
const FIELDS: [[u8; 3]; 4] = [[200, 40, 60], [30, 120, 220], [250, 240, 80], [128, 128, 128]];

/// Four fields of 40 × 30 pixels with a transparent margin of ten, which is bright green where nobody should see it.
fn fields() -> RgbaImage {
    RgbaImage::from_fn(100, 80, |x, y| {
        if !(10..90).contains(&x) || !(10..70).contains(&y) {
            return Rgba([0, 255, 0, 0]);
        }
        let [r, g, b] = FIELDS[usize::from(x >= 50) + 2 * usize::from(y >= 40)];
        Rgba([r, g, b, 255])
    })
}

fn run(folder: &Path, arguments: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_homunculus"));
    // Without a folder for it a driver complains by itself.
    command.env("XDG_RUNTIME_DIR", folder);
    command.args(arguments.split_whitespace()).current_dir(folder).output().unwrap()
}

/// Records; `None`, said aloud, where nothing can draw.
fn record(folder: &Path, arguments: &str) -> Option<()> {
    let output = run(folder, &format!("record {arguments} --quiet"));
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    if output.status.code() == Some(2) && said.contains("Vulkan") {
        eprintln!("skipped: no Vulkan driver");
        return None;
    }
    assert_eq!(output.status.code(), Some(0), "{arguments}: {said}");
    Some(())
}

fn open(folder: &Path, name: &str) -> RgbaImage {
    image::open(folder.join(name)).unwrap().to_rgba8()
}

fn json(folder: &Path, name: &str) -> Value {
    serde_json::from_slice(&std::fs::read(folder.join(name)).unwrap()).unwrap()
}

/// The box around all that is more than half there: least and greatest corner, pixels.
fn extent(picture: &RgbaImage) -> ([f64; 2], [f64; 2]) {
    let seen = picture.enumerate_pixels().filter(|(_, _, p)| p.0[3] > 127);
    let (mut low, mut high) = ([f64::INFINITY; 2], [0.0_f64; 2]);
    for (x, y, _) in seen {
        let at = [f64::from(x), f64::from(y)];
        (0..2).for_each(|k| (low[k], high[k]) = (low[k].min(at[k]), high[k].max(at[k] + 1.0)));
    }
    (low, high)
}

/// The colour at a share of the way through the box around the picture.
fn colour_at(picture: &RgbaImage, share: [f64; 2]) -> [u8; 4] {
    let (low, high) = extent(picture);
    let at = [0, 1].map(|k| (low[k] + share[k] * (high[k] - low[k])) as u32);
    picture.get_pixel(at[0], at[1]).0
}

/// Mean difference of a channel, 0..=255.
fn difference(a: &RgbaImage, b: &RgbaImage) -> f64 {
    let sum: f64 = a.as_raw().iter().zip(b.as_raw()).map(|(a, b)| f64::from(a.abs_diff(*b))).sum();
    sum / a.as_raw().len() as f64
}

const SMALL: &str = "--resolution 24 --keys 2 --size 240x160";

#[test]
fn a_picture_at_rest_has_its_own_colours_and_outline() {
    let folder = tempfile::tempdir().unwrap();
    fields().save(folder.path().join("fields.png")).unwrap();
    let order = format!("fields.png --sphere 30,25,30,2 {SMALL} --transparent -o rest.png --still 0");
    if record(folder.path(), &order).is_none() {
        return;
    }
    let rest = open(folder.path(), "rest.png");
    let (low, high) = extent(&rest);
    let aspect = (high[0] - low[0]) / (high[1] - low[1]);
    assert!((aspect - 80.0 / 60.0).abs() < 0.03, "{low:?} {high:?}");
    for (k, wanted) in FIELDS.iter().enumerate() {
        let share = [0.25 + 0.5 * (k % 2) as f64, 0.25 + 0.5 * (k / 2) as f64];
        let found = colour_at(&rest, share);
        assert!(found[3] == 255 && (0..3).all(|c| found[c].abs_diff(wanted[c]) <= 1), "{k}: {found:?} {wanted:?}");
    }
    // Nothing of what is transparent shows at the edge: no field is as green as this.
    let fringe = rest.pixels().filter(|p| p.0[3] > 8 && i32::from(p.0[1]) > i32::from(p.0[0]) + 100).count();
    assert_eq!(fringe, 0);
    // Grown, the field around the disc is larger; where the others meet has moved.
    record(folder.path(), &order.replace("--still 0", "--still 1").replace("rest.png", "grown.png"));
    assert!(difference(&rest, &open(folder.path(), "grown.png")) > 2.0);
    // Sabotage: through the colour map the colours are not the picture's.
    record(folder.path(), &format!("{order} --view importance").replace("rest.png", "mapped.png"));
    let mapped = colour_at(&open(folder.path(), "mapped.png"), [0.75, 0.75]);
    assert!(mapped[2].abs_diff(FIELDS[3][2]) > 20, "{mapped:?}");
}

#[test]
fn fine_patterns_are_averaged_where_they_are_drawn_small() {
    let folder = tempfile::tempdir().unwrap();
    let checkers =
        RgbaImage::from_fn(512, 512, |x, y| if (x + y) % 2 == 0 { Rgba([255; 4]) } else { Rgba([0, 0, 0, 255]) });
    checkers.save(folder.path().join("checkers.png")).unwrap();
    let order = "checkers.png --resolution 16 --keys 1 --size 64x64 --transparent --still 0 -o small.png";
    if record(folder.path(), order).is_none() {
        return;
    }
    let small = open(folder.path(), "small.png");
    for pixel in middle(&small) {
        // Half of the light is 188 of 255 in sRGB.
        assert!(pixel.iter().all(|c| c.abs_diff(188) <= 6), "{pixel:?}");
    }
}

/// Pixels away from the rim.
fn middle(picture: &RgbaImage) -> impl Iterator<Item = [u8; 3]> + '_ {
    let (width, height) = picture.dimensions();
    let inner = |at: u32, side: u32| at > side / 6 && at < side - side / 6;
    let pixels = picture.enumerate_pixels().filter(move |(x, y, _)| inner(*x, width) && inner(*y, height));
    pixels.map(|(_, _, p)| [p.0[0], p.0[1], p.0[2]])
}

#[test]
fn each_view_shows_something_else_and_every_frame_is_proven() {
    let folder = tempfile::tempdir().unwrap();
    fields().save(folder.path().join("fields.png")).unwrap();
    let ids = RgbaImage::from_fn(100, 80, |x, y| {
        let inside = (10..90).contains(&x) && (10..70).contains(&y);
        let id = if inside { 1 + u8::from(x >= 50) + 2 * u8::from(y >= 40) } else { 0 };
        Rgba([id, id, id, 255])
    });
    image::DynamicImage::from(ids).to_luma8().save(folder.path().join("ids.png")).unwrap();
    std::fs::write(folder.path().join("worth.csv"), "region,value\n1,400\n2,100\n3,100\n4,100\n").unwrap();
    let scene = format!("fields.png --regions ids.png --values worth.csv --per-area {SMALL}");
    let mut seen: Vec<(String, RgbaImage)> = Vec::new();
    for view in ["plain", "importance", "classic", "compare", "voxels"] {
        let order = format!("{scene} --view {view} --legend --title Fields --still 1 -o {view}.png");
        if record(folder.path(), &order).is_none() {
            return;
        }
        let picture = open(folder.path(), &format!("{view}.png"));
        for (other, before) in &seen {
            assert!(difference(before, &picture) > 0.5, "{view} looks like {other}");
        }
        seen.push((view.into(), picture));
    }
    // A film of frames, twice: the same bits for any number of threads.
    let film = format!("{scene} --seconds 0.4 --fps 10 --hold 0");
    record(folder.path(), &format!("{film} --threads 1 -o one/"));
    record(folder.path(), &format!("{film} --threads 3 -o three/"));
    for k in 0..4 {
        let read = |name: &str| {
            let mut files: Vec<_> =
                std::fs::read_dir(folder.path().join(name)).unwrap().map(|e| e.unwrap().path()).collect();
            files.sort();
            assert_eq!(files.len(), 4);
            std::fs::read(&files[k]).unwrap()
        };
        assert!(read("one") == read("three"), "frame {k}");
    }
    let told = json(folder.path(), "one.json");
    assert_eq!(told["recording"]["certified"], true);
    assert_eq!(told["recording"]["settings"]["view"], "plain");
    let frames = told["recording"]["frames"].as_array().unwrap();
    assert!(frames.len() == 4 && frames.iter().all(|frame| frame["growth"]["certified"] == true));
    assert_eq!(told["report"]["areas"]["regions"].as_array().unwrap().len(), 4);
}

#[test]
fn a_picture_is_looked_at_straight_on() {
    let folder = tempfile::tempdir().unwrap();
    fields().save(folder.path().join("fields.png")).unwrap();
    for (options, said) in [
        ("--turntable 1", "--turntable is for bodies"),
        ("--camera 20,8", "--camera 0,0,ZOOM"),
        ("--attribute weight", "a picture has no vertices"),
    ] {
        let output = run(folder.path(), &format!("record fields.png {SMALL} {options} -o out.png --still 1 --quiet"));
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        if error.contains("Vulkan") {
            eprintln!("skipped: no Vulkan driver");
            return;
        }
        assert_eq!(output.status.code(), Some(2), "{options}: {error}");
        assert!(error.contains(said) && error.trim().lines().count() == 1, "{options}: {error}");
        assert!(!folder.path().join("out.png").exists());
    }
}

#[test]
fn inspect_tells_what_is_in_a_picture() {
    let folder = tempfile::tempdir().unwrap();
    fields().save(folder.path().join("fields.png")).unwrap();
    let output = run(folder.path(), "inspect fields.png --resolution 20");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(output.status.code(), Some(0), "{text}");
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    for line in ["100 × 80, 8 bits a channel", "4800 pixels, 60 % of all", "cell size 4 pixels", "cells 300"] {
        assert!(text.contains(line), "{line}: {text}");
    }
    let output = run(folder.path(), "inspect fields.png --resolution 20 --json");
    let told: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(told["picture"]["domain_pixels"], 4800);
    assert_eq!((&told["input"]["components"], &told["domain"]["cells"]), (&1.into(), &300.into()));
    assert_eq!(told["extents"]["max"][0], 90.0);
    // The keys of a mesh are all there.
    let output = run(folder.path(), "inspect gallery:hand --resolution 16 --json");
    let mesh: Value = serde_json::from_slice(&output.stdout).unwrap();
    for key in mesh.as_object().unwrap().keys() {
        assert!(told.get(key).is_some(), "{key}");
    }
    let output = run(folder.path(), "inspect gallery:africa");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("regions") && text.contains("Nigeria"), "{text}");
    for (order, said) in [
        ("inspect fields.png --resolution 600", "resolution 600"),
        ("inspect gallery:hand --background white,0.1", "--background is for pictures"),
        ("inspect fields.png --background white", "no tolerance"),
    ] {
        let output = run(folder.path(), order);
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && error.contains(said), "{order}: {error}");
    }
}
