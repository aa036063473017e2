//! Contract of `reference`: the paper's scheme is there to compare with, and behaves as the documentation says.

use glam::{DVec3, UVec3, Vec3A};
use homunculus::{
    collision::Problem,
    edge::EdgeSolver,
    reference::{Reading, fig5, jacobi},
    voxel::{Complex, Grid},
};

/// A block whose one end is asked to be three times as large.
fn block() -> (Complex, Vec<f32>) {
    let grid = Grid { origin: DVec3::ZERO, cell_size: 1.0, cells: UVec3::new(8, 3, 3) };
    let complex = Complex::from_cells(grid, &[true; 72]);
    let importance = complex.rest.iter().map(|p| 1.0 + 2.0 * (p.x / 8.0)).collect();
    (complex, importance)
}

fn linear(complex: &Complex, importance: &[f32]) -> Vec<Vec3A> {
    let mut linear = complex.rest.clone();
    EdgeSolver::new(complex).solve(complex, importance, &mut linear);
    linear
}

fn run(reading: Reading, iterations: usize) -> Vec<Vec3A> {
    let (complex, importance) = block();
    let problem = Problem::new(&complex, &importance, 0.5);
    let linear = linear(&complex, &importance);
    let lambda = |t: usize| t as f32 / (iterations - 1) as f32;
    (0..iterations).fold(complex.rest.clone(), |x, t| fig5(&complex, &problem, &linear, reading, lambda(t), &x))
}

fn length(x: &[Vec3A]) -> f32 {
    let (low, high) = x.iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(l, h), p| (l.min(p.x), h.max(p.x)));
    high - low
}

#[test]
fn read_sensibly_fig5_grows_to_the_linear_lengths() {
    let (complex, importance) = block();
    let wanted = length(&linear(&complex, &importance));
    let got = length(&run(Reading::Sensible, 1000));
    assert!((got / wanted - 1.0).abs() < 0.05, "{got} {wanted}");
}

/// The sabotage sibling: read to the letter, nothing of the above holds.
#[test]
fn read_to_the_letter_fig5_diverges() {
    let x = run(Reading::Printed, 1000);
    let size = length(&x);
    assert!(x.iter().any(|p| !p.is_finite()) || size.is_nan() || size > 1000.0, "it stayed at {size}");
}

#[test]
fn jacobi_reaches_what_multigrid_solves() {
    let (complex, importance) = block();
    let solved = linear(&complex, &importance);
    let distance = |sweeps| {
        let mut x = jacobi(&complex, &importance, sweeps);
        homunculus::edge::keep_centroids(&complex, &mut x);
        x.iter().zip(&solved).map(|(a, b)| (*a - *b).length()).fold(0.0, f32::max)
    };
    assert!(distance(2000) < 0.01, "{}", distance(2000));
    assert!(distance(20) > 0.1, "20 sweeps are not enough, which is why the product does not sweep");
}
