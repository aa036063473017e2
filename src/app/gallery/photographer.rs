//! Pictures of what it takes a renderer to draw.

use bevy::math::Vec3;
use bevy::prelude::{Entity, World};
use image::{DynamicImage, RgbImage};

use super::exhibit::SIDE;
use crate::gallery::Entry;
use crate::record::{Actor, Mix, Sight};
use crate::run::Solved;
use crate::view::headless::{Renderer, Shown};
use crate::view::{self, FIELD_OF_VIEW, Looks, Orbit, Pose, Quality};
use crate::{Error, Result};

/// Draws bodies, one after the other.
pub(super) struct Photographer {
    renderer: Renderer,
}

impl Photographer {
    /// Sets the studio up.
    ///
    /// # Errors
    /// As [`Renderer::new`].
    pub fn new() -> Result<Self> {
        let quality = Quality { supersampling: 2, ..Quality::for_adapter(&view::adapter()?) };
        Renderer::new([SIDE; 2], quality).map(|renderer| Self { renderer })
    }

    /// Takes the pictures of a scene that was solved, in the colours of its importance.
    ///
    /// # Errors
    /// What the driver refuses.
    pub fn portraits(&mut self, entry: &Entry, solved: Solved, coloured: Looks) -> Result<[RgbImage; 4]> {
        let mut actor = Actor::new(solved.boundary.clone(), solved);
        let last = actor.lambdas().len().saturating_sub(1);
        let faults = Looks { marked: Some(actor.classic_faults(1.0)), ..Looks::default() };
        let at = |key: usize| actor.pose(Mix { from: key, to: key, t: 0.0 });
        let views = [
            (Looks::default(), at(0)),
            (coloured.clone(), at(0)),
            (faults, actor.classic_pose(1.0)),
            (coloured, at(last)),
        ];
        let orbit = stand(&actor, entry);
        let body = self.renderer.show(Shown::new(actor.body()));
        let mut pictures = Vec::with_capacity(views.len());
        for (looks, pose) in views {
            pictures.push(self.picture(body, looks, pose, orbit));
        }
        self.renderer.world_mut().despawn(body);
        let pictures: Vec<RgbImage> = pictures.into_iter().collect::<Result<_>>()?;
        pictures.try_into().map_err(|_| Error::Fault("a scene has four pictures".into()))
    }

    fn picture(&mut self, body: Entity, looks: Looks, pose: Pose, orbit: Orbit) -> Result<RgbImage> {
        let world: &mut World = self.renderer.world_mut();
        world.entity_mut(body).insert((looks, pose));
        if let Some(mut camera) = self.renderer.orbit() {
            *camera = orbit;
        }
        self.renderer.frame().map(|picture| DynamicImage::from(picture).into_rgb8())
    }
}

/// Where the camera stands so that the scene is seen from where it is best seen, in all states.
fn stand(actor: &Actor, entry: &Entry) -> Orbit {
    let [yaw, pitch] = entry.camera.map(f32::to_radians);
    let [certified, classic] = actor.reach();
    let points: Vec<Vec3> = certified.into_iter().chain(classic).collect();
    let lens = Sight { yaws: &[yaw], pitch, opening: FIELD_OF_VIEW, aspect: 1.0 }.fit(&points);
    Orbit { target: lens.target, distance: lens.distance, yaw, pitch, ..Orbit::default() }
}
