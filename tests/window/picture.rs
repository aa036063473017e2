//! Contract of the sandbox with a picture open: the camera looks straight on, strokes land where the pointer is and are
//! solved as the command line solves them, results are written as it writes them, and another picture dropped opens.

use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use bevy::prelude::*;
use bevy::window::FileDragAndDrop;
use glam::DVec3;
use homunculus::app::play::Shown;
use homunculus::certificate::Places;
use homunculus::certificate::{Shell, Surfaces};
use homunculus::importance::{Layer, Offered};
use homunculus::paint::{Edit, Fill};
use homunculus::panel::{Asked, Compare, Wish};
use homunculus::scene::{Draft, Scene, Source};
use homunculus::session::{Lattice, Phase};
use homunculus::transfer::Binding;
use homunculus::view::{Looks, Mode};
use image::{Rgba, RgbaImage};

use super::stage::{MIDDLE, PATIENCE, Stage};

impl Stage {
    /// With a picture of two halves open, its lattice there.
    fn open() -> Self {
        let mut stage = Self::empty();
        let halves = RgbaImage::from_fn(96, 64, |x, _| Rgba([if x < 48 { 220 } else { 40 }, 90, 60, 255]));
        halves.save(stage.path("halves.png")).unwrap();
        let ids = image::GrayImage::from_fn(96, 64, |x, _| image::Luma([1 + u8::from(x >= 48)]));
        ids.save(stage.path("ids.png")).unwrap();
        std::fs::write(stage.path("people.csv"), "region,value,name\n1,300,left\n2,100,right\n").unwrap();
        let mut draft = Draft::of(Source::File(stage.path("halves.png")));
        (draft.resolution, draft.fidelity, draft.keys) = (24, 1.0, 2);
        Scene::new(draft).unwrap().save(&stage.path("halves.ron")).unwrap();
        stage.wish(Wish::OpenPath(stage.path("halves.ron")));
        stage.wait("the lattice", |s| s.open.is_some() && s.snapshot.lattice.is_some());
        stage.app.update();
        stage
    }

    /// Solved for an importance that reaches from ×1 or less to this, about: what the solver has not been told yet does not
    /// count.
    fn solved_for(&mut self, largest: std::ops::Range<f32>) {
        self.wait("the end of the solve for what was asked", |s| {
            let asked = s.snapshot.importance.as_ref().map_or(0.0, |f| f.iter().copied().fold(0.0, f32::max));
            largest.contains(&asked) && s.snapshot.phase == Phase::Done && !s.awaits()
        });
        self.app.update();
    }

    fn drop_file(&mut self, path: &Path) {
        let message = FileDragAndDrop::DroppedFile { window: self.window, path_buf: path.into() };
        self.app.world_mut().write_message(message);
        self.app.update();
        self.app.update();
    }

    fn looks(&mut self) -> Looks {
        self.app.world_mut().query_filtered::<&Looks, With<Shown>>().single(self.app.world()).unwrap().clone()
    }

    fn paint(&mut self) {
        self.key("b");
        self.drag(MouseButton::Left, MIDDLE, [660.0, 360.0]);
        self.key("v");
    }
}

#[test]
fn the_camera_looks_straight_on_and_a_drag_moves_the_picture() {
    let mut stage = Stage::open();
    let start = stage.orbit();
    assert!(start.orthographic && (start.yaw, start.pitch) == (0.0, 0.0), "{start:?}");
    assert_eq!(stage.sandbox().choice.mode, Mode::Plain, "a picture is shown as it is");
    for button in [MouseButton::Left, MouseButton::Right, MouseButton::Middle] {
        let before = stage.orbit();
        stage.drag(button, MIDDLE, [700.0, 330.0]);
        let after = stage.orbit();
        assert!(after.target != before.target && (after.yaw, after.pitch) == (0.0, 0.0), "{button:?}");
    }
    for key in ["3", "7", "t"] {
        stage.key(key);
        stage.app.update();
        assert_eq!((stage.orbit().yaw, stage.orbit().pitch), (0.0, 0.0), "{key}");
    }
    stage.key("t");
    // A body after it is looked at from the side again, in the colours of its importance.
    stage.wish(Wish::Open(Source::Gallery("hand".into())));
    stage.wait("the hand", |s| s.open.as_ref().is_some_and(|open| !open.is_flat()));
    stage.app.update();
    stage.app.update();
    assert!(!stage.orbit().orthographic && stage.orbit().yaw != 0.0);
    assert_eq!(stage.sandbox().choice.mode, Mode::Importance);
}

