//! Contract where growth is in its own way: a fist, the prongs of a U, two loose bars, a coil, a ring of beads. All of
//! them grow, as far as there is room or by moving out of the way, and every frame is certified; Eq. 1 alone crosses.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests panic and speak as tests do")]

mod common;

use std::collections::HashMap;
use std::f64::consts::TAU;

use common::{Quiet, cuboids, shared, warp};
use glam::{DVec3, IVec3, dvec3};
use homunculus::{
    boundary::{self, Boundary, Regions},
    importance::{Layer, Stack},
    run,
    run::Outcome,
    settings::{Reference, Settings},
};

/// What is asked to grow counts as grown above this mean size.
const GROWN: f64 = 1.3;

/// Name of the region of vertices that are asked to grow.
const REGION: &str = "growing";

fn sphere(centre: DVec3, radius: f64, value: f32) -> Layer {
    Layer::Sphere { centre: centre.to_array(), radius, value }
}

/// Marks the vertices that are asked for more than [`GROWN`], so that their size is reported.
fn marked(mut boundary: Boundary, layers: &[Layer]) -> Boundary {
    let stack = Stack::load(layers, 1.0, false, &boundary, "".as_ref()).unwrap();
    let region = |f: &f32| if f64::from(*f) > GROWN { 0 } else { u32::MAX };
    let of_vertex = stack.at_vertices(&boundary).iter().map(region).collect();
    boundary.regions = Some(Regions { names: vec![REGION.into()], of_vertex });
    boundary
}

/// What is wrong with a growth, if anything.
fn fault(outcome: &Outcome) -> Result<(), String> {
    for frame in &outcome.frames {
        if !frame.certificate.certified() {
            return Err(format!("λ = {}: not certified: {:?}", frame.lambda, frame.certificate));
        }
        if !frame.positions.iter().all(|p| p.is_finite()) {
            return Err(format!("λ = {}: a position is no place", frame.lambda));
        }
    }
    let ends = (outcome.frames.first().map(|f| f.lambda), outcome.frames.last().map(|f| f.lambda));
    if ends != (Some(0.0), Some(1.0)) {
        return Err(format!("the growth goes from {:?} to {:?}", ends.0, ends.1));
    }
    match outcome.fidelity.regions.iter().find(|r| r.name == REGION) {
        Some(region) if region.achieved > GROWN => Ok(()),
        region => Err(format!("it did not grow: {region:?}")),
    }
}

fn grown(boundary: Boundary, layers: &[Layer], resolution: u32) -> Outcome {
    let boundary = marked(boundary, layers);
    let start = std::time::Instant::now();
    let outcome = warp(&boundary, layers, resolution, 0.5).unwrap();
    println!(
        "{}: {} cells, classic {:?}, {} frames, {:?}, size error p95 {:.3}, distortion p99 {:.2}, {:.1} s",
        boundary.name,
        outcome.domain.cells,
        outcome.classic,
        outcome.frames.len(),
        outcome.fidelity.regions,
        outcome.fidelity.p95,
        outcome.distortion.p99,
        start.elapsed().as_secs_f64(),
    );
    assert_eq!(fault(&outcome), Ok(()), "{}", boundary.name);
    outcome
}

/// Whether Eq. 1 alone would have crossed.
fn crosses_by_eq1(outcome: &Outcome) -> bool {
    outcome.classic.is_some_and(|c| c.crossings > 0)
}

// ── shapes ──

