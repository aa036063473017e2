//! Contract of the sandbox: pointer and keys do what the help says, importance changes where it is painted, what is saved
//! comes back, an error leaves what was open as it was. All of it without a window, by Bevy's own input messages; the real
//! window is looked at in `screens`.
#![cfg(feature = "window")]
#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

#[cfg(unix)]
mod beside;
mod comparing;
#[cfg(feature = "record")]
mod filming;
mod painting;
mod panels;
mod picture;
mod stage;

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use bevy::input::ButtonState;
use bevy::input::keyboard::Key;
use bevy::prelude::*;
use bevy::window::FileDragAndDrop;
use glam::DVec3;
use homunculus::app::play::{PointerOnPanel, Sandbox};
use homunculus::panel::{Asked, Tool, Wish};
use homunculus::scene::Source;
use homunculus::session::Phase;
use homunculus::view::{Looks, Mode, Orbit, VoxelColour};
use stage::{MIDDLE, PATIENCE, Stage, paint};

#[test]
fn a_stroke_changes_importance_under_the_pointer_and_undo_restores_the_bits() {
    let mut stage = Stage::hand();
    let before = stage.bits();
    paint(&mut stage);
    let after = stage.bits();
    let sandbox = stage.sandbox();
    let open = sandbox.open.as_ref().unwrap();
    assert_eq!(open.painting.edits().len(), 1, "{:?}", sandbox.problem);
    let homunculus::paint::Edit::Stroke { dabs, .. } = &open.painting.edits()[0] else { panic!("a stroke") };
    let boundary = &open.painting.under().boundary;
    let changed: Vec<usize> = (0..before.len()).filter(|&v| before[v] != after[v]).collect();
    assert!(changed.len() > 10);
    let is_near =
        |v: &usize| dabs.iter().any(|dab| DVec3::from_array(dab.centre).distance(boundary.positions[*v]) < dab.radius);
    assert!(changed.iter().all(is_near), "nothing else changes");
    stage.control("z", false);
    assert_eq!(stage.bits(), before);
    stage.control("z", true);
    assert_eq!(stage.bits(), after);
    stage.control("z", false);
    stage.control("y", false);
    assert_eq!(stage.bits(), after);
}

#[test]
fn sabotage_a_pointer_on_a_panel_paints_nothing() {
    let mut stage = Stage::hand();
    let before = stage.bits();
    stage.app.insert_resource(PointerOnPanel(true));
    paint(&mut stage);
    assert_eq!(stage.bits(), before);
    stage.app.insert_resource(PointerOnPanel(false));
    paint(&mut stage);
    assert_ne!(stage.bits(), before);
}

#[test]
fn escape_drops_the_stroke_and_a_drag_beside_the_surface_turns_the_view() {
    let mut stage = Stage::hand();
    let before = stage.bits();
    stage.key("b");
    stage.move_to(MIDDLE[0], MIDDLE[1]);
    stage.button(MouseButton::Left, ButtonState::Pressed);
    assert_ne!(stage.bits(), before);
    stage.press(Key::Escape);
    stage.move_to(650.0, 370.0);
    stage.button(MouseButton::Left, ButtonState::Released);
    assert_eq!(stage.bits(), before);
    let orbit = stage.orbit();
    stage.drag(MouseButton::Left, [8.0, 8.0], [60.0, 8.0]);
    assert_ne!(stage.orbit().yaw, orbit.yaw);
    assert_eq!(stage.bits(), before);
}

#[test]
fn painting_reaches_the_solver_and_ends_certified() {
    let mut stage = Stage::hand();
    stage.solved();
    let linear = stage.sandbox().snapshot.linear.clone().unwrap();
    // The middle of the grown hand may lie between two fingers; further down is the palm.
    stage.key("b");
    for y in [360.0, 440.0, 500.0, 560.0] {
        if stage.sandbox().open.as_ref().unwrap().painting.edits().is_empty() {
            stage.drag(MouseButton::Left, [640.0, y], [650.0, y]);
        }
    }
    assert_eq!(stage.sandbox().open.as_ref().unwrap().painting.edits().len(), 1, "a stroke on the grown hand");
    stage.wait("the linear solution", |s| !Arc::ptr_eq(s.snapshot.linear.as_ref().unwrap(), &linear));
    assert!(stage.sandbox().snapshot.dab_milliseconds.is_some());
    stage.solved();
    assert!(stage.sandbox().snapshot.outcome.as_ref().unwrap().certificate.certified());
}

