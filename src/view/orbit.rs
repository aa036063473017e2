//! The camera's mathematics: pure functions; who turns them is told by the window or the recorder.

use bevy::{camera::ScalingMode, prelude::*};

use super::{Extent, ViewSystems};

/// A camera that looks at a target from a distance. Put it on a `Camera3d`; its transform and projection follow.
#[derive(Component, Debug, Clone, Copy, PartialEq)]
pub struct Orbit {
    /// What it looks at, view space.
    pub target: Vec3,
    /// Turn about +y, radians; 0 looks along −z (at the front of a body that faces +z).
    pub yaw: f32,
    /// Height above the horizon, radians, within ±π/2.
    pub pitch: f32,
    /// From the target, > 0.
    pub distance: f32,
    /// Whether parallels stay parallel.
    pub orthographic: bool,
    /// Turntable: radians per second added to `yaw` by whoever owns the clock ([`Orbit::turn`]).
    pub turntable: f32,
}

/// Lets cameras follow their [`Orbit`].
pub(super) fn build(app: &mut App) {
    app.add_systems(PostUpdate, follow.in_set(ViewSystems::Present));
}

fn follow(mut cameras: Query<(&Orbit, &mut Transform, &mut Projection), Changed<Orbit>>) {
    for (orbit, mut transform, mut projection) in &mut cameras {
        *transform = orbit.transform();
        *projection = orbit.projection();
    }
}

/// A direction to look from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    /// From +z.
    Front,
    /// From −z.
    Back,
    /// From +x.
    Right,
    /// From −x.
    Left,
    /// From +y.
    Top,
    /// From −y.
    Bottom,
}

/// Full vertical opening of the camera: a long lens, as portraits want; wider makes near limbs look swollen, which is what
/// the warp is about.
pub const FIELD_OF_VIEW: f32 = 0.45;

impl Default for Orbit {
    fn default() -> Self {
        Self { target: Vec3::Y, yaw: 0.45, pitch: 0.12, distance: 5.2, orthographic: false, turntable: 0.0 }
    }
}

impl Orbit {
    /// Where the camera is.
    pub fn eye(&self) -> Vec3 {
        self.target + self.rotation() * Vec3::Z * self.distance
    }

    /// World from camera rotation.
    pub fn rotation(&self) -> Quat {
        Quat::from_euler(EulerRot::YXZ, self.yaw, -self.pitch, 0.0)
    }

    /// The camera's transform.
    pub fn transform(&self) -> Transform {
        Transform { translation: self.eye(), rotation: self.rotation(), scale: Vec3::ONE }
    }

    /// The camera's projection.
    pub fn projection(&self) -> Projection {
        if self.orthographic {
            let viewport_height = 2.0 * self.distance * (0.5 * FIELD_OF_VIEW).tan();
            return Projection::Orthographic(OrthographicProjection {
                scaling_mode: ScalingMode::FixedVertical { viewport_height },
                near: -50.0,
                far: 100.0,
                ..OrthographicProjection::default_3d()
            });
        }
        Projection::Perspective(PerspectiveProjection {
            fov: FIELD_OF_VIEW,
            near: (0.01 * self.distance).max(1.0e-4),
            far: 100.0,
            ..default()
        })
    }

    /// The camera of pictures: straight on, parallel, the whole box in sight.
    pub fn flat(extent: Extent, aspect: f32) -> Self {
        let mut orbit = Self { yaw: 0.0, pitch: 0.0, orthographic: true, ..Self::default() };
        orbit.frame(extent, aspect);
        orbit
    }

    /// Turns by angles in radians; the pitch stops at the poles.
    pub fn orbit(&mut self, yaw: f32, pitch: f32) {
        self.yaw += yaw;
        self.pitch = (self.pitch + pitch).clamp(-std::f32::consts::FRAC_PI_2, std::f32::consts::FRAC_PI_2);
    }

    /// Moves the target so that it follows the pointer: `delta` in heights of the picture, y down.
    pub fn pan(&mut self, delta: Vec2) {
        let height = 2.0 * self.distance * (0.5 * FIELD_OF_VIEW).tan();
        self.target += self.rotation() * Vec3::new(-delta.x, delta.y, 0.0) * height;
    }

    /// Divides the distance by `factor` > 0 and keeps what lies under the pointer there: `cursor` from the middle of the
    /// picture, in heights of the picture, y down.
    pub fn zoom_to(&mut self, factor: f32, cursor: Vec2) {
        let before = self.distance;
        self.distance = (before / factor).clamp(1.0e-3, 80.0);
        let height = 2.0 * (before - self.distance) * (0.5 * FIELD_OF_VIEW).tan();
        self.target += self.rotation() * Vec3::new(cursor.x, -cursor.y, 0.0) * height;
    }

    /// Where a place is seen: from the middle of the picture, in heights of the picture, y down; `None` behind the camera.
    pub fn seen(&self, place: Vec3) -> Option<Vec2> {
        let p = self.rotation().inverse() * (place - self.eye());
        let depth = if self.orthographic { self.distance } else { -p.z };
        (depth > 0.0).then(|| Vec2::new(p.x, -p.y) / (2.0 * depth * (0.5 * FIELD_OF_VIEW).tan()))
    }

