//! Local step: what each cell would like to be.
//!
//! `F_c = (Σ_e Δ'_e Δ_eᵀ)(Σ_e Δ_e Δ_eᵀ)⁻¹` over the 19 edges of the cell, `R_c` its rotation (Müller et al. 2016, from
//! the last one), `s_c = 1 + λ (f_c − 1)` the size asked for, and the target
//! `A_c = (1 − μ) s_c R_c + μ P_c` with `P_c` the matrix nearest to `F_c` whose determinant is `s_c³`.

use glam::{Mat3A, Quat, Vec2, Vec3A};

use crate::voxel::Dimension;

/// `b_k = Σ (X_k − X_o)` over the cell's edges at corner k: gathers `A_c Δ_e` to corners and differences to `F_c`.
const CORNER: [Vec3A; 8] = corner_vectors(8);

/// The same for the five edges of a flat cell.
const FLAT_CORNER: [Vec3A; 8] = corner_vectors(4);

/// `b_k` of a dimension's cells.
#[inline]
pub(super) const fn corner_gather(dimension: Dimension) -> &'static [Vec3A; 8] {
    match dimension {
        Dimension::Two => &FLAT_CORNER,
        Dimension::Three => &CORNER,
    }
}

const fn corner_vectors(corners: usize) -> [Vec3A; 8] {
    let mut sums = [[0_i32; 3]; 8];
    let mut k = 0;
    while k < corners {
        let mut d = 1;
        while d < corners {
            if k & d == 0 {
                let mut axis = 0;
                while axis < 3 {
                    let bit = (d >> axis & 1) as i32;
                    sums[k][axis] -= bit;
                    sums[k | d][axis] += bit;
                    axis += 1;
                }
            }
            d += 1;
        }
        k += 1;
    }
    let mut out = [Vec3A::ZERO; 8];
    let mut k = 0;
    while k < 8 {
        out[k] = Vec3A::new(sums[k][0] as f32, sums[k][1] as f32, sums[k][2] as f32);
        k += 1;
    }
    out
}

/// The deformation gradient of a cell from its eight corners, in least squares over its edges.
///
/// `Σ Δ Δᵀ = 6 I + 3 J` with J all ones, so its inverse is `(I − J / 5) / 6`.
#[inline]
pub fn gradient(corners: [Vec3A; 8]) -> Mat3A {
    let (mut x, mut y, mut z) = (Vec3A::ZERO, Vec3A::ZERO, Vec3A::ZERO);
    for (p, b) in corners.into_iter().zip(CORNER) {
        x += p * b.x;
        y += p * b.y;
        z += p * b.z;
    }
    let mean = (x + y + z) * (1.0 / 5.0);
    Mat3A::from_cols((x - mean) * (1.0 / 6.0), (y - mean) * (1.0 / 6.0), (z - mean) * (1.0 / 6.0))
}

/// Iterations of the rotation; from the last state one or two suffice, an inverted cell needs more.
const ROTATION_ITERATIONS: usize = 6;

/// The rotation nearest to `f`, starting from `q` (Müller, Bender, Chentanez, Macklin 2016). Recovers from inversion.
#[inline]
pub fn rotation(f: &Mat3A, mut q: Quat) -> Quat {
    for _ in 0..ROTATION_ITERATIONS {
        let r = Mat3A::from_quat(q);
        let turn = r.x_axis.cross(f.x_axis) + r.y_axis.cross(f.y_axis) + r.z_axis.cross(f.z_axis);
        let stretch = r.x_axis.dot(f.x_axis) + r.y_axis.dot(f.y_axis) + r.z_axis.dot(f.z_axis);
        let omega = turn / (stretch.abs() + 1.0e-9);
        let size = omega.length_squared();
        // Half the angle as a quaternion's vector part; capped, since tan runs away for half turns.
        let half = omega * (0.5 / (1.0 + 0.25 * size).sqrt());
        q = (Quat::from_xyzw(half.x, half.y, half.z, 1.0) * q).normalize();
        if size < 1.0e-8 {
            break;
        }
    }
    q
}