#[test]
fn a_stroke_lands_under_the_pointer_is_seen_at_once_and_ends_certified() {
    let mut stage = Stage::open();
    stage.solved();
    let (before, linear) = (stage.bits(), stage.sandbox().snapshot.linear.clone().unwrap());
    stage.paint();
    let after = stage.bits();
    let sandbox = stage.sandbox();
    let painting = &sandbox.open.as_ref().unwrap().painting;
    let [Edit::Stroke { dabs, .. }] = painting.edits() else { panic!("one stroke: {:?}", sandbox.problem) };
    // The view's middle is the picture's, to a few pixels.
    let first = DVec3::from_array(dabs[0].centre);
    assert!(first.distance(DVec3::new(48.0, 32.0, 0.0)) < 4.0, "{first}");
    let positions = &painting.under().boundary.positions;
    let changed: Vec<usize> = (0..before.len()).filter(|&v| before[v] != after[v]).collect();
    let is_near = |v: &usize| dabs.iter().any(|dab| DVec3::from_array(dab.centre).distance(positions[*v]) < dab.radius);
    assert!(changed.len() > 10 && changed.iter().all(is_near), "nothing else changes");
    stage.wait("the linear solution", |s| !std::sync::Arc::ptr_eq(s.snapshot.linear.as_ref().unwrap(), &linear));
    assert!(stage.sandbox().snapshot.dab_milliseconds.is_some());
    stage.solved_for(1.1..3.0);
    let snapshot = stage.sandbox().snapshot.clone();
    assert!(snapshot.outcome.as_ref().unwrap().certificate.certified());
    let largest = |values: &[f32]| values.iter().copied().fold(0.0, f32::max);
    // What is shown on the picture is what was painted, at the vertices it is drawn on.
    let shown = stage.looks().importance.unwrap();
    assert_eq!(shown.len(), snapshot.lattice.as_ref().unwrap().boundary.positions.len());
    assert!(largest(&shown) > 1.3, "{}", largest(&shown));
    stage.wish(Wish::Undo);
    assert!(stage.bits() == before, "undo restores the bits");
    // Nothing is asked for any more.
    stage.solved_for(0.999_999..1.000_001);
}

