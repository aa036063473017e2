//! Shapes as signed distances: building blocks, smooth unions, and the way from them to a mesh.
//!
//! **Theory.** A solid is the set where a function is negative. Rounded cones and ellipsoids are the flesh, a
//! [`Loft`] (a stack of ovals along an axis) carries a measured silhouette, and a smooth union melts parts together
//! within a stated radius. The functions are near-distances: exact enough beside the surface that Newton's method
//! lands on it in a few steps, and only a bound far away.
//!
//! **Practice.** Lengths are metres. Smooth unions use the cubic kernel, whose result is twice differentiable, since
//! the eye sees a jump of curvature as a crease in the highlight.

mod loft;
mod mesh;
mod remesh;

pub use loft::{Loft, Station};
pub use mesh::{Mesh, polygonize};
pub use remesh::{Remesh, remesh};

use glam::{Mat3, Vec3};

/// A right-handed frame: where a part sits and how it is turned.
#[derive(Debug, Clone, Copy)]
pub struct Frame {
    /// The part's origin in the body's space.
    pub origin: Vec3,
    /// Columns: the part's x, y, z axes in the body's space, orthonormal.
    pub axes: Mat3,
}

impl Frame {
    /// A frame whose y axis is `along` and whose z axis is as close to `towards` as that allows.
    pub fn new(origin: Vec3, along: Vec3, towards: Vec3) -> Self {
        let y = along.normalize();
        let x = y.cross(towards).normalize();
        Self { origin, axes: Mat3::from_cols(x, y, x.cross(y)) }
    }

    /// The body's point in the part's own coordinates.
    pub fn local(&self, p: Vec3) -> Vec3 {
        self.axes.transpose() * (p - self.origin)
    }

    /// The part's point in the body's coordinates.
    pub fn world(&self, p: Vec3) -> Vec3 {
        self.origin + self.axes * p
    }
}

/// Signed distance to a ball.
pub fn ball(p: Vec3, centre: Vec3, radius: f32) -> f32 {
    p.distance(centre) - radius
}

/// Near-distance to an axis-parallel ellipsoid; exact to first order at its surface.
pub fn ellipsoid(p: Vec3, centre: Vec3, radii: Vec3) -> f32 {
    let q = (p - centre) / radii;
    let size = q.length();
    let slope = (q / radii).length();
    if slope < 1e-6 {
        return -radii.min_element();
    }
    size * (size - 1.0) / slope
}

/// Signed distance to a cone from `a` to `b` with ball ends of radii `ra`, `rb` (Quilez's round cone, by projection).
pub fn round_cone(p: Vec3, a: Vec3, b: Vec3, ra: f32, rb: f32) -> f32 {
    let axis = b - a;
    let length2 = axis.length_squared();
    let taper = ra - rb;
    let slant2 = length2 - taper * taper;
    if slant2 <= 0.0 {
        return ball(p, a, ra).min(ball(p, b, rb));
    }
    let from_a = p - a;
    let along = from_a.dot(axis);
    let radial2 = (from_a * length2 - axis * along).length_squared();
    let beyond = along - length2;
    let side = taper.signum() * taper * taper * radial2;
    if beyond.signum() * slant2 * (beyond * beyond) * length2 > side {
        return (radial2 + beyond * beyond * length2).sqrt() / length2 - rb;
    }
    if along.signum() * slant2 * (along * along) * length2 < side {
        return (radial2 + along * along * length2).sqrt() / length2 - ra;
    }
    ((radial2 * slant2 / length2).sqrt() + along * taper) / length2 - ra
}

/// Smooth union of round cones along a polyline of `(point, radius)`, melted within `melt` metres.
pub fn chain(p: Vec3, knots: &[(Vec3, f32)], melt: f32) -> f32 {
    knots
        .windows(2)
        .map(|k| round_cone(p, k[0].0, k[1].0, k[0].1, k[1].1))
        .reduce(|a, b| union(a, b, melt))
        .unwrap_or(f32::INFINITY)
}

/// Distance to round cones along a polyline, unmelted: for fine curves, whose many joints a melt would turn to beads.
pub fn tube(p: Vec3, knots: &[(Vec3, f32)]) -> f32 {
    knots.windows(2).map(|k| round_cone(p, k[0].0, k[1].0, k[0].1, k[1].1)).fold(f32::INFINITY, f32::min)
}

/// A stroke of the modelling tool: how much of it is felt at `p`, 1 on the polyline and 0 from its radii on.
pub fn stroke(p: Vec3, knots: &[(Vec3, f32)]) -> f32 {
    let near = |k: &[(Vec3, f32)]| {
        let (from, along) = (p - k[0].0, k[1].0 - k[0].0);
        let t = (from.dot(along) / along.length_squared()).clamp(0.0, 1.0);
        bump((from - along * t).length(), k[0].1 + t * (k[1].1 - k[0].1))
    };
    knots.windows(2).map(near).fold(0.0, f32::max)
}

