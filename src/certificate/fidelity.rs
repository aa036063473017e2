//! Fidelity: size asked for against size achieved; and how far elements are from similar.

use glam::{DMat3, DVec3, Vec3A};
use rayon::prelude::*;

use crate::voxel::{Complex, Dimension};

/// The size error of a state. Per element `s = (det F)^(1/d)`, `e = max(s/f, f/s) − 1`; elements have equal rest volume.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Fidelity {
    /// μ it was solved with.
    pub mu: f32,
    /// Median of e.
    pub median: f64,
    /// 95th percentile of e.
    pub p95: f64,
    /// Largest e.
    pub max: f64,
    /// Per named region, in the input's order.
    pub regions: Vec<RegionFidelity>,
}

/// Asked and achieved mean size of one region: cube root (in the plane square root) of the mean volume (area) ratio over
/// its elements.
#[derive(Debug, Clone, PartialEq)]
pub struct RegionFidelity {
    /// The region's name.
    pub name: String,
    /// Size factor asked for.
    pub asked: f64,
    /// Size factor achieved.
    pub achieved: f64,
}

/// Conformal distortion σ_max / σ_min of the elements, 1 = similar to rest.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Distortion {
    /// Median.
    pub median: f64,
    /// 95th percentile.
    pub p95: f64,
    /// 99th percentile.
    pub p99: f64,
}

/// Cells per parallel task.
const CELLS_PER_TASK: usize = 512;

/// `[elements]` volume ratio det F of a state, in the plane the ratio of areas.
pub fn volume_ratios(complex: &Complex, positions: &[Vec3A]) -> Vec<f32> {
    per_element(complex, positions, |f| f.determinant() as f32)
}

fn per_element<T: Send>(complex: &Complex, positions: &[Vec3A], value: impl Fn(DMat3) -> T + Sync) -> Vec<T> {
    let (value, elements) = (&value, complex.dimension.elements());
    complex
        .corners
        .par_iter()
        .with_min_len(CELLS_PER_TASK)
        .flat_map_iter(|corners| {
            let at = corners.map(|c| positions[c as usize].as_dvec3());
            elements.iter().map(move |&[a, b, c, d]| {
                // At rest b − a, c − b, d − c are axes up to order and sign, so F is put together from them. In the plane
                // the third axis keeps its length.
                let mut f = DMat3::IDENTITY;
                let mut path = [a, b, c, d];
                path.sort_unstable_by_key(|k| k.count_ones());
                for step in path.windows(2).filter(|step| step[0] != step[1]) {
                    *f.col_mut((step[1] ^ step[0]).trailing_zeros() as usize) = at[step[1]] - at[step[0]];
                }
                value(f)
            })
        })
        .collect()
}

/// Size errors of a state. `asked` is `[cells]`; `region_of_cell` is `[cells]` or empty, `u32::MAX` for none.
pub fn fidelity(
    complex: &Complex,
    asked: &[f32],
    positions: &[Vec3A],
    mu: f32,
    names: &[String],
    region_of_cell: &[u32],
) -> Fidelity {
    let volumes = volume_ratios(complex, positions);
    let (dimension, per_cell) = (complex.dimension, complex.dimension.elements().len());
    let mut errors: Vec<f64> = volumes
        .par_iter()
        .enumerate()
        .with_min_len(per_cell * CELLS_PER_TASK)
        .map(|(t, &volume)| {
            let (s, f) = (dimension.size(f64::from(volume.max(0.0))), f64::from(asked[t / per_cell]));
            if s > 0.0 { (s / f).max(f / s) - 1.0 } else { f64::INFINITY }
        })
        .collect();
    let mut sums = vec![[0.0_f64; 3]; names.len()];
    for (cell, &region) in region_of_cell.iter().enumerate() {
        if let Some(sum) = sums.get_mut(region as usize) {
            let elements = per_cell * cell..per_cell * (cell + 1);
            sum[0] += per_cell as f64;
            sum[1] += per_cell as f64 * f64::from(dimension.measure(asked[cell]));
            sum[2] += volumes[elements].iter().map(|&v| f64::from(v)).sum::<f64>();
        }
    }
    let regions = names
        .iter()
        .zip(&sums)
        .filter(|(_, s)| s[0] > 0.0)
        .map(|(name, s)| RegionFidelity {
            name: name.clone(),
            asked: dimension.size(s[1] / s[0]),
            achieved: dimension.size(s[2] / s[0]),
        })
        .collect();
    let [median, p95, max] = quantiles(&mut errors, [0.5, 0.95, 1.0]);
    Fidelity { mu, median, p95, max, regions }
}

