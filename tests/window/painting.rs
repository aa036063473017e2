//! Painting by pointer and keys: through the ghost and while it grows, fills, mirrors, and the way back.

use bevy::input::ButtonState;
use bevy::prelude::*;
use homunculus::paint::{Axis, Edit, Fill};
use homunculus::panel::{Tool, Wish};
use homunculus::session::Phase;
use homunculus::view::Cursor;

use super::stage::{MIDDLE, Stage, paint};

fn edits(stage: &mut Stage) -> Vec<Edit> {
    stage.sandbox().open.as_ref().unwrap().painting.edits().to_vec()
}

/// `[vertices]` importance.
fn importance(stage: &mut Stage) -> Vec<f32> {
    stage.sandbox().open.as_ref().unwrap().painting.importance()
}

fn click(stage: &mut Stage, [x, y]: [f32; 2]) {
    stage.move_to(x, y);
    stage.button(MouseButton::Left, ButtonState::Pressed);
    stage.button(MouseButton::Left, ButtonState::Released);
}

fn cursor(stage: &mut Stage) -> Option<Cursor> {
    stage.app.world_mut().query::<&Cursor>().iter(stage.app.world()).next().cloned()
}

/// The hand at half its size, solved: its ghost stands out all around it.
fn shrunk() -> Stage {
    let mut stage = Stage::of(|draft| {
        draft.strokes = vec![Edit::Fill(Fill::All { value: 0.5 })];
        draft.fidelity = 1.0;
    });
    stage.solved();
    stage.key("b");
    stage
}

/// A place of the view where only the ghost is.
fn beside_the_surface(stage: &mut Stage) -> [f32; 2] {
    for y in (100..700).step_by(20) {
        for x in (300..1000).step_by(20) {
            let place = [x as f32, y as f32];
            stage.sandbox().choice.ghost = false;
            stage.move_to(place[0], place[1]);
            let is_on_surface = cursor(stage).is_some();
            stage.sandbox().choice.ghost = true;
            stage.move_to(place[0] + 0.25, place[1]);
            if !is_on_surface && cursor(stage).is_some() {
                return place;
            }
        }
    }
    panic!("the ghost is nowhere to be seen");
}

#[test]
fn the_ghost_can_be_painted_where_the_surface_has_gone() {
    let mut stage = shrunk();
    let place = beside_the_surface(&mut stage);
    stage.sandbox().choice.ghost = false;
    click(&mut stage, place);
    assert_eq!(edits(&mut stage).len(), 1, "without the ghost there is nothing there");
    stage.sandbox().choice.ghost = true;
    click(&mut stage, place);
    let [_, Edit::Stroke { dabs, .. }] = &edits(&mut stage)[..] else { panic!("one stroke over the fill") };
    // The dab is on the rest shape, where the ghost was touched.
    let sandbox = stage.sandbox();
    let boundary = &sandbox.open.as_ref().unwrap().painting.under().boundary;
    let centre = glam::DVec3::from_array(dabs[0].centre);
    let nearest = boundary.positions.iter().map(|p| p.distance(centre)).fold(f64::INFINITY, f64::min);
    assert!(nearest < dabs[0].radius, "{nearest}");
}

#[test]
fn it_can_be_painted_while_it_grows() {
    let mut stage = Stage::of(|draft| draft.resolution = 32);
    stage.wait("growth", |s| s.snapshot.phase == Phase::Growing && s.snapshot.warped.is_some());
    let before = stage.bits();
    stage.sandbox().choice.ghost = true;
    paint(&mut stage);
    assert_ne!(stage.bits(), before);
    assert_eq!(edits(&mut stage).len(), 1);
    stage.wait("the linear solution", |s| s.snapshot.dab_milliseconds.is_some());
    // And while the film plays.
    stage.solved();
    stage.press(bevy::input::keyboard::Key::Space);
    stage.app.update();
    assert!(stage.sandbox().choice.player.is_playing);
    paint(&mut stage);
    assert_eq!(edits(&mut stage).len(), 2);
}

#[test]
fn the_brush_is_seen_where_it_paints_and_mirrored() {
    let mut stage = Stage::hand();
    stage.move_to(MIDDLE[0], MIDDLE[1]);
    assert_eq!(cursor(&mut stage), None, "the view's tool has no brush");
    stage.key("b");
    stage.move_to(MIDDLE[0] + 1.0, MIDDLE[1]);
    stage.app.update();
    let plain = cursor(&mut stage).unwrap();
    assert!(plain.at.is_some() && plain.radius > 0.0 && plain.mirrored.is_empty());
    stage.key("]");
    stage.app.update();
    assert!(cursor(&mut stage).unwrap().radius > plain.radius);
    stage.sandbox().choice.brush.mirror = [true, false, false];
    stage.app.update();
    let mirrored = cursor(&mut stage).unwrap();
    assert_eq!(mirrored.mirrored.len(), 1);
    assert!((mirrored.mirrored[0].x + mirrored.at.unwrap().x).abs() < 1e-4, "{mirrored:?}");
    stage.move_to(4.0, 4.0);
    stage.app.update();
    assert_eq!(cursor(&mut stage), None, "beside the surface there is nothing to paint");
}

