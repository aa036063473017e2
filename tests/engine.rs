//! The engine as other programs use it: domains side by side, stages that are replaced, importance that changes.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

use std::sync::Arc;

use bevy::prelude::*;
use glam::{DVec3, Mat3A, Quat, Vec3A};
use homunculus::{
    collision::{CellEnergy, Mixture, plugin::CollisionPlugin},
    prelude::*,
};

const SETTINGS: Settings = Settings { resolution: 12, fidelity: 0.5, keys: 2, reference: None };

/// A bar three times as long as wide.
fn bar() -> Boundary {
    let corner = |k: u32| DVec3::new(f64::from(k & 1), f64::from(k >> 1 & 1), 3.0 * f64::from(k >> 2));
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Boundary::from_triangles("bar", (0..8).map(corner).collect(), triangles)
}

/// One end of it grows.
fn growing(value: f32) -> Domain {
    let boundary = bar();
    let importance: Vec<f32> = boundary.positions.iter().map(|p| if p.z > 1.5 { value } else { 1.0 }).collect();
    let importance = Stack::of_vertices(&importance, Vec::new(), 0);
    Domain::body(Arc::new(boundary), Arc::new(importance), SETTINGS)
}

/// All of its triangles lie in one point.
fn without_extent() -> Domain {
    let boundary = Boundary::from_triangles("point", vec![DVec3::ONE; 3], vec![[0, 1, 2]]);
    Domain::body(Arc::new(boundary), Arc::default(), SETTINGS)
}

fn app(stages: impl PluginGroup) -> App {
    let mut app = App::new();
    app.add_plugins(stages);
    app.finish();
    app.cleanup();
    app
}

/// Runs the schedule until a domain has settled; what it has become.
fn settle(app: &mut App, domain: Entity) -> Vec<Vec3A> {
    for _ in 0..2000 {
        app.world_mut().run_schedule(Solve);
        assert!(app.world().get::<Failed>(domain).is_none());
        if app.world().get::<Growing>(domain).is_some_and(|growing| growing.0.done()) {
            return app.world().get::<Warped>(domain).unwrap().0.clone();
        }
    }
    panic!("it does not settle");
}

#[test]
fn a_domain_that_fails_does_not_stop_others() {
    let mut alone = app(SolvePlugins);
    let domain = growing(2.0).spawn(alone.world_mut());
    let expected = settle(&mut alone, domain);

    let mut app = app(SolvePlugins);
    let failing = without_extent().spawn(app.world_mut());
    let domain = growing(2.0).spawn(app.world_mut());
    let other = growing(0.5).spawn(app.world_mut());
    assert_eq!(settle(&mut app, domain), expected, "its neighbours change nothing");
    assert!(settle(&mut app, other) != expected);
    let Failed(error) = app.world().get(failing).expect("it failed");
    assert!(error.to_string().contains("no extent"), "{error}");
    assert!(app.world().get::<Growing>(failing).is_none());
}

#[test]
fn an_app_of_ones_own_solves_a_domain_that_a_system_has_spawned() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, HomunculusPlugins));
    app.add_systems(Startup, |mut commands: Commands| {
        growing(2.0).spawn_later(&mut commands);
    });
    let mut domains = app.world_mut().query::<(&Growing, &Warped)>();
    for _ in 0..2000 {
        app.update();
        if let Ok((growing, warped)) = domains.single(app.world())
            && growing.0.done()
        {
            let mut alone = self::app(SolvePlugins);
            let domain = self::growing(2.0).spawn(alone.world_mut());
            assert_eq!(warped.0, settle(&mut alone, domain));
            return;
        }
    }
    panic!("it does not settle");
}

/// Cells that keep their shape whatever is asked for, and say so by a size of one.
#[derive(Debug)]
struct Stiff;

impl CellEnergy for Stiff {
    fn target(&self, corners: [Vec3A; 8], rotation: &mut Quat, _: f32) -> Mat3A {
        Mixture { fidelity: 0.0 }.target(corners, rotation, 1.0)
    }

    fn flat_target(&self, corners: [Vec3A; 8], _: f32) -> Mat3A {
        Mixture { fidelity: 0.0 }.flat_target(corners, 1.0)
    }
}

