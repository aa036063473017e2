//! Contract at the edges of what may come: any unit, any place, any sheet, either end of the resolution. A certified warp,
//! or one sentence; in no case longer than a few seconds.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests panic and speak as tests do")]

mod common;

use std::path::Path;
use std::time::{Duration, Instant};

use common::{cuboids, warp};
use glam::DVec3;
use homunculus::{
    Error, Result,
    boundary::Boundary,
    importance::{Layer, Stack},
    run,
    run::Outcome,
    settings::{Reference, Settings},
    voxel::{MAX_RESOLUTION, MIN_RESOLUTION},
};

/// What any of these may take.
const PATIENCE: Duration = Duration::from_secs(10);

/// Warps with a sphere of threefold growth at the first vertex, as wide as half the shape.
fn grown(boundary: &Boundary, resolution: u32) -> Result<Outcome> {
    let (low, high) = boundary.bounds().unwrap();
    let first = boundary.triangles[0][0] as usize;
    let radius = 0.5 * (high - low).max_element();
    let layers = [Layer::Sphere { centre: boundary.positions[first].to_array(), radius, value: 3.0 }];
    let start = Instant::now();
    let outcome = warp(boundary, &layers, resolution, 0.5);
    let seconds = outcome.as_ref().map_or(&[][..], |o| &o.seconds);
    println!("{} at {resolution}: {:.2} s, {seconds:.2?}", boundary.name, start.elapsed().as_secs_f64());
    assert!(start.elapsed() < PATIENCE, "{} took {:?}", boundary.name, start.elapsed());
    outcome
}

/// What is wrong with an outcome, if anything: a frame that is not certified, a place that is none, nothing moved.
fn fault(boundary: &Boundary, outcome: &Outcome) -> Result<(), String> {
    for frame in &outcome.frames {
        if !frame.certificate.certified() {
            return Err(format!("λ = {}: {:?}", frame.lambda, frame.certificate));
        }
        if let Some(v) = frame.positions.iter().position(|p| !p.is_finite()) {
            return Err(format!("λ = {}: vertex {v} at {}", frame.lambda, frame.positions[v]));
        }
    }
    let last = outcome.frames.last().ok_or("no frame")?;
    let moved = last.positions.iter().zip(&boundary.positions).map(|(a, b)| (*a - *b).length()).fold(0.0, f64::max);
    if moved > 0.5 * outcome.domain.cell_size { Ok(()) } else { Err(format!("nothing moved: {moved}")) }
}

fn is_certified(boundary: &Boundary, resolution: u32) -> Outcome {
    let outcome = grown(boundary, resolution).unwrap_or_else(|e| panic!("{}: {e}", boundary.name));
    assert_eq!(fault(boundary, &outcome), Ok(()), "{}", boundary.name);
    outcome
}

/// Two bars with a gap between them.
fn bars() -> Boundary {
    cuboids("bars", &[([0.0; 3], [1.0, 1.0, 3.0]), ([1.5, 0.0, 0.0], [2.5, 1.0, 3.0])])
}

fn mapped(name: &str, mut boundary: Boundary, map: impl Fn(DVec3) -> DVec3) -> Boundary {
    boundary.name = name.into();
    boundary.positions.iter_mut().for_each(|p| *p = map(*p));
    boundary
}

fn last(outcome: &Outcome) -> &[DVec3] {
    outcome.frames.last().map_or(&[], |f| &f.positions)
}

#[test]
fn any_unit_will_do() {
    let metres = is_certified(&bars(), 12);
    for exponent in [-90, -30, 30, 90] {
        // Units apart by a power of two are apart by exponents alone: the same digits come out.
        let unit = 2.0_f64.powi(exponent);
        let outcome = is_certified(&mapped(&format!("bars in 2^{exponent}"), bars(), |p| p * unit), 12);
        let expected: Vec<DVec3> = last(&metres).iter().map(|p| *p * unit).collect();
        assert_eq!(last(&outcome), expected, "2^{exponent}");
    }
    for unit in [1e-30, 1e-9, 1e9, 1e30] {
        let outcome = is_certified(&mapped(&format!("bars in {unit:e}"), bars(), |p| p * unit), 12);
        is_alike(&outcome, &metres);
    }
}

/// What rounding may change: where bars slide along each other, not what they are.
fn is_alike(a: &Outcome, b: &Outcome) {
    assert_eq!(
        (a.domain.cells, a.domain.elements, a.input.clone()),
        (b.domain.cells, b.domain.elements, b.input.clone())
    );
    assert!((a.fidelity.median - b.fidelity.median).abs() < 0.01, "{:?} or {:?}", a.fidelity, b.fidelity);
    assert!((a.fidelity.p95 - b.fidelity.p95).abs() < 0.03, "{:?} or {:?}", a.fidelity, b.fidelity);
}