#[test]
fn the_pointer_turns_moves_and_zooms() {
    let mut stage = Stage::hand();
    let start = stage.orbit();
    stage.drag(MouseButton::Left, MIDDLE, [700.0, 330.0]);
    let turned = stage.orbit();
    assert!(turned.yaw != start.yaw && turned.pitch != start.pitch && turned.target == start.target);
    stage.drag(MouseButton::Middle, MIDDLE, [700.0, 330.0]);
    let moved = stage.orbit();
    assert!(moved.target != turned.target && moved.yaw == turned.yaw);
    stage.wheel(2.0);
    assert!(stage.orbit().distance < moved.distance);
    stage.key("b");
    let before = stage.orbit();
    stage.drag(MouseButton::Right, MIDDLE, [700.0, 360.0]);
    assert_ne!(stage.orbit().yaw, before.yaw, "the right button turns while painting");
}

#[test]
fn each_key_does_what_the_help_says() {
    let mut stage = Stage::hand();
    stage.solved();
    stage.key("f");
    let framed = stage.orbit();
    stage.wheel(5.0);
    stage.key("f");
    assert_eq!(stage.orbit().distance, framed.distance);
    let angle = |orbit: Orbit| (orbit.yaw.to_degrees().round() as i32, orbit.pitch.to_degrees().round() as i32);
    for (key, plain, other) in [("1", (0, 0), (180, 0)), ("3", (90, 0), (-90, 0)), ("7", (0, 90), (0, -90))] {
        stage.key(key);
        assert_eq!(angle(stage.orbit()), plain, "{key}");
        stage.control(key, false);
        assert_eq!(angle(stage.orbit()), other, "Ctrl {key}");
    }
    let yaw = stage.orbit().yaw;
    stage.key("t");
    stage.app.update();
    assert!(stage.sandbox().choice.turntable && stage.orbit().yaw != yaw);
    stage.key("t");
    assert!(!stage.sandbox().choice.turntable);
    for (key, tool) in [("b", Tool::Paint), ("g", Tool::Fill), ("v", Tool::Orbit)] {
        stage.key(key);
        assert_eq!(stage.sandbox().choice.tool, tool);
    }
    let size = stage.sandbox().choice.brush_size;
    stage.key("]");
    assert!(stage.sandbox().choice.brush_size > size);
    stage.key("[");
    assert!((stage.sandbox().choice.brush_size - size).abs() < 1e-6);
    stage.key("?");
    assert!(stage.sandbox().choice.help);
    stage.press(Key::Escape);
    assert!(!stage.sandbox().choice.help);
    stage.press(Key::F1);
    assert!(stage.sandbox().choice.help);
    stage.press(Key::F1);
    stage.press(Key::F12);
    assert_eq!(stage.sandbox().screenshots.len(), 1);
}

#[test]
fn escape_closes_the_gallery_and_leaves_what_is_open() {
    let mut stage = Stage::hand();
    stage.sandbox().choice.gallery = true;
    stage.press(Key::Escape);
    let sandbox = stage.sandbox();
    assert!(!sandbox.choice.gallery && sandbox.open.is_some() && sandbox.snapshot.phase != Phase::Stopped);
}

#[test]
fn the_film_plays_and_scrubs() {
    let mut stage = Stage::hand();
    stage.solved();
    for lambda in [0.0, 0.1, 0.25, 0.6, 0.99] {
        stage.sandbox().choice.player.scrub(lambda);
        stage.app.update();
        assert!((stage.shown_lambda() - lambda).abs() < 1e-4, "{lambda}: {}", stage.shown_lambda());
    }
    stage.press(Key::Home);
    assert_eq!(stage.shown_lambda(), 0.0);
    stage.press(Key::ArrowRight);
    let first = stage.shown_lambda();
    assert!(stage.sandbox().snapshot.film.iter().any(|state| (state.lambda - first).abs() < 1e-4) && first > 0.0);
    stage.press(Key::ArrowLeft);
    assert!(stage.shown_lambda() < first);
    stage.press(Key::Space);
    assert!(stage.sandbox().choice.player.is_playing);
    let mut before = stage.shown_lambda();
    for _ in 0..10 {
        stage.app.update();
        let now = stage.shown_lambda();
        assert!(now >= before);
        before = now;
    }
    stage.press(Key::Space);
    assert!(!stage.sandbox().choice.player.is_playing && before > 0.0);
    stage.press(Key::End);
    assert_eq!(stage.sandbox().choice.player.lambda(), 1.0);
}