    /// Looks at a box so that it fills the picture of this aspect (width / height) with a margin.
    pub fn frame(&mut self, Extent { low, high }: Extent, aspect: f32) {
        self.target = 0.5 * (low + high);
        let (back, half) = (self.rotation().inverse(), 0.5 * (high - low));
        let (mut needed, tangent) = (0.0_f32, (0.5 * FIELD_OF_VIEW).tan());
        for k in 0..8 {
            let sign = |bit: u32| if k >> bit & 1 == 0 { -1.0 } else { 1.0 };
            let corner = back * (half * Vec3::new(sign(0), sign(1), sign(2)));
            let spread = corner.y.abs().max(corner.x.abs() / aspect.max(1.0e-3));
            let depth = if self.orthographic { 0.0 } else { corner.z };
            needed = needed.max(spread / tangent + depth);
        }
        self.distance = (1.08 * needed).max(1.0e-2);
    }

    /// Looks from an axis.
    pub fn look_from(&mut self, axis: Axis) {
        use std::f32::consts::{FRAC_PI_2, PI};
        (self.yaw, self.pitch) = match axis {
            Axis::Front => (0.0, 0.0),
            Axis::Back => (PI, 0.0),
            Axis::Right => (FRAC_PI_2, 0.0),
            Axis::Left => (-FRAC_PI_2, 0.0),
            Axis::Top => (0.0, FRAC_PI_2),
            Axis::Bottom => (0.0, -FRAC_PI_2),
        };
    }

    /// The turntable after so many seconds.
    pub fn turn(&mut self, seconds: f32) {
        self.yaw += self.turntable * seconds;
    }

    /// The ray through a place of the picture: `cursor` from its middle, in heights of the picture, y down.
    pub fn ray(&self, cursor: Vec2) -> Ray3d {
        let tangent = (0.5 * FIELD_OF_VIEW).tan();
        let across = self.rotation() * Vec3::new(cursor.x, -cursor.y, 0.0) * (2.0 * tangent);
        let ahead = self.rotation() * Vec3::NEG_Z;
        let new = |origin, direction| Ray3d { origin, direction: Dir3::new(direction).unwrap_or(Dir3::NEG_Z) };
        if self.orthographic {
            return new(self.eye() + across * self.distance - ahead * 20.0, ahead);
        }
        new(self.eye(), ahead + across)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where a place is on the screen, in heights of the picture from its middle, y down.
    fn seen(orbit: &Orbit, place: Vec3) -> Vec2 {
        orbit.seen(place).expect("a place before the camera")
    }

    #[test]
    fn zooming_keeps_what_is_under_the_pointer_and_panning_carries_it() {
        for orthographic in [false, true] {
            let before = Orbit { orthographic, ..Orbit::default() };
            let cursor = Vec2::new(0.3, -0.2);
            // A place in the plane of the target, under the pointer.
            let place = before.target
                + before.rotation()
                    * Vec3::new(cursor.x, -cursor.y, 0.0)
                    * (2.0 * before.distance * (0.5 * FIELD_OF_VIEW).tan());
            assert!(seen(&before, place).distance(cursor) < 1e-5);
            let mut zoomed = before;
            zoomed.zoom_to(1.7, cursor);
            assert!(seen(&zoomed, place).distance(cursor) < 1e-4, "{orthographic}");
            let mut panned = before;
            panned.pan(Vec2::new(0.1, 0.05));
            assert!(seen(&panned, place).distance(cursor + Vec2::new(0.1, 0.05)) < 1e-4);
            // Sabotage: zooming to elsewhere moves it.
            zoomed.zoom_to(1.7, Vec2::ZERO);
            assert!(seen(&zoomed, place).distance(cursor) > 0.05);
        }
    }

    #[test]
    fn a_framed_box_is_in_sight_and_fills_it() {
        let extent = Extent { low: Vec3::new(-1.0, 0.0, -0.4), high: Vec3::new(1.0, 2.0, 0.4) };
        for (orthographic, aspect) in [(false, 1.6), (true, 1.6), (false, 0.5)] {
            let mut orbit = Orbit { orthographic, ..Orbit::default() };
            orbit.frame(extent, aspect);
            let corner = |k: u32| {
                let pick = |bit: u32| if k >> bit & 1 == 0 { extent.low } else { extent.high };
                Vec3::new(pick(0).x, pick(1).y, pick(2).z)
            };
            let reach =
                (0..8).map(|k| seen(&orbit, corner(k)).abs()).fold(0.0_f32, |m, p| m.max(p.y).max(p.x / aspect));
            assert!((0.4..=0.5).contains(&reach), "{orthographic} {aspect}: {reach}");
        }
    }

    #[test]
    fn what_is_behind_is_not_seen() {
        let orbit = Orbit::default();
        let behind = orbit.eye() + orbit.rotation() * Vec3::Z;
        assert_eq!(orbit.seen(behind), None);
        assert!(orbit.seen(orbit.target).is_some_and(|at| at.length() < 1e-5));
    }

    #[test]
    fn rays_go_through_what_is_seen() {
        for orthographic in [false, true] {
            let orbit = Orbit { orthographic, ..Orbit::default() };
            let cursor = Vec2::new(-0.2, 0.35);
            let ray = orbit.ray(cursor);
            assert!(seen(&orbit, ray.get_point(4.9)).distance(cursor) < 1e-4);
        }
    }
}
