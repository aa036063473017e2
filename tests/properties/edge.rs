//! Eq. 1: multigrid conjugate gradients find what elimination finds.

use glam::{DVec3, Vec3A};
use homunculus::{
    edge::{EDGE_TOLERANCE, EdgeSolver, residual},
    voxel::{Complex, DIRECTIONS, NEIGHBOURS},
};
use proptest::prelude::*;

use super::{boxes_with_gaps, cases, common::Random, rough, scattered};

/// V' may be off by this, in cells: the constant's own promise.
const CLOSE: f64 = 0.01;

/// Eq. 1 by elimination in f64. `L + Σ_bodies 1 1ᵀ / n` is definite; what it adds to the right keeps the centroids.
fn dense(complex: &Complex, importance: &[f32]) -> Vec<DVec3> {
    let n = complex.nodes();
    let mut a = vec![vec![0.0_f64; n]; n];
    let mut x = vec![DVec3::ZERO; n];
    let mut count = vec![0.0_f64; complex.bodies as usize];
    let mut centroid = vec![DVec3::ZERO; complex.bodies as usize];
    for i in 0..n {
        count[complex.body[i] as usize] += 1.0;
        centroid[complex.body[i] as usize] += complex.rest[i].as_dvec3();
    }
    for i in 0..n {
        for slot in 0..NEIGHBOURS {
            let j = complex.neighbours[i][slot] as usize;
            if j == i {
                continue;
            }
            a[i][i] += 1.0;
            a[i][j] -= 1.0;
            let sign = if slot < 7 { -1.0 } else { 1.0 };
            let f = 0.5 * (f64::from(importance[i]) + f64::from(importance[j]));
            x[i] += f * sign * DIRECTIONS[slot % 7].as_dvec3();
        }
        let body = complex.body[i] as usize;
        for j in (0..n).filter(|&j| complex.body[j] as usize == body) {
            a[i][j] += 1.0 / count[body];
        }
        x[i] += centroid[body] / count[body];
    }
    for k in 0..n {
        let (done, left) = a.split_at_mut(k + 1);
        let pivot = &done[k];
        for (row, i) in left.iter_mut().zip(k + 1..) {
            let factor = row[k] / pivot[k];
            if factor != 0.0 {
                row[k..].iter_mut().zip(&pivot[k..]).for_each(|(r, p)| *r -= factor * p);
                let above = x[k];
                x[i] -= factor * above;
            }
        }
    }
    for k in (0..n).rev() {
        let below: DVec3 = (k + 1..n).map(|j| a[k][j] * x[j]).sum();
        x[k] = (x[k] - below) / a[k][k];
    }
    x
}

fn solve(complex: &Complex, importance: &[f32], from: &[Vec3A]) -> Vec<Vec3A> {
    let mut linear = from.to_vec();
    EdgeSolver::new(complex).solve(complex, importance, &mut linear);
    linear
}

/// Root mean square of what is left of the normal equations.
fn left_over(complex: &Complex, importance: &[f32], x: &[Vec3A]) -> f64 {
    let mut r = Vec::new();
    residual(complex, importance, x, &mut r);
    (r.iter().map(|r| r.as_dvec3().length_squared()).sum::<f64>() / r.len() as f64).sqrt()
}

fn furthest(a: &[Vec3A], b: &[DVec3]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a.as_dvec3() - *b).length()).fold(0.0, f64::max)
}

fn is_solved(complex: &Complex, seed: u64) -> Result<(), TestCaseError> {
    let mut random = Random(seed);
    let importance = rough(&mut random, complex.nodes(), 0.3, 5.0);
    let before = left_over(complex, &importance, &complex.rest);
    prop_assert!(complex.nodes() == 1 || before > 10.0 * EDGE_TOLERANCE, "nothing to solve: {before}");
    let linear = solve(complex, &importance, &complex.rest);
    let after = left_over(complex, &importance, &linear);
    // Twice: positions are f32, so a sum of fourteen neighbours cannot be below a few of its last places.
    prop_assert!(after < 2.0 * EDGE_TOLERANCE, "residual {after}");
    let expected = dense(complex, &importance);
    let off = furthest(&linear, &expected);
    prop_assert!(off < CLOSE, "off by {off} in {} nodes", complex.nodes());
    // From another start, the same.
    let other = rough(&mut random, complex.nodes(), 0.3, 5.0);
    let again = solve(complex, &importance, &solve(complex, &other, &complex.rest));
    let off = furthest(&again, &expected);
    prop_assert!(off < CLOSE, "off by {off} after a dab");
    Ok(())
}

proptest! {
    #![proptest_config(cases(12))]

    #[test]
    fn scattered_cells_are_solved(complex in scattered(7), seed in any::<u64>()) {
        is_solved(&complex, seed)?;
    }

    #[test]
    fn boxes_are_solved(complex in boxes_with_gaps(9), seed in any::<u64>()) {
        is_solved(&complex, seed)?;
    }

    #[test]
    fn it_is_linear_in_importance(complex in scattered(8), seed in any::<u64>(), lambda in 0.0_f32..1.0) {
        let f = rough(&mut Random(seed), complex.nodes(), 0.3, 5.0);
        let part: Vec<f32> = f.iter().map(|f| 1.0 + lambda * (f - 1.0)).collect();
        let (whole, part) = (solve(&complex, &f, &complex.rest), solve(&complex, &part, &complex.rest));
        let blend: Vec<DVec3> = complex.rest.iter().zip(&whole).map(|(v, w)| (*v + lambda * (*w - *v)).as_dvec3()).collect();
        prop_assert!(furthest(&part, &blend) < 2.0 * CLOSE);
        // Sabotage: another λ is another shape.
        let moved = furthest(&whole, &complex.rest.iter().map(|v| v.as_dvec3()).collect::<Vec<_>>());
        prop_assert!(moved > 10.0 * CLOSE || complex.nodes() <= 8, "two zeros agree: {moved}");
    }

    #[test]
    fn uniform_importance_scales(complex in scattered(8), s in 0.2_f32..6.0) {
        let linear = solve(&complex, &vec![s; complex.nodes()], &complex.rest);
        let mut centre = vec![(DVec3::ZERO, 0.0_f64); complex.bodies as usize];
        for (p, &b) in complex.rest.iter().zip(&complex.body) {
            centre[b as usize].0 += p.as_dvec3();
            centre[b as usize].1 += 1.0;
        }
        let scaled: Vec<DVec3> = complex.rest.iter().zip(&complex.body).map(|(p, &b)| {
            let centre = centre[b as usize].0 / centre[b as usize].1;
            centre + f64::from(s) * (p.as_dvec3() - centre)
        }).collect();
        prop_assert!(furthest(&linear, &scaled) < CLOSE, "{}", furthest(&linear, &scaled));
    }

    #[test]
    fn importance_one_moves_nothing(complex in scattered(8)) {
        prop_assert_eq!(&solve(&complex, &vec![1.0; complex.nodes()], &complex.rest), &complex.rest);
    }

    #[test]
    fn sabotage_one_changed_importance_is_seen(complex in scattered(6), seed in any::<u64>(), at in any::<prop::sample::Index>()) {
        let mut f = rough(&mut Random(seed), complex.nodes(), 0.3, 5.0);
        let linear = solve(&complex, &f, &complex.rest);
        f[at.index(complex.nodes())] += 1.0;
        prop_assert!(left_over(&complex, &f, &linear) > 2.0 * EDGE_TOLERANCE);
        prop_assert!(furthest(&linear, &dense(&complex, &f)) > CLOSE);
    }
}