/// A smooth curve through `(point, radius)` knots as a finer polyline: Catmull-Rom, `pieces` per span.
pub fn curve(knots: &[(Vec3, f32)], pieces: usize) -> Vec<(Vec3, f32)> {
    let Some(last) = knots.len().checked_sub(1) else { return Vec::new() };
    let at = |i: usize| knots[i.min(last)].0.extend(knots[i.min(last)].1);
    let mut fine = Vec::with_capacity(last * pieces + 1);
    for span in 0..last {
        let (before, a, b, after) = (at(span.saturating_sub(1)), at(span), at(span + 1), at(span + 2));
        for piece in 0..pieces {
            let t = piece as f32 / pieces as f32;
            let (from, to) = ((b - before) * 0.5, (after - a) * 0.5);
            let rest =
                a + from * t + (3.0 * (b - a) - 2.0 * from - to) * t * t + (2.0 * (a - b) + from + to) * t * t * t;
            fine.push((rest.truncate(), rest.w));
        }
    }
    fine.push(knots[last]);
    fine
}

/// Signed distance to a box with rounded edges, centred at the origin: half-sizes `half` include the `round`ing.
pub fn round_box(p: Vec3, half: Vec3, round: f32) -> f32 {
    let q = p.abs() - (half - round);
    q.max(Vec3::ZERO).length() + q.max_element().min(0.0) - round
}

/// Union, melted where the two are within `melt` of each other: cubic kernel, bulges by at most `melt / 6`.
pub fn union(a: f32, b: f32, melt: f32) -> f32 {
    let h = (melt - (a - b).abs()).max(0.0) / melt;
    a.min(b) - h * h * h * melt / 6.0
}

/// `a` without `b`, the edge rounded within `melt`.
pub fn cut(a: f32, b: f32, melt: f32) -> f32 {
    -union(-a, b, melt)
}

/// The common part of `a` and `b`, the edge rounded within `melt`.
pub fn common(a: f32, b: f32, melt: f32) -> f32 {
    -union(-a, -b, melt)
}

/// Both halves as the half x ≥ 0; rounded within `soft` of the mid-plane, so that no crease runs down the middle.
pub fn mirrored(p: Vec3, soft: f32) -> Vec3 {
    Vec3::new(p.x * p.x / (p.x * p.x + soft * soft).sqrt().max(f32::MIN_POSITIVE), p.y, p.z)
}

/// A bump: 1 at distance 0, 0 from `radius` on, twice differentiable.
pub fn bump(distance: f32, radius: f32) -> f32 {
    let t = (1.0 - (distance / radius).powi(2)).max(0.0);
    t * t * t
}

/// 0 below `from`, 1 above `to`, smooth between.
pub fn ramp(value: f32, from: f32, to: f32) -> f32 {
    let t = ((value - from) / (to - from)).clamp(0.0, 1.0);
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

/// The gradient of a field at `p` by central differences over a tetrahedron; `step` in metres.
pub fn gradient(field: &impl Fn(Vec3) -> f32, p: Vec3, step: f32) -> Vec3 {
    const CORNERS: [Vec3; 4] =
        [Vec3::new(1.0, -1.0, -1.0), Vec3::new(-1.0, -1.0, 1.0), Vec3::new(-1.0, 1.0, -1.0), Vec3::new(1.0, 1.0, 1.0)];
    CORNERS.iter().map(|&c| c * field(p + c * step)).sum::<Vec3>() / (4.0 * step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn round_cone_measures_the_distance() {
        let (a, b) = (Vec3::ZERO, Vec3::new(0.0, 2.0, 0.0));
        assert!((round_cone(Vec3::new(3.0, 1.0, 0.0), a, b, 0.5, 0.5) - 2.5).abs() < 1e-5);
        assert!((round_cone(Vec3::new(0.0, -2.0, 0.0), a, b, 0.5, 0.2) - 1.5).abs() < 1e-5);
        assert!((round_cone(Vec3::new(0.0, 4.0, 0.0), a, b, 0.5, 0.2) - 1.8).abs() < 1e-5);
    }

    #[test]
    fn union_is_plain_far_apart_and_fuller_close_by() {
        assert_eq!(union(0.1, 0.9, 0.2), 0.1);
        assert!(union(0.1, 0.1, 0.2) < 0.1);
    }

    #[test]
    fn frame_goes_there_and_back() {
        let f = Frame::new(Vec3::new(0.1, 1.0, 0.2), Vec3::new(0.6, -0.7, 0.1), Vec3::Z);
        let p = Vec3::new(0.3, 0.4, -0.2);
        assert!(f.world(f.local(p)).distance(p) < 1e-6);
        assert!((f.axes.determinant() - 1.0).abs() < 1e-5);
    }
}
