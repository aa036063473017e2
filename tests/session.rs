//! Contract of the session: states come as they are solved, a change of importance is seen at once in the linear solution
//! and ends certified, nothing waits for the solver.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

mod common;

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use homunculus::boundary::Boundary;
use homunculus::importance::{Layer, Stack};
use homunculus::session::{Phase, Session, Snapshot};
use homunculus::subject::{Body, Subject};
use homunculus::{run, settings::Settings};

/// Longest wait for anything here; a fault of the session, not a slow machine, is what reaches it.
const PATIENCE: Duration = Duration::from_secs(300);

fn hand() -> Arc<Boundary> {
    Arc::new(homunculus::gallery::open("hand").unwrap().model.boundary)
}

fn stack(boundary: &Boundary, value: f32) -> Arc<Stack> {
    let (low, high) = boundary.bounds().unwrap();
    let tip = boundary.positions.iter().copied().max_by(|a, b| a.y.total_cmp(&b.y)).unwrap();
    let radius = 0.25 * (high - low).length();
    let layer = Layer::Sphere { centre: tip.to_array(), radius, value };
    Arc::new(Stack::load(&[layer], 1.0, false, boundary, Path::new("")).unwrap())
}

fn body(boundary: &Arc<Boundary>, value: f32) -> Arc<dyn Subject> {
    Arc::new(Body { boundary: boundary.clone(), importance: stack(boundary, value) })
}

fn settings(resolution: u32) -> Settings {
    Settings { resolution, fidelity: 0.8, keys: 4, reference: None }
}

fn open(resolution: u32, value: f32) -> (Session, Arc<Boundary>) {
    let session = Session::start().unwrap();
    let boundary = hand();
    session.open(body(&boundary, value), settings(resolution));
    (session, boundary)
}

fn wait(session: &Session, until: impl Fn(&Snapshot) -> bool) -> Arc<Snapshot> {
    let start = Instant::now();
    loop {
        let snapshot = session.snapshot();
        if until(&snapshot) {
            return snapshot;
        }
        assert!(start.elapsed() < PATIENCE, "{:?} {:?}", snapshot.phase, snapshot.error);
        std::thread::sleep(Duration::from_millis(1));
    }
}

fn is_at_rest(snapshot: &Snapshot) -> bool {
    !snapshot.phase.is_busy() && snapshot.phase != Phase::Empty
}

#[test]
fn ends_with_the_film_that_the_command_line_makes() {
    let (session, boundary) = open(24, 2.0);
    let done = wait(&session, is_at_rest);
    assert_eq!(done.phase, Phase::Done, "{:?}", done.error);
    let expected = run::warp(&boundary, &stack(&boundary, 2.0), &settings(24), &common::Quiet).unwrap();
    let outcome = done.outcome.as_ref().unwrap();
    assert_eq!(done.film.len(), expected.frames.len());
    for (found, expected) in outcome.frames.iter().zip(&expected.frames) {
        assert_eq!((found.lambda, &found.positions), (expected.lambda, &expected.positions));
    }
    assert!(done.certificate.as_ref().unwrap().certified());
    let counted: u32 = done.histogram.as_ref().unwrap().counts.iter().sum();
    assert_eq!(counted as usize, outcome.domain.elements);
}

#[test]
fn states_come_while_it_solves() {
    let (session, _) = open(32, 3.0);
    let lattice = wait(&session, |s| s.lattice.is_some());
    assert!(lattice.outcome.is_none());
    let growing = wait(&session, |s| s.film.len() >= 3 && s.phase == Phase::Growing);
    assert!(growing.linear.is_some() && growing.warped.is_some() && growing.size_error_p95.is_some());
    assert!((0.0..1.0).contains(&growing.lambda) && (0.0..1.0).contains(&growing.fraction));
    assert!(growing.film.windows(2).all(|w| w[0].lambda < w[1].lambda));
    assert!(growing.film.iter().all(|state| state.certificate.certified()));
}

#[test]
fn a_change_goes_on_from_the_last_valid_state_and_ends_certified() {
    let (session, boundary) = open(24, 2.0);
    let before = wait(&session, is_at_rest);
    session.set_importance(body(&boundary, 3.0));
    let linear = wait(&session, |s| s.version > before.version);
    assert!(
        !Arc::ptr_eq(linear.linear.as_ref().unwrap(), before.linear.as_ref().unwrap()),
        "the linear solution first"
    );
    assert!(
        Arc::ptr_eq(&linear.film[0].positions, &before.film[0].positions) && !linear.film_is_current,
        "the old film stays"
    );
    let adapting = wait(&session, |s| s.phase == Phase::Adapting && s.warped.is_some());
    // The first valid state on the way lies near the last one, far from rest.
    let distance =
        |a: &[glam::Vec3A], b: &[glam::Vec3A]| a.iter().zip(b).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
    let (state, last) = (adapting.warped.as_ref().unwrap(), before.warped.as_ref().unwrap());
    let rest = &adapting.lattice.as_ref().unwrap().complex.rest;
    assert!(distance(state, last) < distance(state, rest), "{} {}", distance(state, last), distance(state, rest));
    let adapted = wait(&session, |s| s.phase == Phase::Growing);
    assert!(adapted.certificate.as_ref().unwrap().certified());
    let done = wait(&session, is_at_rest);
    assert_eq!(done.phase, Phase::Done);
    assert!(done.film_is_current && done.outcome.as_ref().unwrap().certificate.certified());
    // And the film is the one of the new importance, as if nothing had been before.
    let fresh = run::warp(&boundary, &stack(&boundary, 3.0), &settings(24), &common::Quiet).unwrap();
    let error = (done.outcome.as_ref().unwrap().fidelity.p95 - fresh.fidelity.p95).abs();
    assert!(error < 0.02, "{error}");
}

