//! Contract: the same bits for any number of threads. Positions of all frames, importance and every count are equal with
//! 1, 2, 3 and 7 threads, because loops gather and sums are taken over chunks of fixed size in order.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests panic and speak as tests do")]

mod common;

use common::{Random, cuboids, shared, warp};
use glam::DVec3;
use homunculus::{
    boundary::{self, Boundary},
    importance::Layer,
    run::Outcome,
};

/// Nodes below which a loop is a single task, for which any number of threads is the same anyway.
const NODES_PER_TASK: usize = 2048;

fn with_threads(threads: usize, boundary: &Boundary, layers: &[Layer], resolution: u32) -> Outcome {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| warp(boundary, layers, resolution, 0.5)).unwrap()
}

/// The first difference of two outcomes, seconds aside.
fn difference(a: &Outcome, b: &Outcome) -> Result<(), String> {
    let lambdas = |o: &Outcome| o.frames.iter().map(|f| f.lambda.to_bits()).collect::<Vec<_>>();
    if lambdas(a) != lambdas(b) {
        return Err(format!("{} frames, or {}, or at another λ", a.frames.len(), b.frames.len()));
    }
    let bits = |p: DVec3| p.to_array().map(f64::to_bits);
    for (a, b) in a.frames.iter().zip(&b.frames) {
        if a.positions.len() != b.positions.len() {
            return Err("another number of vertices".into());
        }
        if let Some(v) = (0..a.positions.len()).find(|&v| bits(a.positions[v]) != bits(b.positions[v])) {
            return Err(format!("λ = {}: vertex {v} at {} or {}", a.lambda, a.positions[v], b.positions[v]));
        }
        if a.certificate != b.certificate {
            return Err(format!("λ = {}: {:?} or {:?}", a.lambda, a.certificate, b.certificate));
        }
    }
    let importance = |o: &Outcome| o.importance.iter().map(|f| f.to_bits()).collect::<Vec<_>>();
    if importance(a) != importance(b) {
        return Err("importance differs".into());
    }
    let rest = |o: &Outcome| (o.input.clone(), o.domain.clone(), o.classic, o.certificate.clone(), o.distortion);
    if rest(a) != rest(b) || a.fidelity != b.fidelity {
        return Err(format!("{:?} or {:?}", rest(a), rest(b)));
    }
    Ok(())
}

fn is_the_same_for_any_threads(boundary: &Boundary, layers: &[Layer], resolution: u32) -> Outcome {
    let one = with_threads(1, boundary, layers, resolution);
    assert!(one.domain.nodes > NODES_PER_TASK, "{} nodes are one task", one.domain.nodes);
    for threads in [2, 3, 7] {
        let many = with_threads(threads, boundary, layers, resolution);
        assert_eq!(difference(&one, &many), Ok(()), "{} with {threads} threads", boundary.name);
    }
    one
}

#[test]
fn a_real_mesh_is_the_same_for_any_threads() {
    let Some(folder) = shared("meshes") else { return };
    let mesh = boundary::read(&folder.join("hand.off")).unwrap();
    let layers = Random(7).layers(&mesh, 6, 0.5, 3.0);
    is_the_same_for_any_threads(&mesh, &layers, 20);
}

fn bars() -> (Boundary, Vec<Layer>) {
    let bars = cuboids("bars", &[([0.0, 0.0, 0.0], [1.0, 1.0, 3.0]), ([1.25, 0.0, 0.0], [2.25, 1.0, 3.0])]);
    let layers = vec![Layer::Sphere { centre: [1.125, 0.5, 1.5], radius: 3.0, value: 3.0 }];
    (bars, layers)
}

#[test]
fn bars_in_contact_are_the_same_for_any_threads() {
    let (bars, layers) = bars();
    let outcome = is_the_same_for_any_threads(&bars, &layers, 24);
    // They would have gone through each other: contacts and guard had work.
    assert!(outcome.classic.is_some_and(|c| c.crossings > 0));
}

#[test]
fn sabotage_the_last_bit_of_one_vertex_is_seen() {
    let (bars, layers) = bars();
    let outcome = with_threads(2, &bars, &layers, 8);
    assert_eq!(difference(&outcome, &outcome), Ok(()));
    let mut other = outcome.clone();
    let y = &mut other.frames[3].positions[5].y;
    *y = f64::from_bits(y.to_bits() ^ 1);
    assert!(difference(&outcome, &other).unwrap_err().contains("vertex 5"));
    let mut other = outcome.clone();
    other.importance[0] = f32::from_bits(other.importance[0].to_bits() ^ 1);
    assert!(difference(&outcome, &other).unwrap_err().contains("importance"));
    let mut other = outcome.clone();
    other.domain.nodes += 1;
    assert!(difference(&outcome, &other).is_err());
}