#[test]
fn any_place_will_do() {
    let far = DVec3::new(1.0e6, -2.0e6, 0.5e6);
    let outcome = is_certified(&mapped("bars far away", bars(), |p| p + far), 12);
    let near = is_certified(&bars(), 12);
    is_alike(&outcome, &near);
    let off = last(&outcome).iter().zip(last(&near)).map(|(a, b)| (*a - far - *b).length()).fold(0.0, f64::max);
    assert!(off < near.domain.cell_size, "{off}");
    // As exact as far away can be, where nothing is asked for.
    let still = mapped("bars far away", bars(), |p| p + far);
    assert_eq!(last(&warp(&still, &[], 12, 0.5).unwrap()), still.positions);
}

#[test]
fn vertices_that_no_triangle_uses_stay() {
    let mut boundary = bars();
    let strays = [DVec3::splat(-7.0), DVec3::new(0.5, 0.5, 1.5), DVec3::splat(1.0e7)];
    boundary.positions.extend(strays);
    boundary.name = "bars and strays".into();
    let (first, radius) = (boundary.positions[0], 1.5);
    let layers = [Layer::Sphere { centre: first.to_array(), radius, value: 3.0 }];
    let outcome = warp(&boundary, &layers, 12, 0.5).unwrap();
    assert_eq!(outcome.domain.resolution, 12);
    // The strays do not stretch the lattice: it is as fine as without them.
    assert_eq!(outcome.domain.cell_size, is_certified(&bars(), 12).domain.cell_size);
    assert_eq!(fault(&boundary, &outcome), Ok(()));
    let last = &outcome.frames.last().unwrap().positions;
    assert_eq!((last[16], last[18]), (strays[0], strays[2]));
}

#[test]
fn thin_things_are_warped() {
    let at = |p: [f64; 3]| DVec3::from(p);
    let corners = [[0., 0., 0.], [1., 0., 0.], [0.2, 1., 0.]].map(at).to_vec();
    is_certified(&Boundary::from_triangles("one triangle", corners, vec![[0, 1, 2]]), 12);

    let side = 8_u32;
    let grid = (0..side * side).map(|k| DVec3::new(f64::from(k % side), f64::from(k / side), 0.0)).collect();
    let squares = (0..(side - 1) * (side - 1)).map(|k| k / (side - 1) * side + k % (side - 1));
    let triangles = squares.flat_map(|k| [[k, k + 1, k + side + 1], [k, k + side + 1, k + side]]).collect();
    let sheet = Boundary::from_triangles("flat sheet", grid, triangles);
    is_certified(&sheet, 20);
    is_certified(&mapped("slanted sheet", sheet, |p| DVec3::new(p.x, p.y, 0.3 * p.x + 0.2 * p.y)), 20);

    // A needle with an area that is only just not zero.
    let needle = [[0., 0., 0.], [1., 0., 0.], [0.5, 1.0e-12, 0.]].map(at).to_vec();
    is_certified(&Boundary::from_triangles("needle", needle, vec![[0, 1, 2]]), 12);
}

#[test]
fn either_end_of_the_resolution_works() {
    let cube = cuboids("cube", &[([0.0; 3], [1.0; 3])]);
    is_certified(&cube, MIN_RESOLUTION);
    let rod = cuboids("rod", &[([0.0; 3], [0.003, 0.003, 1.0])]);
    is_certified(&rod, MIN_RESOLUTION);
    let outcome = is_certified(&rod, MAX_RESOLUTION);
    assert!(outcome.domain.cells >= 256);
}

#[test]
fn beyond_either_end_is_refused_in_a_sentence() {
    for resolution in [0, MIN_RESOLUTION - 1, MAX_RESOLUTION + 1, 100_000, u32::MAX] {
        match grown(&bars(), resolution).map(|_| ()) {
            Err(Error::Input(text)) => {
                assert!(text.contains(&resolution.to_string()) && text.contains("memory"), "{text}");
                assert!(!text.contains('\n'), "{text}");
            }
            other => panic!("resolution {resolution}: {other:?}"),
        }
    }
    let point = Boundary::from_triangles("point", vec![DVec3::ONE; 3], vec![[0, 1, 2]]);
    match warp(&point, &[], 12, 0.5).map(|_| ()) {
        Err(Error::Input(text)) => assert!(text.contains("point") && text.contains("no extent"), "{text}"),
        other => panic!("{other:?}"),
    }
}

#[test]
fn sabotage_eq1_alone_and_a_lost_vertex_are_found_at_fault() {
    let bars = bars();
    let layers = [Layer::Sphere { centre: [1.25, 0.5, 1.5], radius: 100.0, value: 3.0 }];
    let stack = Stack::load(&layers, 1.0, false, &bars, Path::new("")).unwrap();
    let settings = Settings { resolution: 12, fidelity: 0.5, keys: 2, reference: Some(Reference::Eq1) };
    let outcome = run::warp(&bars, &stack, &settings, &common::Quiet).unwrap();
    assert!(fault(&bars, &outcome).unwrap_err().contains("crossings"));
    let mut outcome = is_certified(&bars, 12);
    outcome.frames[1].positions[3].x = f64::NAN;
    assert!(fault(&bars, &outcome).unwrap_err().contains("vertex 3"));
    assert!(fault(&bars, &warp(&bars, &[], 12, 0.5).unwrap()).unwrap_err().contains("nothing moved"));
}