/// Conformal distortion of a state.
pub fn distortion(complex: &Complex, positions: &[Vec3A]) -> Distortion {
    let mut ratios = per_element(complex, positions, |f| {
        let square = f.transpose() * f;
        let [low, high] = match complex.dimension {
            Dimension::Two => flat_eigenvalues(square),
            Dimension::Three => extreme_eigenvalues(square),
        };
        if low > 0.0 { (high / low).sqrt() } else { f64::INFINITY }
    });
    let [median, p95, p99] = quantiles(&mut ratios, [0.5, 0.95, 0.99]);
    Distortion { median, p95, p99 }
}

fn quantiles(values: &mut [f64], at: [f64; 3]) -> [f64; 3] {
    at.map(|q| {
        let rank = ((values.len().max(1) - 1) as f64 * q).round() as usize;
        if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(rank, f64::total_cmp).1 }
    })
}

/// Eigenvalues of the upper left 2 × 2 block of a symmetric matrix, least first.
fn flat_eigenvalues(m: DMat3) -> [f64; 2] {
    let (mean, half) = ((m.x_axis.x + m.y_axis.y) / 2.0, (m.x_axis.x - m.y_axis.y) / 2.0);
    let radius = half.hypot(m.x_axis.y);
    [mean - radius, mean + radius]
}

/// Least and largest eigenvalue of a symmetric matrix (Smith 1961).
fn extreme_eigenvalues(m: DMat3) -> [f64; 2] {
    let mean = (m.x_axis.x + m.y_axis.y + m.z_axis.z) / 3.0;
    let diagonal = DVec3::new(m.x_axis.x, m.y_axis.y, m.z_axis.z) - mean;
    let off = DVec3::new(m.x_axis.y, m.y_axis.z, m.z_axis.x);
    let p = ((diagonal.length_squared() + 2.0 * off.length_squared()) / 6.0).sqrt();
    if p < 1.0e-12 {
        return [mean, mean];
    }
    let half = ((m - DMat3::from_diagonal(DVec3::splat(mean))) * (1.0 / p)).determinant() / 2.0;
    let angle = half.clamp(-1.0, 1.0).acos() / 3.0;
    [mean + 2.0 * p * (angle + std::f64::consts::TAU / 3.0).cos(), mean + 2.0 * p * angle.cos()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::voxel::Grid;
    use glam::UVec3;

    #[test]
    fn a_linear_map_has_its_own_volume_and_distortion() {
        let grid = Grid { origin: DVec3::ZERO, cell_size: 1.0, cells: UVec3::splat(2) };
        let complex = Complex::from_cells(grid, &[true; 8]);
        let positions: Vec<Vec3A> = complex.rest.iter().map(|p| *p * Vec3A::new(1.0, 2.0, 4.0)).collect();
        assert!(volume_ratios(&complex, &positions).iter().all(|v| (v - 8.0).abs() < 1e-5));
        let d = distortion(&complex, &positions);
        assert!((d.p99 - 4.0).abs() < 1e-9, "{d:?}");
        let f = fidelity(&complex, &[2.0; 8], &positions, 0.5, &["all".into()], &[0; 8]);
        assert!(f.max < 1e-6 && (f.regions[0].achieved - 2.0).abs() < 1e-6, "{f:?}");
        let off = fidelity(&complex, &[1.0; 8], &positions, 0.5, &[], &[]);
        assert!((off.median - 1.0).abs() < 1e-6, "{off:?}");
    }
}
