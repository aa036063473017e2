//! Where the camera stands so that everything fits: one distance for the whole film, so that growth is seen as growth.

use bevy::math::{EulerRot, Quat, Vec2, Vec3};

/// Space around the actor, as a factor of the distance.
const MARGIN: f32 = 1.07;

/// Rounds of centring; each leaves a hundredth of the error.
const ROUNDS: usize = 4;

/// A camera's place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Lens {
    /// What it looks at, view space.
    pub target: Vec3,
    /// From there.
    pub distance: f32,
}

/// How the camera sees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sight<'a> {
    /// Directions it looks from during the film, radians; one for a camera that stands still.
    pub yaws: &'a [f32],
    /// Height above the horizon, radians.
    pub pitch: f32,
    /// Full vertical opening, radians.
    pub opening: f32,
    /// Width over height of the picture.
    pub aspect: f32,
}

impl Sight<'_> {
    /// Camera from world.
    fn turned(&self, yaw: f32) -> Quat {
        Quat::from_euler(EulerRot::YXZ, yaw, -self.pitch, 0.0).inverse()
    }

    /// The nearest place from which all points are seen. A camera that stands still is centred on them; one that goes around
    /// keeps the axis x = z = 0 in the middle, and is centred in height.
    pub fn fit(&self, points: &[Vec3]) -> Lens {
        let (low, high) =
            points.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)));
        if !(low.is_finite() && high.is_finite()) {
            return Lens { target: Vec3::Y, distance: 5.0 };
        }
        let stands = self.yaws.len() == 1;
        let middle = 0.5 * (low + high);
        let mut target = if stands { middle } else { Vec3::new(0.0, middle.y, 0.0) };
        let mut distance = self.distance(points, target);
        for _ in 0..ROUNDS {
            let shift = self.off_centre(points, target, distance);
            let turned = self.turned(self.yaws[0]).inverse();
            target += turned * Vec3::new(if stands { shift.x } else { 0.0 }, 0.0, 0.0) + Vec3::Y * shift.y;
            distance = self.distance(points, target);
        }
        Lens { target, distance: (MARGIN * distance).max(1.0e-2) }
    }

    /// How far away all points are within the picture.
    fn distance(&self, points: &[Vec3], target: Vec3) -> f32 {
        let tangent = (0.5 * self.opening).tan();
        let mut distance = 0.0_f32;
        for turned in self.yaws.iter().map(|&yaw| self.turned(yaw)) {
            for &point in points {
                let p = turned * (point - target);
                distance = distance.max(p.y.abs().max(p.x.abs() / self.aspect) / tangent + p.z);
            }
        }
        distance
    }

    /// The middle of what is seen, at the target's depth, in view units.
    fn off_centre(&self, points: &[Vec3], target: Vec3, distance: f32) -> Vec2 {
        let (mut low, mut high) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        for turned in self.yaws.iter().map(|&yaw| self.turned(yaw)) {
            for &point in points {
                let p = turned * (point - target);
                let seen = p.truncate() * (distance / (distance - p.z).max(1.0e-3));
                (low, high) = (low.min(seen), high.max(seen));
            }
        }
        0.5 * (low + high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Corners of a box that stands beside the axis.
    fn points() -> Vec<Vec3> {
        let at = |k: usize, a: f32, b: f32| if k & 1 == 0 { a } else { b };
        (0..8).map(|k| Vec3::new(at(k, 0.2, 1.0), at(k >> 1, 0.0, 2.0), at(k >> 2, -0.3, 0.1))).collect()
    }

    /// Least and greatest coordinate in the picture, ±1 at its edges.
    fn seen(sight: &Sight, lens: Lens) -> (Vec2, Vec2) {
        let tangent = (0.5 * sight.opening).tan();
        let all = sight.yaws.iter().flat_map(|&yaw| {
            points().into_iter().map(move |point| {
                let p = sight.turned(yaw) * (point - lens.target);
                Vec2::new(p.x / sight.aspect, p.y) / ((lens.distance - p.z) * tangent)
            })
        });
        all.fold((Vec2::INFINITY, Vec2::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)))
    }

    #[test]
    fn everything_is_seen_and_fills_the_picture() {
        for (yaws, pitch, aspect) in
            [(&[0.0][..], 0.0, 1.5), (&[0.6], 0.4, 0.5), (&[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0], 0.2, 1.0)]
        {
            let sight = Sight { yaws, pitch, opening: 0.45, aspect };
            let (low, high) = seen(&sight, sight.fit(&points()));
            let most = low.abs().max(high.abs()).max_element();
            assert!((0.85..1.0).contains(&most), "{low} {high}");
            assert!((low.y + high.y).abs() < 0.03, "{low} {high}");
            assert!(yaws.len() > 1 || (low.x + high.x).abs() < 0.03, "{low} {high}");
        }
    }

    #[test]
    fn sabotage_a_camera_nearer_by_a_tenth_cuts_off() {
        let sight = Sight { yaws: &[0.6], pitch: 0.4, opening: 0.45, aspect: 0.5 };
        let lens = sight.fit(&points());
        let (low, high) = seen(&sight, Lens { distance: 0.9 * lens.distance, ..lens });
        assert!(low.abs().max(high.abs()).max_element() > 1.0);
    }

    #[test]
    fn nothing_to_see_is_no_fault() {
        let sight = Sight { yaws: &[0.0], pitch: 0.0, opening: 0.45, aspect: 1.0 };
        assert!(sight.fit(&[]).distance.is_finite());
        assert!(sight.fit(&[Vec3::ZERO]).distance > 0.0);
    }
}