/// Newton steps of the projection; three bring a factor of two in volume to 1e-4.
const PROJECTION_STEPS: usize = 4;

/// The matrix nearest to `f` (Frobenius) with determinant `volume` > 0, by sequential quadratic steps
/// `P ← F + κ cof(P)`; falls back to a scaled rotation `shape` where `f` is too flat or inverted for that.
#[inline]
pub fn with_determinant(f: &Mat3A, volume: f32, shape: &Mat3A) -> Mat3A {
    let cofactor =
        |m: &Mat3A| Mat3A::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis));
    let dot = |a: &Mat3A, b: &Mat3A| a.x_axis.dot(b.x_axis) + a.y_axis.dot(b.y_axis) + a.z_axis.dot(b.z_axis);
    let mut p = *f;
    let det = f.determinant();
    if det.is_nan() || det <= 0.05 * volume {
        return *shape;
    }
    // Start on the surface along the ray: right for pure scaling, near for the rest.
    p *= (volume / det).cbrt();
    for _ in 0..PROJECTION_STEPS {
        let c = cofactor(&p);
        let size = dot(&c, &c);
        let det = p.x_axis.dot(c.x_axis);
        let difference = p - *f;
        let kappa = (volume - det + dot(&c, &difference)) / size;
        p = *f + c * kappa;
    }
    let det = p.determinant();
    if !(0.5 * volume..2.0 * volume).contains(&det) {
        return *shape;
    }
    p
}

/// The target of one cell: `A_c`, and the rotation to start from next time.
#[inline]
pub fn target(corners: [Vec3A; 8], q: Quat, size: f32, fidelity: f32) -> (Mat3A, Quat) {
    let f = gradient(corners);
    let q = rotation(&f, q);
    let shape = Mat3A::from_quat(q) * size;
    if fidelity == 0.0 {
        return (shape, q);
    }
    let volume = with_determinant(&f, size * size * size, &shape);
    (shape * (1.0 - fidelity) + volume * fidelity, q)
}

/// The target of one flat cell; its rotation is found at once and needs no start.
///
/// `F = (Σ_e Δ'_e Δ_eᵀ)(Σ_e Δ_e Δ_eᵀ)⁻¹` over five edges, where `Σ Δ Δᵀ = 2 I + J` with inverse `(I − J / 4) / 2`. A map
/// of the plane is the sum of a conformal part `(a, b)` and an anticonformal one `(c, d)`, and its determinant is
/// `|conformal|² − |anticonformal|²`. Of the nearest map with the asked area the anticonformal part is shortened a little
/// and the conformal one made good for it: the area stays what is asked, and shear that nothing needs dies out.
#[inline]
pub fn flat_target(corners: [Vec3A; 8], size: f32, fidelity: f32) -> Mat3A {
    let (mut x, mut y) = (Vec3A::ZERO, Vec3A::ZERO);
    for (p, b) in corners.into_iter().zip(FLAT_CORNER).take(4) {
        x += p * b.x;
        y += p * b.y;
    }
    let mean = (x + y) * 0.25;
    let (x, y) = ((x - mean) * 0.5, (y - mean) * 0.5);
    let conformal = Vec2::new(x.x + y.y, x.y - y.x) * 0.5;
    let anticonformal = Vec2::new(x.x - y.y, x.y + y.x) * 0.5;
    let turn = conformal.try_normalize().unwrap_or(Vec2::X);
    let kappa = flat_kappa(conformal.length_squared(), anticonformal.length_squared(), size * size);
    let anticonformal = anticonformal * (FLAT_SHEAR_KEPT / (1.0 + kappa));
    let anticonformal = anticonformal.clamp_length_max(MOST_SHEAR * size);
    let conformal = turn * (size * size + anticonformal.length_squared()).sqrt();
    let conformal = turn * size * (1.0 - fidelity) + conformal * fidelity;
    let anticonformal = anticonformal * fidelity;
    Mat3A::from_cols(
        Vec3A::new(conformal.x + anticonformal.x, conformal.y + anticonformal.y, 0.0),
        Vec3A::new(anticonformal.y - conformal.y, conformal.x - anticonformal.x, 0.0),
        Vec3A::ZERO,
    )
}