#[test]
fn sabotage_an_unpainted_session_keeps_its_linear_solution() {
    let (session, boundary) = open(24, 2.0);
    let before = wait(&session, is_at_rest);
    session.set_importance(body(&boundary, 2.0));
    let after = wait(&session, |s| s.version > before.version);
    let (a, b) = (before.linear.as_ref().unwrap(), after.linear.as_ref().unwrap());
    assert!(a.iter().zip(b.iter()).all(|(a, b)| a.distance(*b) < 0.05), "the same importance has the same solution");
}

#[test]
fn cancelling_stops_and_resuming_goes_on() {
    let (session, _) = open(32, 3.0);
    wait(&session, |s| s.phase == Phase::Growing && s.film.len() >= 2);
    session.cancel();
    let stopped = wait(&session, is_at_rest);
    assert_eq!(stopped.phase, Phase::Stopped);
    std::thread::sleep(Duration::from_millis(100));
    assert_eq!(session.snapshot().version, stopped.version, "nothing happens");
    session.resume();
    wait(&session, |s| s.phase == Phase::Done);
}

#[test]
fn what_is_cancelled_before_it_began_waits_too() {
    let (session, boundary) = open(20, 2.0);
    wait(&session, |s| s.phase == Phase::Done);
    session.set_importance(body(&boundary, 3.0));
    session.cancel();
    let stopped = wait(&session, |s| s.phase == Phase::Stopped);
    std::thread::sleep(Duration::from_millis(500));
    assert_eq!(session.snapshot().version, stopped.version, "nothing happens");
    session.resume();
    let done = wait(&session, |s| s.phase == Phase::Done);
    assert!(done.film_is_current && done.certificate.as_ref().unwrap().certified());
}

#[test]
fn settings_and_subjects_replace_each_other() {
    let (session, boundary) = open(24, 2.0);
    wait(&session, |s| s.phase == Phase::Growing);
    session.set_settings(Settings { fidelity: 0.2, ..settings(24) });
    let done = wait(&session, |s| s.outcome.as_ref().is_some_and(|outcome| outcome.fidelity.mu == 0.2));
    assert_eq!(done.outcome.as_ref().unwrap().fidelity.mu, 0.2);
    session.set_settings(settings(16));
    let done = wait(&session, |s| is_at_rest(s) && s.lattice.as_ref().is_some_and(|l| l.summary.resolution == 16));
    assert_eq!(done.phase, Phase::Done);
    session.open(body(&boundary, 1.5), settings(7));
    let failed = wait(&session, |s| s.phase == Phase::Failed);
    assert!(failed.error.as_ref().unwrap().contains("resolution 7"), "{:?}", failed.error);
    session.open(body(&boundary, 1.5), settings(16));
    wait(&session, |s| s.phase == Phase::Done);
}

#[test]
fn a_solver_that_breaks_off_says_so_and_takes_the_next_order() {
    let session = Session::start().unwrap();
    let good = hand();
    let mut broken = (*good).clone();
    broken.triangles[0] = [u32::MAX; 3];
    let subject = |boundary: Arc<Boundary>| Arc::new(Body { boundary, importance: stack(&good, 2.0) });
    session.open(subject(Arc::new(broken)), settings(16));
    let failed = wait(&session, is_at_rest);
    assert_eq!(failed.phase, Phase::Failed);
    let sentence = failed.error.clone().unwrap();
    assert!(sentence.contains("the solver broke off") && !sentence.contains('\n'), "{sentence}");
    session.open(subject(good.clone()), settings(16));
    let done = wait(&session, is_at_rest);
    assert_eq!(done.phase, Phase::Done, "{:?}", done.error);
    assert!(done.error.is_none() && session.is_answered(&done));
}

#[test]
fn a_snapshot_knows_which_orders_it_answers() {
    let (session, boundary) = open(16, 2.0);
    let done = wait(&session, is_at_rest);
    assert!(session.is_answered(&done));
    session.set_importance(body(&boundary, 1.5));
    assert!(!session.is_answered(&done), "it is of the importance before");
    let next = wait(&session, |s| session.is_answered(s) && is_at_rest(s));
    session.set_settings(Settings { fidelity: 0.3, ..settings(16) });
    assert!(!session.is_answered(&next));
    wait(&session, |s| session.is_answered(s) && is_at_rest(s));
}
