//! A dab of importance: a sphere with a smooth edge.

use glam::DVec3;

/// A sphere, ready to be evaluated.
#[derive(Debug, Clone)]
pub(super) struct Sphere {
    /// Source units.
    pub centre: DVec3,
    /// Source units, > 0.
    pub radius: f64,
    /// ln of the importance at the centre.
    pub ln_value: f64,
}

impl Sphere {
    /// `ln f` at `point`, where it is `below` without this sphere: f ← f^(1−w) · value^w.
    pub fn over(&self, below: f64, point: DVec3) -> f64 {
        let weight = falloff(point.distance(self.centre) / self.radius);
        below + weight * (self.ln_value - below)
    }
}

/// Weight at `t` radii from the centre: 1 − t³(10 − 15t + 6t²), and 0 from the radius on.
///
/// First and second derivative vanish at both ends, so importance has no crease at the centre or the rim (C²). A crease
/// in importance is a crease in the warped surface.
pub fn falloff(t: f64) -> f64 {
    if t >= 1.0 {
        return 0.0;
    }
    let t = t.max(0.0);
    1.0 - t * t * t * (10.0 - 15.0 * t + 6.0 * t * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest jump of the second derivative (by central differences) between neighbouring points across 0..1.2 radii,
    /// the function continued to the other side of the centre.
    fn roughness(f: impl Fn(f64) -> f64) -> f64 {
        let step = 1e-3;
        let second = |t: f64| (f((t - step).abs()) - 2.0 * f(t.abs()) + f((t + step).abs())) / (step * step);
        (0..1200).map(|i| (second(f64::from(i + 1) * step) - second(f64::from(i) * step)).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn falls_from_one_to_nothing() {
        assert_eq!(falloff(0.0), 1.0);
        assert_eq!(falloff(1.0), 0.0);
        assert_eq!(falloff(7.0), 0.0);
        assert!((falloff(0.5) - 0.5).abs() < 1e-12);
        assert!((1..100).all(|i| falloff(f64::from(i) / 100.0) < falloff(f64::from(i - 1) / 100.0)));
    }

    // The third derivative is at most 60, so the second changes by at most 0.06 over a step of 1e-3; 0.1 leaves room.
    #[test]
    fn has_no_crease() {
        assert!(roughness(falloff) < 0.1, "{}", roughness(falloff));
    }

    #[test]
    fn sabotage_a_crease_is_seen() {
        assert!(roughness(|t| (1.0 - t).max(0.0)) > 0.1, "a cone has a crease");
        assert!(roughness(|t| (1.0 - t * t).max(0.0).powi(2)) > 0.1, "C1 is not enough");
    }

    #[test]
    fn blends_in_the_logarithm() {
        let sphere = Sphere { centre: DVec3::X, radius: 2.0, ln_value: 4f64.ln() };
        assert_eq!(sphere.over(0.3, DVec3::X), 4f64.ln());
        assert_eq!(sphere.over(0.3, DVec3::new(3.0, 0.0, 0.0)), 0.3);
        let half = sphere.over(0.0, DVec3::new(2.0, 0.0, 0.0)).exp();
        assert!((half - 2.0).abs() < 1e-12, "half-way from 1 to 4 in the logarithm is 2, not {half}");
    }
}
