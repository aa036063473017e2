//! Frames without a window: the same scene gives the same pixels, on one machine, every time.

use bevy::prelude::*;
use image::RgbaImage;

use super::{Body, Ghost, Looks, Orbit, Placement, Pose, Quality};
use crate::{Error, Result};

/// A body and how it is shown; what is left out has its default.
#[derive(Debug, Clone)]
pub struct Shown {
    /// What.
    pub body: Body,
    /// In which state; at rest without.
    pub pose: Option<Pose>,
    /// With which colours.
    pub looks: Looks,
    /// Where.
    pub placement: Placement,
    /// With its rest shape.
    pub ghost: Option<Ghost>,
}

impl Shown {
    /// A body at rest in its own colours.
    pub fn new(body: Body) -> Self {
        Self { body, pose: None, looks: Looks::default(), placement: Placement::default(), ghost: None }
    }
}

/// Draws frames into memory. Nothing depends on the clock.
pub struct Renderer {
    app: App,
    camera: Entity,
}

impl Renderer {
    /// A renderer of pictures `[width, height]` in pixels, up to what the adapter holds
    /// ([`Adapter::largest_side`](super::Adapter::largest_side), at least 8192 on any GPU of the last ten years).
    ///
    /// # Errors
    /// [`Error::Input`] without a driver or for a size it cannot hold.
    pub fn new(_size: [u32; 2], _quality: Quality) -> Result<Self> {
        Err(Error::input("not yet"))
    }

    /// Adds a body; its entity takes new [`Pose`]s, [`Looks`] and so on through [`Renderer::world_mut`].
    pub fn show(&mut self, shown: Shown) -> Entity {
        let Shown { body, pose, looks, placement, ghost } = shown;
        let mut entity = self.app.world_mut().spawn((body, looks, placement));
        if let Some(pose) = pose {
            entity.insert(pose);
        }
        if let Some(ghost) = ghost {
            entity.insert(ghost);
        }
        entity.id()
    }

    /// Changes the state of a body.
    pub fn pose(&mut self, body: Entity, pose: Pose) {
        if let Ok(mut entity) = self.app.world_mut().get_entity_mut(body) {
            entity.insert(pose);
        }
    }

    /// Everything else: resources [`Studio`](super::Studio), components of the bodies.
    pub fn world_mut(&mut self) -> &mut World {
        self.app.world_mut()
    }

    /// The camera.
    pub fn orbit(&mut self) -> Option<Mut<'_, Orbit>> {
        self.app.world_mut().get_mut::<Orbit>(self.camera)
    }

    /// Draws panels, titles and legends over every following frame: runs once a frame in the camera's egui context, whose
    /// points are pixels. Replaces an earlier one.
    pub fn overlay(&mut self, _draw: impl FnMut(&bevy_egui::egui::Context) + Send + Sync + 'static) {}

    /// The next picture: everything as it is now.
    ///
    /// # Errors
    /// [`Error::Fault`] where the driver fails.
    pub fn frame(&mut self) -> Result<RgbaImage> {
        Err(Error::Fault("not yet".into()))
    }
}