#[test]
fn the_energy_of_cells_can_be_replaced_alone() {
    let length = |state: &[Vec3A]| {
        let z = || state.iter().map(|p| p.z);
        z().fold(f32::MIN, f32::max) - z().fold(f32::MAX, f32::min)
    };
    let grown = |stages: bevy::app::PluginGroupBuilder| {
        let mut app = app(stages);
        let domain = growing(2.0).spawn(app.world_mut());
        length(&settle(&mut app, domain))
    };
    let usual = grown(SolvePlugins.build());
    let stiff = grown(SolvePlugins.build().set(CollisionPlugin { energy: |_| Arc::new(Stiff) }));
    assert!(usual > 15.0, "{usual} cells, of 12 at rest");
    assert!((stiff - 12.0).abs() < 0.5, "{stiff} cells, of 12 at rest");
}

/// A stage that a program has put in the place of Eq. 1: V' is the rest shape.
struct RestPlugin;

impl Plugin for RestPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Solve, rest.in_set(Stage::EdgeSolve));
    }
}

fn rest(mut commands: Commands, lattices: Query<(Entity, &Lattice), Without<LinearSolution>>) {
    for (entity, Lattice(complex)) in &lattices {
        commands.entity(entity).insert(LinearSolution(complex.rest.clone()));
    }
}

#[test]
fn a_stage_can_be_replaced_alone() {
    let stages = SolvePlugins.build().disable::<homunculus::edge::plugin::EdgePlugin>().add(RestPlugin);
    let mut app = app(stages);
    let domain = growing(2.0).spawn(app.world_mut());
    let state = settle(&mut app, domain);
    let (linear, lattice) = (app.world().get::<LinearSolution>(domain), app.world().get::<Lattice>(domain));
    assert_eq!(linear.unwrap().0, lattice.unwrap().0.rest, "Eq. 1 was not solved");
    assert!(state != lattice.unwrap().0.rest, "and yet it has grown");
}

#[test]
fn what_is_asked_anew_sets_off_what_depends_on_it_and_nothing_else() {
    let content = |value| growing(value).content;
    let mut run = Run::interactive(growing(2.0)).unwrap();
    while !run.step().unwrap() {}
    let lattice = run.get::<Lattice>().unwrap().0.clone();
    let bound = run.get::<Bound>().unwrap().0.clone();
    let first = run.get::<LinearSolution>().unwrap().0.clone();
    let (state, keyframes) = (run.get::<Warped>().unwrap().0.clone(), run.get::<Reel>().unwrap().0.keyframes().len());

    // Up to Eq. 1 nothing else changes.
    run.ask(content(1.5), Start::Present);
    run.step_until(Stage::EdgeSolve).unwrap();
    assert!(run.get::<LinearSolution>().unwrap().0 != first);
    assert_eq!(run.get::<Warped>().unwrap().0, state);
    assert_eq!(run.get::<Reel>().unwrap().0.keyframes().len(), keyframes);

    // From there growth goes on, from the present state, on the same lattice.
    assert!(!run.step().unwrap());
    assert_eq!(run.get::<Reel>().unwrap().0.keyframes()[0].positions, state);
    while !run.step().unwrap() {}
    assert!(Arc::ptr_eq(&lattice, &run.get::<Lattice>().unwrap().0));
    assert!(Arc::ptr_eq(&bound, &run.get::<Bound>().unwrap().0));

    // Begun again from rest it is what it would have been at once, but for where the linear solution started.
    run.begin(Start::Rest);
    assert!(!run.step().unwrap());
    assert_eq!(run.get::<Reel>().unwrap().0.keyframes()[0].positions, lattice.rest);
    while !run.step().unwrap() {}
    let fresh = {
        let mut run = Run::new(growing(1.5)).unwrap();
        while !run.step().unwrap() {}
        run.get::<Warped>().unwrap().0.clone()
    };
    let again = &run.get::<Warped>().unwrap().0;
    let apart = fresh.iter().zip(again).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
    assert!(apart < 0.01, "{apart} cells");

    // Other settings leave importance and Eq. 1 alone.
    let linear = run.get::<LinearSolution>().unwrap().0.clone();
    run.set(Settings { fidelity: 0.9, ..SETTINGS }, Start::Rest);
    while !run.step().unwrap() {}
    assert_eq!(run.get::<LinearSolution>().unwrap().0, linear);
    assert!(run.get::<Warped>().unwrap().0 != fresh);
}