#[test]
fn what_is_saved_comes_back() {
    let mut stage = Stage::hand();
    paint(&mut stage);
    stage.wish(Wish::SetFidelity(0.3));
    let path = stage.path("painted.ron");
    assert!(stage.sandbox().open.as_ref().unwrap().is_changed());
    stage.wish(Wish::SaveTo(path.clone()));
    stage.calm();
    assert!(!stage.sandbox().open.as_ref().unwrap().is_changed());
    let (scene, bits) = (stage.sandbox().open.as_ref().unwrap().scene().unwrap(), stage.bits());
    stage.wish(Wish::Open(Source::Gallery("hand".into())));
    stage.wait("the hand", |s| s.open.as_ref().is_some_and(|open| open.file.is_none()));
    assert_ne!(stage.bits(), bits);
    stage.wish(Wish::OpenPath(path.clone()));
    stage.wait("the saved scene", |s| s.open.as_ref().is_some_and(|open| open.file.is_some()));
    assert_eq!(stage.bits(), bits);
    assert_eq!(stage.sandbox().open.as_ref().unwrap().scene().unwrap(), scene);
    assert_eq!(stage.sandbox().memory.recent().first().map(PathBuf::as_path), Some(path.as_path()));
}

#[test]
fn a_file_that_cannot_be_read_leaves_what_was_open() {
    let mut stage = Stage::hand();
    let broken = stage.path("broken.obj");
    std::fs::write(&broken, "v 0 0 0\nf 1 2 3\n").unwrap();
    let bits = stage.bits();
    stage.app.world_mut().write_message(FileDragAndDrop::DroppedFile { window: stage.window, path_buf: broken });
    stage.app.update();
    stage.wait("the sentence", |s| s.problem.is_some());
    let problem = stage.sandbox().problem.clone().unwrap();
    assert!(problem.contains("broken.obj") && !problem.contains('\n'), "{problem}");
    assert_eq!(stage.bits(), bits);
    stage.wish(Wish::Dismiss);
    assert!(stage.sandbox().problem.is_none());
    stage.wish(Wish::OpenPath(stage.path("nothing.xyz")));
    stage.wait("the sentence", |s| s.problem.is_some());
}

#[test]
fn layers_come_go_and_are_undone() {
    let mut stage = Stage::hand();
    let before = stage.bits();
    let table = stage.path("v.csv");
    std::fs::write(&table, "vertex,importance\n0,3\n1,3\n").unwrap();
    stage.wish(Wish::OpenPath(table));
    stage.calm();
    let with_layer = stage.bits();
    assert_ne!(with_layer, before, "{:?}", stage.sandbox().problem);
    assert!((f64::from_bits(with_layer[0]) - 3f64.ln()).abs() < 1e-6);
    stage.wish(Wish::ShowLayer(0, false));
    stage.calm();
    assert_eq!(stage.bits(), before);
    stage.wish(Wish::ShowLayer(0, true));
    stage.calm();
    assert_eq!(stage.bits(), with_layer);
    stage.wish(Wish::RemoveLayer(0));
    stage.calm();
    assert_eq!(stage.bits(), before);
    for expected in [&with_layer, &before, &with_layer, &before] {
        stage.control("z", false);
        assert_eq!(stage.bits(), *expected);
    }
}

#[test]
fn everything_the_command_line_writes_can_be_exported() {
    let mut stage = Stage::hand();
    stage.solved();
    let files = [
        (Asked::ExportMesh, "out.obj"),
        (Asked::ExportMesh, "out.glb"),
        (Asked::ExportGrowth, "growth.glb"),
        (Asked::ExportReport, "report.json"),
    ];
    for (asked, name) in files {
        let path = stage.path(name);
        stage.wish(Wish::Export(asked, path.clone()));
        stage.calm();
        assert!(path.is_file(), "{name}: {:?}", stage.sandbox().problem);
    }
    let report = std::fs::read_to_string(stage.path("report.json")).unwrap();
    assert!(report.contains("\"certified\": true"), "{report}");
}

#[test]
fn unsaved_work_is_there_after_a_crash() {
    let mut stage = Stage::hand();
    paint(&mut stage);
    let bits = stage.bits();
    stage.sandbox().autosave();
    stage.wait("the copy", |s| !s.awaits() || s.memory.autosave().is_some_and(|path| path.is_file()));
    stage.wait("the copy", |s| s.memory.autosave().is_some_and(|path| path.is_file()));
    // The program ends here without a word; another one starts.
    let mut next = Sandbox::new(Some(stage.path("memory"))).unwrap();
    assert!(next.memory.can_restore());
    next.wishes.push(Wish::Restore);
    let start = Instant::now();
    while next.open.is_none() {
        next.update();
        assert!(start.elapsed() < PATIENCE, "{:?}", next.problem);
    }
    let open = next.open.as_ref().unwrap();
    assert_eq!(open.painting.ln().iter().map(|ln| ln.to_bits()).collect::<Vec<_>>(), bits);
    assert!(open.is_changed() && open.file.is_none());
}