#[test]
fn what_is_saved_and_written_is_what_the_command_line_makes_of_it() {
    let mut stage = Stage::open();
    stage.wish(Wish::SetResolution(20));
    stage.paint();
    stage.solved_for(1.1..3.0);
    stage.wish(Wish::SaveTo(stage.path("saved.ron")));
    stage.calm();
    for (asked, name) in [
        (Asked::ExportMesh, "window.png"),
        (Asked::ExportGrowth, "growth.gif"),
        (Asked::ExportGrowth, "growth.apng"),
        (Asked::ExportGrowth, "growth.glb"),
        (Asked::ExportReport, "report.json"),
    ] {
        stage.sandbox().choice.export.seconds = 0.3;
        stage.wish(Wish::Export(asked, stage.path(name)));
        stage.calm();
        assert_eq!(stage.sandbox().problem, None);
        assert!(stage.path(name).is_file(), "{name}");
    }
    let order = ["warp", "saved.ron", "-o", "line.png", "--report", "line.json", "--quiet"];
    let output =
        Command::new(env!("CARGO_BIN_EXE_homunculus")).args(order).current_dir(stage.folder.path()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let read = |name: &str| image::open(stage.folder.path().join(name)).unwrap().to_rgba8();
    let (window, line, rest) = (read("window.png"), read("line.png"), read("halves.png"));
    assert_eq!(window.dimensions(), line.dimensions());
    let apart = |a: &RgbaImage, b: &RgbaImage| {
        let (width, height) = (a.width().min(b.width()), a.height().min(b.height()));
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let sum: u64 = pixels.map(|(x, y)| u64::from(a.get_pixel(x, y).0[0].abs_diff(b.get_pixel(x, y).0[0]))).sum();
        sum as f64 / f64::from(width * height)
    };
    assert!(apart(&window, &line) < 0.5, "{}", apart(&window, &line));
    // Sabotage: without the stroke it is another picture.
    assert!(apart(&window, &rest) > 0.5, "{}", apart(&window, &rest));
    // A name that says something else is refused, and nothing is written.
    stage.wish(Wish::Export(Asked::ExportMesh, stage.path("window.obj")));
    stage.calm();
    assert!(stage.sandbox().problem.as_ref().unwrap().contains(".png"));
    assert!(!stage.path("window.obj").exists());
}

#[test]
fn regions_become_area_and_what_is_dropped_is_recognised() {
    let mut stage = Stage::open();
    // A column `value` is a statistic: it becomes area.
    let (regions, values) = (stage.path("ids.png"), stage.path("people.csv"));
    stage.wish(Wish::Choose(Asked::Layer(Offered::Regions), vec![regions.clone(), values.clone()]));
    stage.wait("the layer", |s| s.open.as_ref().is_some_and(|open| !open.draft().layers.is_empty()));
    let layer = Layer::Regions { regions, values, per_area: true };
    assert_eq!(stage.sandbox().open.as_ref().unwrap().draft().layers, [layer]);
    stage.solved_for(1.1..3.0);
    assert_eq!(stage.sandbox().problem, None);
    stage.wish(Wish::Export(Asked::ExportReport, stage.path("report.json")));
    stage.calm();
    let told: serde_json::Value = serde_json::from_slice(&std::fs::read(stage.path("report.json")).unwrap()).unwrap();
    let regions = told["areas"]["regions"].as_array().unwrap();
    let area = |k: usize| regions[k]["achieved"].as_f64().unwrap();
    assert!((area(0) / area(1) - 3.0).abs() < 0.15, "{} {}", area(0), area(1));
    // Filling by name, and back.
    let before = stage.bits();
    stage.wish(Wish::Fill(Fill::Region { name: "right".into(), value: 2.0 }));
    assert!(stage.bits() != before, "{:?}", stage.sandbox().problem);
    stage.wish(Wish::Undo);
    assert!(stage.bits() == before, "undo restores the bits");
    stage.wish(Wish::Undo);
    assert!(stage.bits() != before, "the layer is taken back too");

    // A table means nothing on a picture by itself; what is open stays.
    stage.drop_file(&stage.path("people.csv"));
    stage.calm();
    assert!(stage.sandbox().problem.take().unwrap().contains("a picture has no vertices"));
    assert!(stage.sandbox().open.as_ref().unwrap().title().contains("halves"));
    // A damaged picture too.
    std::fs::write(stage.path("cut.png"), &std::fs::read(stage.path("ids.png")).unwrap()[..60]).unwrap();
    stage.drop_file(&stage.path("cut.png"));
    stage.calm();
    assert!(stage.sandbox().problem.take().unwrap().contains("cut.png"));
    assert!(stage.sandbox().open.as_ref().unwrap().title().contains("halves"));
    // A whole one opens.
    stage.drop_file(&stage.path("ids.png"));
    stage.wait("the other picture", |s| s.open.as_ref().is_some_and(|open| open.title() == "ids.png"));
    assert!(stage.sandbox().open.as_ref().unwrap().is_flat());
}

#[test]
fn while_it_grows_a_picture_is_drawn_as_it_will_be_written() {
    let mut stage = Stage::empty();
    // Its teeth grow abruptly: where it follows its nodes smoothly it turns over.
    stage.wish(Wish::Open(Source::Gallery("crocodile".into())));
    let (mut version, mut looked, mut smooth_is_inverted) = (0, 0, false);
    let start = Instant::now();
    loop {
        stage.app.update();
        let snapshot = stage.sandbox().snapshot.clone();
        assert!(start.elapsed() < PATIENCE, "{:?} {:?}", snapshot.phase, snapshot.error);
        let states = snapshot.lattice.as_ref().zip(snapshot.film.last());
        if let Some((lattice, last)) = states.filter(|_| snapshot.version != version) {
            let Lattice { boundary, complex, binding, .. } = lattice;
            let inverted =
                |binding: Binding| Shell::boundary(boundary, binding.into(), complex).inverted(&last.positions);
            assert_eq!(inverted((**binding).clone()), [0; 0], "at λ {}", last.lambda);
            // Sabotage: drawn as at first it would be.
            smooth_is_inverted |= !inverted(Binding::new(boundary, complex)).is_empty();
            looked += 1;
        }
        version = snapshot.version;
        if snapshot.phase == Phase::Done {
            break;
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    assert!(looked > 2 && smooth_is_inverted, "{looked} states");
}

#[test]
fn crossings_of_a_picture_are_marked_as_wide_as_in_films() {
    let mut stage = Stage::empty();
    stage.wish(Wish::Open(Source::Gallery("magnet".into())));
    stage.solved_for(1.1..30.0);
    stage.sandbox().choice.compare = Compare::SideBySide;
    stage.wait("the marks", |s| s.marked().is_some() && !s.awaits());
    let marked = stage.sandbox().marked().unwrap();
    let snapshot = stage.sandbox().snapshot.clone();
    let Lattice { boundary, complex, binding, .. } = snapshot.lattice.clone().unwrap();
    let linear = snapshot.linear.clone().unwrap();
    let surfaces = Surfaces::new(&boundary, binding.clone(), &complex);
    let places = Places::new(&boundary, &complex);
    assert_eq!(*marked, places.to_be_seen(&complex, &surfaces, &linear), "what a film marks");
    let bare = places.faulty(&complex, &surfaces, &linear);
    assert!(marked.len() > 4 * bare.len() && !bare.is_empty(), "{} of {}", marked.len(), bare.len());
}
