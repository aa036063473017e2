//! A dab of importance: a sphere with a smooth edge, in a picture a disc.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::field::Pixels;
use super::stack::{OnSurface, Place, Surface};
use crate::boundary::Boundary;
use crate::{Error, Result};

/// The dab on a surface.
pub(super) fn on_surface(centre: [f64; 3], radius: f64, value: f32, surface: &mut Surface) -> Result<Sphere> {
    let centre = DVec3::from_array(centre);
    if !(centre.is_finite() && radius > 0.0 && radius.is_finite()) {
        let sentence = format!("sphere at {centre}: the centre must be finite and the radius {radius} > 0");
        return Err(Error::input(sentence));
    }
    let Surface { boundary, reading, .. } = surface;
    let value = reading.admit(value, || format!("sphere at {centre}"))?;
    let sphere = Sphere { centre, radius, ln_value: f64::from(value).ln() };
    if !sphere.touches(&boundary.positions, &boundary.triangles) {
        let sentence = format!("sphere at {centre}: nothing of the surface lies within its radius {radius}");
        reading.warnings.push(sentence);
    }
    Ok(sphere)
}

/// The dab in a picture: its third coordinate means nothing.
pub(super) fn on_pixels([x, y, _]: [f64; 3], radius: f64, value: f32, pixels: &mut Pixels) -> Result<()> {
    let centre = DVec2::new(x, y);
    if !(centre.is_finite() && radius > 0.0 && radius.is_finite()) {
        let sentence = format!("disc at {centre}: the centre must be finite and the radius {radius} > 0");
        return Err(Error::input(sentence));
    }
    let value = f64::from(pixels.reading.admit(value, || format!("disc at {centre}"))?);
    let (domain, width) = (&pixels.picture.domain, pixels.picture.size.x as usize);
    let weight = |index: usize| {
        let place = DVec2::new((index % width) as f64 + 0.5, (index / width) as f64 + 0.5);
        falloff(place.distance(centre) / radius)
    };
    if !(0..domain.len()).into_par_iter().any(|index| domain[index] && weight(index) > 0.0) {
        let sentence = format!("disc at {centre}: nothing of the body lies within its radius {radius}");
        pixels.reading.warnings.push(sentence);
    }
    pixels.blend(|index, below| below + weight(index) * (value.ln() - below));
    Ok(())
}

/// A sphere, ready to be evaluated.
#[derive(Debug, Clone)]
pub(super) struct Sphere {
    /// Source units.
    centre: DVec3,
    /// Source units, > 0.
    radius: f64,
    /// ln of the importance at the centre.
    ln_value: f64,
}

impl Sphere {
    /// `ln f` at `point`, where it is `below` without this sphere: f ← f^(1−w) · value^w.
    fn at(&self, below: f64, point: DVec3) -> f64 {
        let weight = falloff(point.distance(self.centre) / self.radius);
        below + weight * (self.ln_value - below)
    }

    /// Whether any of these triangles comes within the radius.
    fn touches(&self, positions: &[DVec3], triangles: &[[u32; 3]]) -> bool {
        triangles.par_iter().any(|corners| {
            let corners = corners.map(|vertex| positions[vertex as usize]);
            closest_point(corners, self.centre).distance(self.centre) < self.radius
        })
    }
}

impl OnSurface for Sphere {
    fn over(&self, below: f64, _: &Boundary, place: &Place) -> f64 {
        self.at(below, place.position)
    }
}

/// The point of a triangle closest to `p` (Ericson, *Real-Time Collision Detection*, 5.1.5): the region of the plane that
/// `p` projects to, told from the signs of barycentric numerators, says whether a corner, an edge or the inside is closest.
fn closest_point([a, b, c]: [DVec3; 3], p: DVec3) -> DVec3 {
    let (ab, ac) = (b - a, c - a);
    let from = |corner: DVec3| (ab.dot(p - corner), ac.dot(p - corner));
    let ((d1, d2), (d3, d4), (d5, d6)) = (from(a), from(b), from(c));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let (va, vb, vc) = (d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2);
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + ab * (d1 / (d1 - d3));
    }
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + ac * (d2 / (d2 - d6));
    }
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
    }
    a + (ab * vb + ac * vc) / (va + vb + vc)
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
        assert_eq!(sphere.at(0.3, DVec3::X), 4f64.ln());
        assert_eq!(sphere.at(0.3, DVec3::new(3.0, 0.0, 0.0)), 0.3);
        let half = sphere.at(0.0, DVec3::new(2.0, 0.0, 0.0)).exp();
        assert!((half - 2.0).abs() < 1e-12, "half-way from 1 to 4 in the logarithm is 2, not {half}");
    }

    #[test]
    fn touches_faces_edges_and_corners() {
        let corners = [DVec3::ZERO, DVec3::X * 4.0, DVec3::Y * 4.0];
        let cases = [
            ((1.0, 1.0, 0.5), 0.5),
            ((3.0, 3.0, 0.0), 2f64.sqrt()),
            ((2.0, -1.0, 0.0), 1.0),
            ((-1.0, 2.0, 0.0), 1.0),
            ((-3.0, -4.0, 0.0), 5.0),
            ((7.0, -4.0, 0.0), 5.0),
            ((-4.0, 7.0, 0.0), 5.0),
        ];
        for (centre, distance) in cases {
            let sphere = |radius| Sphere { centre: centre.into(), radius, ln_value: 0.0 };
            assert!(sphere(distance * 1.001).touches(&corners, &[[0, 1, 2]]), "{centre:?}");
            assert!(!sphere(distance * 0.999).touches(&corners, &[[0, 1, 2]]), "{centre:?}");
        }
        let point = Sphere { centre: DVec3::ONE, radius: 2.0, ln_value: 0.0 };
        assert!(point.touches(&corners, &[[0, 0, 0]]), "a triangle without area is a point");
    }
}