/// The surface of some unit cubes, closed, without walls inside.
fn cubes(name: &str, size: IVec3, inside: impl Fn(IVec3) -> bool) -> Boundary {
    let (mut positions, mut triangles, mut vertices) = (Vec::new(), Vec::new(), HashMap::new());
    for k in 0..size.element_product() {
        let cube = IVec3::new(k % size.x, k / size.x % size.y, k / size.x / size.y);
        for axis in (0..3).filter(|_| inside(cube)) {
            let [u, v, w] = [(axis + 1) % 3, (axis + 2) % 3, axis].map(|a| IVec3::AXES[a]);
            for side in [0, 1] {
                if inside(cube + w * (2 * side - 1)) {
                    continue;
                }
                let base = cube + w * side;
                let mut quad = [base, base + u, base + u + v, base + v].map(|corner| {
                    *vertices.entry(corner).or_insert_with(|| {
                        positions.push(corner.as_dvec3());
                        positions.len() as u32 - 1
                    })
                });
                if side == 0 {
                    quad.reverse();
                }
                let [a, b, c, d] = quad;
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    Boundary::from_triangles(name, positions, triangles)
}

/// Two prongs of 2 × 2 × 8, a gap of one between them, on a common foot.
fn fork() -> (Boundary, Vec<Layer>) {
    let size = IVec3::new(5, 2, 8);
    let inside = |c: IVec3| c.cmpge(IVec3::ZERO).all() && c.cmplt(size).all() && (c.z < 2 || c.x != 2);
    let layers = [1.0, 4.0].map(|x| sphere(dvec3(x, 1.0, 6.0), 3.5, 6.0));
    (cubes("two bars of a U", size, inside), layers.to_vec())
}

/// A tube of radius `radius(t)` around `centre(t)`, `t` in 0..=1, with capped ends or closed to a ring.
fn tube(name: &str, closed: bool, centre: impl Fn(f64) -> DVec3, radius: impl Fn(f64) -> f64, along: u32) -> Boundary {
    const AROUND: u32 = 16;
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    let rings = if closed { along } else { along + 1 };
    for k in 0..rings {
        let t = f64::from(k) / f64::from(along);
        let tangent = (centre(t + 1e-4) - centre(t - 1e-4)).normalize();
        let side = tangent.cross(DVec3::Z).normalize();
        let up = side.cross(tangent);
        for j in 0..AROUND {
            let (sin, cos) = (f64::from(j) / f64::from(AROUND) * TAU).sin_cos();
            let p = centre(t) + radius(t) * (side * cos + up * sin);
            positions.push(p.as_vec3().as_dvec3());
        }
    }
    for k in 0..along {
        for j in 0..AROUND {
            let at = |k: u32, j: u32| k % rings * AROUND + j % AROUND;
            let [a, b, c, d] = [at(k, j), at(k, j + 1), at(k + 1, j + 1), at(k + 1, j)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    for (t, ring) in [(0.0, 0), (1.0, along)].into_iter().filter(|_| !closed) {
        let tip = positions.len() as u32;
        positions.push(centre(t).as_vec3().as_dvec3());
        for j in 0..AROUND {
            let (a, b) = (ring * AROUND + j, ring * AROUND + (j + 1) % AROUND);
            triangles.push(if ring == 0 { [tip, b, a] } else { [tip, a, b] });
        }
    }
    Boundary::from_triangles(name, positions, triangles)
}

/// Three turns of a spring, wires thinner by half than its pitch, which thickens on one side.
fn coil() -> (Boundary, Vec<Layer>) {
    const TURNS: f64 = 3.0;
    const PITCH: f64 = 3.0;
    let centre = |t: f64| {
        let angle = TURNS * TAU * t;
        dvec3(4.0 * angle.cos(), 4.0 * angle.sin(), TURNS * PITCH * t)
    };
    let layers = [0.5, 1.5, 2.5].map(|turn| sphere(dvec3(-4.0, 0.0, PITCH * turn), 5.0, 3.5));
    (tube("coil", false, centre, |_| 1.0, 120), layers.to_vec())
}

/// A closed ring of eight beads.
fn beads() -> (Boundary, Vec<Layer>) {
    const COUNT: u32 = 8;
    let centre = |t: f64| dvec3(5.0 * (TAU * t).cos(), 5.0 * (TAU * t).sin(), 0.0);
    let radius = |t: f64| 0.6 + 0.7 * (f64::from(COUNT) * TAU * t).cos().max(0.0);
    let layers = (0..COUNT).map(|k| sphere(centre(f64::from(k) / f64::from(COUNT)), 3.5, 4.0)).collect();
    (tube("ring of beads", true, centre, radius, 96), layers)
}

// ── growths ──

#[test]
fn a_closed_fist_grows() {
    let Some(folder) = shared("meshes") else { return };
    let hand = boundary::read(&folder.join("hand.off")).unwrap();
    // Fingers lie on the palm in the upper half of z; the thumb crosses them at low x.
    let layers = [sphere(dvec3(0.1, 0.0, 0.3), 0.5, 3.0), sphere(dvec3(-0.35, 0.0, 0.05), 0.25, 3.0)];
    grown(hand, &layers, 28);
}

#[test]
fn two_bars_of_a_fork_grow_into_each_other() {
    let (boundary, layers) = fork();
    assert!(crosses_by_eq1(&grown(boundary, &layers, 32)));
}

#[test]
fn two_loose_bars_grow_into_each_other() {
    let bars = cuboids("two loose bars", &[([0.0, 0.0, 0.0], [1.0, 1.0, 6.0]), ([2.0, 0.0, 0.0], [3.0, 1.0, 6.0])]);
    let layers = [sphere(dvec3(1.5, 0.5, 3.0), 1000.0, 6.0)];
    assert!(crosses_by_eq1(&grown(bars, &layers, 32)));
}

#[test]
fn a_coil_thickens_on_one_side() {
    let (boundary, layers) = coil();
    assert!(crosses_by_eq1(&grown(boundary, &layers, 24)));
}

#[test]
fn the_beads_of_a_ring_grow() {
    let (boundary, layers) = beads();
    grown(boundary, &layers, 36);
}

#[test]
fn sabotage_eq1_alone_is_found_at_fault() {
    let (boundary, layers) = fork();
    let boundary = marked(boundary, &layers);
    let stack = Stack::load(&layers, 1.0, false, &boundary, "".as_ref()).unwrap();
    let settings = Settings { resolution: 24, fidelity: 0.5, keys: 2, reference: Some(Reference::Eq1) };
    let outcome = run::warp(&boundary, &stack, &settings, &Quiet).unwrap();
    assert!(fault(&outcome).unwrap_err().contains("not certified"));
}

#[test]
fn sabotage_what_stays_as_it_is_has_not_grown() {
    let (boundary, layers) = fork();
    let boundary = marked(boundary, &layers);
    let outcome = warp(&boundary, &[], 16, 0.5).unwrap();
    assert!(fault(&outcome).unwrap_err().contains("did not grow"));
}