/// Part of the anticonformal part that is kept in each iteration at μ = 1. At 1 a population cartogram of 49 states had a
/// conformal distortion of p95 9.4, at 0.95 of 5.0, at 0.9 of 4.0; below, areas within regions give way (size error p95 6.6,
/// 7.5 and 9.8 %).
const FLAT_SHEAR_KEPT: f32 = 0.95;

/// The anticonformal part of a target is at most this many sizes long: a conformal distortion of five, as
/// `(√5 − 1/√5) / 2`. Cells that are squeezed further push back, before they are so flat that the guard must hold them.
const MOST_SHEAR: f32 = 0.9;

/// Newton steps for κ, kept within the bracket: more than rounding needs.
const KAPPA_STEPS: usize = 8;

/// κ of the nearest map with determinant `area` > 0. `P = F + κ cof(P)` divides the conformal part (square `conformal`)
/// by 1 − κ and the anticonformal one by 1 + κ; `conformal / (1 − κ)² − anticonformal / (1 + κ)² = area` rises with κ in
/// (−1, 1) and has one root there.
#[inline]
fn flat_kappa(conformal: f32, anticonformal: f32, area: f32) -> f32 {
    // Kept off the ends, where the parts would be divided by zero: sizes change by at most a factor of ten at a time.
    const END: f32 = 0.9;
    let (mut low, mut high) = (-END, END);
    // Without the anticonformal part the root is exact.
    let mut kappa = (1.0 - (conformal / area).sqrt()).clamp(low, high);
    for _ in 0..KAPPA_STEPS {
        let (a, c) = (1.0 / (1.0 - kappa), 1.0 / (1.0 + kappa));
        let error = conformal * a * a - anticonformal * c * c - area;
        if error.abs() <= 1.0e-6 * area {
            break;
        }
        if error > 0.0 {
            high = kappa;
        } else {
            low = kappa;
        }
        let slope = 2.0 * (conformal * a * a * a + anticonformal * c * c * c);
        let next = kappa - error / slope.max(f32::MIN_POSITIVE);
        kappa = if next > low && next < high { next } else { 0.5 * (low + high) };
    }
    kappa
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::voxel::{DIRECTIONS, KUHN};

    /// The nearest map of which a target at μ = 1 was made.
    fn sheared(p: Mat3A, size: f32) -> Mat3A {
        let anticonformal = Vec2::new(p.x_axis.x - p.y_axis.y, p.x_axis.y + p.y_axis.x) * (0.5 / FLAT_SHEAR_KEPT);
        let turn = Vec2::new(p.x_axis.x + p.y_axis.y, p.x_axis.y - p.y_axis.x).normalize();
        let conformal = turn * (size * size + anticonformal.length_squared()).sqrt();
        Mat3A::from_cols(
            Vec3A::new(conformal.x + anticonformal.x, conformal.y + anticonformal.y, 0.0),
            Vec3A::new(anticonformal.y - conformal.y, conformal.x - anticonformal.x, 0.0),
            Vec3A::ZERO,
        )
    }

    #[test]
    fn a_flat_target_has_the_asked_area_and_comes_of_the_nearest_map() {
        let maps =
            [[[1.2, 0.3], [-0.2, 0.9]], [[1.0, 0.0], [0.0, 1.0]], [[2.0, 0.1], [0.0, 0.2]], [[0.3, -0.9], [1.1, 0.2]]];
        for [x, y] in maps {
            let (x, y) = (Vec3A::new(x[0], x[1], 0.0), Vec3A::new(y[0], y[1], 0.0));
            let corners = std::array::from_fn(|k| x * (k & 1) as f32 + y * (k >> 1 & 1) as f32);
            for size in [0.7_f32, 1.0, 1.4] {
                let p = flat_target(corners, size, 1.0);
                let det = p.x_axis.x * p.y_axis.y - p.x_axis.y * p.y_axis.x;
                assert!((det - size * size).abs() < 1e-4, "{x} {y} {size}: {det}");
                if (p.x_axis + Vec3A::new(-p.y_axis.y, p.y_axis.x, 0.0)).length() > 2.0 * 0.999 * MOST_SHEAR * size {
                    continue; // Squeezed further than is let be.
                }
                // Undo what dies out; the rest is nearest: P − F is parallel to the cofactors of P.
                let p = sheared(p, size);
                let cofactor = [Vec3A::new(p.y_axis.y, -p.y_axis.x, 0.0), Vec3A::new(-p.x_axis.y, p.x_axis.x, 0.0)];
                let off = [p.x_axis - x, p.y_axis - y];
                let along = (off[0].dot(cofactor[0]) + off[1].dot(cofactor[1]))
                    / (cofactor[0].length_squared() + cofactor[1].length_squared());
                for k in 0..2 {
                    assert!((off[k] - along * cofactor[k]).length() < 1e-3, "{x} {y} {size}");
                }
                let shape = flat_target(corners, size, 0.0);
                assert!((shape.x_axis.length() - size).abs() < 1e-5 && shape.x_axis.dot(shape.y_axis).abs() < 1e-5);
            }
        }
    }

    fn cell(m: Mat3A) -> [Vec3A; 8] {
        std::array::from_fn(|k| m * Vec3A::new((k & 1) as f32, (k >> 1 & 1) as f32, (k >> 2 & 1) as f32))
    }

    #[test]
    fn the_gradient_of_a_linear_map_is_the_map() {
        assert_eq!(KUHN.len(), 6);
        assert_eq!(DIRECTIONS.len(), 7);
        let m = Mat3A::from_cols(Vec3A::new(1.0, 2.0, 3.0), Vec3A::new(-1.0, 0.5, 0.0), Vec3A::new(0.3, 0.2, 2.0));
        assert!(gradient(cell(m)).abs_diff_eq(m, 1e-5));
    }

    #[test]
    fn the_projection_has_the_asked_determinant_and_is_nearest() {
        let f = Mat3A::from_cols(Vec3A::new(1.2, 0.1, 0.0), Vec3A::new(0.3, 0.9, 0.1), Vec3A::new(0.0, -0.2, 1.1));
        for volume in [0.4, 1.0, 3.0] {
            let p = with_determinant(&f, volume, &Mat3A::IDENTITY);
            assert!((p.determinant() - volume).abs() < 2e-3 * volume, "{volume}: {}", p.determinant());
            // Nearest: P − F is parallel to the gradient of the determinant at P.
            let c = Mat3A::from_cols(p.y_axis.cross(p.z_axis), p.z_axis.cross(p.x_axis), p.x_axis.cross(p.y_axis));
            let d = p - f;
            let k = d.x_axis.x / c.x_axis.x;
            assert!(d.abs_diff_eq(c * k, 5e-3), "{volume}");
        }
    }

    #[test]
    fn the_rotation_is_found_from_afar_and_through_inversion() {
        let wanted = Quat::from_axis_angle(glam::Vec3::new(1.0, 2.0, -1.0).normalize(), 2.0);
        let f = Mat3A::from_quat(wanted) * Mat3A::from_diagonal(glam::Vec3::new(1.0, 1.5, 0.7));
        let mut q = Quat::IDENTITY;
        for _ in 0..8 {
            q = rotation(&f, q);
        }
        assert!(q.dot(wanted).abs() > 0.9999);
        let inverted = Mat3A::from_diagonal(glam::Vec3::new(1.0, 1.0, -0.2));
        assert!(rotation(&inverted, Quat::IDENTITY).is_finite());
    }
}
