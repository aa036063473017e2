//! Eq. 1 alone beside the certified growth, and as a wipe; what crosses is marked; reference shapes have names.

use std::collections::BTreeSet;

use bevy::prelude::*;
use homunculus::app::play::{Classic, Shown, Viewport};
use homunculus::paint::{Edit, Fill};
use homunculus::panel::Compare;
use homunculus::view::{Body, Looks, Mode, Placement, SizeLegend, Wipe};

use super::stage::Stage;

fn bodies(stage: &mut Stage) -> usize {
    stage.app.world_mut().query::<&Body>().iter(stage.app.world()).count()
}

/// Looks and place of the classic body, then of the certified one.
fn both(stage: &mut Stage) -> [(Looks, Placement); 2] {
    let world = stage.app.world_mut();
    let classic = world.query_filtered::<(&Looks, &Placement), With<Classic>>().single(world).unwrap();
    let classic = (classic.0.clone(), *classic.1);
    let world = stage.app.world_mut();
    let shown = world.query_filtered::<(&Looks, &Placement), With<Shown>>().single(world).unwrap();
    [classic, (shown.0.clone(), *shown.1)]
}

fn compare(stage: &mut Stage, how: Compare) {
    stage.sandbox().choice.compare = how;
    stage.app.update();
    stage.app.update();
}

#[test]
fn the_classic_solution_stands_beside() {
    let mut stage = Stage::hand();
    compare(&mut stage, Compare::SideBySide);
    assert_eq!(bodies(&mut stage), 2);
    let [(_, classic), (_, certified)] = both(&mut stage);
    assert!(classic.offset.x < 0.0 && certified.offset.x == -classic.offset.x);
    compare(&mut stage, Compare::Off);
    assert_eq!(bodies(&mut stage), 1);
}

#[test]
fn the_wipe_shows_one_on_each_side_of_its_line() {
    let mut stage = Stage::hand();
    compare(&mut stage, Compare::Wipe);
    stage.sandbox().choice.wipe = 0.3;
    stage.app.update();
    let [(classic, left), (certified, right)] = both(&mut stage);
    assert_eq!(classic.wipe, Some(Wipe { at: 0.3, keeps_left: true }));
    assert_eq!(certified.wipe, Some(Wipe { at: 0.3, keeps_left: false }));
    assert_eq!(left, right, "both stand in one place");
    compare(&mut stage, Compare::SideBySide);
    assert!(both(&mut stage).iter().all(|(looks, _)| looks.wipe.is_none()));
}

#[test]
fn what_crosses_in_the_classic_solution_is_marked_and_only_there() {
    let mut stage = Stage::hand();
    stage.solved();
    let counts = stage.sandbox().snapshot.outcome.as_ref().unwrap().classic.unwrap();
    assert!(counts.crossings > 0, "the hand's fingers cross in Eq. 1");
    compare(&mut stage, Compare::SideBySide);
    stage.wait("the marks", |s| s.marked().is_some() && !s.awaits());
    stage.app.update();
    let [(classic, _), (certified, _)] = both(&mut stage);
    let marked = classic.marked.clone().unwrap();
    assert!(!marked.is_empty() && certified.marked.is_none());
    assert_eq!((classic.mode, certified.mode), (Mode::Plain, Mode::Importance), "red tells on grey alone");

    // At rest nothing crosses.
    stage.sandbox().choice.player.scrub(0.0);
    stage.wait("the marks at rest", |s| s.marked().is_some_and(|marked| marked.is_empty()));

    // Each mark is near a crossing: the triangles marked are those of the cells concerned, not all of the hand.
    let boundary = stage.sandbox().snapshot.lattice.as_ref().unwrap().boundary.clone();
    assert!(marked.len() < boundary.triangles.len() / 2, "{} of {}", marked.len(), boundary.triangles.len());
    let unique: BTreeSet<u32> = marked.iter().copied().collect();
    assert_eq!(unique.len(), marked.len());
    assert!(marked.iter().all(|t| (*t as usize) < boundary.triangles.len()));
}

#[test]
fn sabotage_without_importance_nothing_is_marked() {
    // Over the hand's own importance.
    let even = Edit::Fill(Fill::All { value: 1.0 });
    let mut stage = Stage::of(|draft| draft.strokes = vec![even]);
    stage.solved();
    assert_eq!(stage.sandbox().snapshot.outcome.as_ref().unwrap().classic.unwrap().crossings, 0);
    compare(&mut stage, Compare::SideBySide);
    stage.wait("the marks", |s| s.marked().is_some() && !s.awaits());
    assert!(stage.sandbox().marked().unwrap().is_empty());
}

#[test]
fn reference_shapes_are_in_sight_with_their_names() {
    let mut stage = Stage::hand();
    stage.solved();
    stage.sandbox().choice.size_legend = true;
    stage.app.update();
    stage.key("f");
    stage.app.update();
    let sizes = *stage.app.world_mut().query::<&SizeLegend>().single(stage.app.world()).unwrap();
    let names: Vec<&str> = sizes.labels().iter().map(|(_, name)| *name).collect();
    assert_eq!(names, ["×½", "×1", "×2", "×4"]);
    let (orbit, viewport) = (stage.orbit(), *stage.app.world().resource::<Viewport>());
    let aspect = viewport.size.x / viewport.size.y;
    for (at, name) in sizes.labels() {
        let seen = orbit.seen(at).unwrap();
        assert!(seen.x.abs() < 0.5 * aspect && seen.y.abs() < 0.5, "{name} is seen at {seen}");
    }
    stage.sandbox().choice.size_legend = false;
    stage.app.update();
    stage.app.update();
    assert!(stage.app.world_mut().query::<&SizeLegend>().iter(stage.app.world()).next().is_none());
}