#[test]
fn a_mirrored_stroke_paints_both_sides() {
    let changed = |mirror: [bool; 3]| {
        let mut stage = Stage::hand();
        stage.sandbox().choice.brush.mirror = mirror;
        let before = stage.bits();
        stage.key("b");
        // The middle may lie between two fingers; further down is the palm.
        for y in [360.0, 440.0, 500.0, 560.0] {
            if edits(&mut stage).is_empty() {
                click(&mut stage, [640.0, y]);
            }
        }
        let after = stage.bits();
        let sandbox = stage.sandbox();
        let boundary = &sandbox.open.as_ref().unwrap().painting.under().boundary;
        let (low, high) = boundary.bounds().unwrap();
        let sides: Vec<bool> = (0..before.len())
            .filter(|&v| before[v] != after[v])
            .map(|v| boundary.positions[v].z > 0.5 * (low.z + high.z))
            .collect();
        [sides.iter().filter(|front| **front).count(), sides.iter().filter(|front| !**front).count()]
    };
    let ([front, back], [both_front, both_back]) = (changed([false; 3]), changed([false, false, true]));
    assert!(front > back, "{front} {back}: the pointer meets the front");
    assert!(both_back > back && both_front >= front, "{both_front} {both_back}");
}

#[test]
fn fills_reach_what_they_name() {
    let mut stage = Stage::hand();
    let before = stage.bits();
    stage.sandbox().choice.fill_value = 1.7;
    stage.key("g");
    assert_eq!(stage.sandbox().choice.tool, Tool::Fill);
    click(&mut stage, MIDDLE);
    stage.app.update();
    assert!(matches!(edits(&mut stage)[..], [Edit::Fill(Fill::Connected { .. })]));
    assert!(importance(&mut stage).iter().all(|f| (f - 1.7).abs() < 1e-5), "the hand hangs together");
    stage.control("z", false);
    assert_eq!(stage.bits(), before);

    let region = stage.sandbox().open.as_ref().unwrap().painting.canvas().region_names().first().cloned();
    if let Some(name) = region {
        stage.wish(Wish::Fill(Fill::Region { name, value: 2.5 }));
        let filled = importance(&mut stage).iter().filter(|f| (**f - 2.5).abs() < 1e-5).count();
        assert!(filled > 0 && filled < before.len());
    }
    stage.wish(Wish::Fill(Fill::Gradient { axis: Axis::Y, from: 0.5, to: 2.0 }));
    let values = importance(&mut stage);
    let sandbox = stage.sandbox();
    let boundary = &sandbox.open.as_ref().unwrap().painting.under().boundary;
    let end = |pick: fn(f64, f64) -> bool| {
        let first =
            (0..values.len()).reduce(|a, b| if pick(boundary.positions[b].y, boundary.positions[a].y) { b } else { a });
        values[first.unwrap()]
    };
    assert!((end(|a, b| a < b) - 0.5).abs() < 1e-4 && (end(|a, b| a > b) - 2.0).abs() < 1e-4);
    // What is not there is refused, and nothing changes.
    let bits = stage.bits();
    stage.wish(Wish::Fill(Fill::Region { name: "tail".into(), value: 2.0 }));
    assert!(stage.sandbox().problem.as_ref().is_some_and(|problem| problem.contains("tail")));
    assert_eq!(stage.bits(), bits);
}

#[test]
fn a_hundred_strokes_are_undone_and_done_again() {
    let mut stage = Stage::hand();
    stage.key("b");
    let mut seen = vec![stage.bits()];
    for k in 0..100 {
        let (x, y) = ((k % 10) as f32, (k / 10) as f32);
        click(&mut stage, [612.0 + 6.0 * x, 420.0 + 6.0 * y]);
        seen.push(stage.bits());
    }
    assert_eq!(edits(&mut stage).len(), 100, "each click met the hand");
    for before in seen.iter().rev().skip(1) {
        stage.control("z", false);
        assert_eq!(stage.bits(), *before);
    }
    assert!(edits(&mut stage).is_empty());
    for after in &seen[1..] {
        stage.control("z", true);
        assert_eq!(stage.bits(), *after);
    }
}