#[test]
fn other_settings_are_solved_again_and_escape_stops() {
    let mut stage = Stage::hand();
    stage.solved();
    let lattice = stage.sandbox().snapshot.lattice.clone().unwrap();
    // Fine enough that it is not solved before it can be stopped.
    stage.wish(Wish::SetResolution(96));
    stage.wait("the finer lattice", |s| s.snapshot.lattice.as_ref().is_some_and(|l| l.summary.resolution == 96));
    assert_ne!(lattice.summary.cells, stage.sandbox().snapshot.lattice.as_ref().unwrap().summary.cells);
    stage.press(Key::Escape);
    stage.wait("the stop", |s| !s.snapshot.phase.is_busy());
    assert_eq!(stage.sandbox().snapshot.phase, Phase::Stopped);
    stage.wish(Wish::Resume);
    stage.solved();
    stage.wish(Wish::SetFidelity(0.1));
    stage.wait("the new solve", |s| s.snapshot.phase.is_busy());
    stage.solved();
    assert_eq!(stage.sandbox().snapshot.outcome.as_ref().unwrap().fidelity.mu, 0.1);
    // What cannot be solved is refused in a sentence, and the scene stays as it was.
    stage.wish(Wish::SetResolution(7));
    let sandbox = stage.sandbox();
    assert!(sandbox.problem.as_ref().is_some_and(|problem| problem.contains('7')), "{:?}", sandbox.problem);
    assert_eq!(sandbox.open.as_ref().unwrap().settings().resolution, 96);
}

#[test]
fn each_mode_shows_its_field_with_a_legend() {
    let mut stage = Stage::hand();
    stage.solved();
    let modes = [
        (Mode::Plain, None),
        (Mode::Importance, Some("importance")),
        (Mode::Fidelity, Some("fidelity")),
        (Mode::Voxels(VoxelColour::Importance), Some("importance")),
        (Mode::Voxels(VoxelColour::Growth), Some("growth")),
    ];
    for (mode, title) in modes {
        stage.sandbox().choice.mode = mode;
        stage.app.update();
        stage.app.update();
        let looks = stage.app.world_mut().query::<&Looks>().single(stage.app.world()).unwrap();
        assert_eq!((looks.mode, looks.legend().map(|legend| legend.title)), (mode, title));
    }
}

#[test]
fn where_jumps_to_a_place_and_parallels_stay_parallel() {
    let mut stage = Stage::hand();
    let place = stage.sandbox().open.as_ref().unwrap().painting.under().boundary.positions[17];
    stage.wish(Wish::LookAt(place));
    let boundary = stage.sandbox().open.as_ref().unwrap().painting.under().boundary.clone();
    let expected = homunculus::view::ViewFrame::of(&boundary).world_from_source(place);
    assert!(stage.orbit().target.distance(expected) < 1e-5);
    assert!(!stage.orbit().orthographic);
    stage.sandbox().choice.orthographic = true;
    stage.app.update();
    assert!(stage.orbit().orthographic);
}

#[test]
fn files_that_are_dropped_are_taken_for_what_they_are() {
    let mut stage = Stage::hand();
    let drop = |stage: &mut Stage, path: PathBuf| {
        stage.app.world_mut().write_message(FileDragAndDrop::DroppedFile { window: stage.window, path_buf: path });
        stage.app.update();
        stage.calm();
    };
    let table = stage.path("v.csv");
    std::fs::write(&table, "vertex,importance\n0,3\n").unwrap();
    drop(&mut stage, table);
    assert_eq!(stage.sandbox().open.as_ref().unwrap().draft().layers.len(), 1, "{:?}", stage.sandbox().problem);
    let mesh = stage.path("t.obj");
    std::fs::write(&mesh, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n").unwrap();
    drop(&mut stage, mesh.clone());
    assert_eq!(*stage.sandbox().open.as_ref().unwrap().source(), Source::File(mesh));
    let scene = stage.path("hand.ron");
    drop(&mut stage, scene.clone());
    assert_eq!(stage.sandbox().open.as_ref().unwrap().file, Some(scene));
}
