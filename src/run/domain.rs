//! What is warped, and how.

use std::sync::Arc;

use bevy::prelude::*;

use crate::{
    Result,
    boundary::Boundary,
    collision::plugin::Start,
    importance::{Stack, plugin::DomainImportance},
    settings::Settings,
    voxel::{
        Flat, check_flat_resolution, check_resolution,
        plugin::{DomainBoundary, DomainPicture},
    },
};

/// A domain before it is an entity: what is warped, and how.
#[derive(Debug, Clone)]
pub struct Domain {
    /// What is warped.
    pub content: Content,
    /// How.
    pub settings: Settings,
}

/// What is warped.
#[derive(Debug, Clone)]
pub enum Content {
    /// A body: B, and F as a function of its surface.
    Body(Arc<Boundary>, Arc<Stack>),
    /// A picture, which brings its own F.
    Picture(Arc<Flat>),
}

impl Domain {
    /// A body.
    pub fn body(boundary: Arc<Boundary>, importance: Arc<Stack>, settings: Settings) -> Self {
        Self { content: Content::Body(boundary, importance), settings }
    }

    /// A picture.
    pub fn picture(picture: Arc<Flat>, settings: Settings) -> Self {
        Self { content: Content::Picture(picture), settings }
    }

    /// Refuses settings that this content cannot have.
    ///
    /// # Errors
    /// A resolution out of range.
    pub fn check(&self) -> Result<()> {
        match self.content {
            Content::Body(..) => check_resolution(self.settings.resolution),
            Content::Picture(_) => check_flat_resolution(self.settings.resolution),
        }
    }

    /// Makes it an entity, which the stages of [`Solve`](crate::schedule::Solve) take up.
    pub fn spawn(self, world: &mut World) -> Entity {
        let mut entity = world.spawn((self.settings, Start::Rest));
        self.content.insert(&mut entity);
        entity.id()
    }

    /// The same from a system; the entity is a domain as soon as commands are applied.
    pub fn spawn_later(self, commands: &mut Commands) -> Entity {
        let Self { content, settings } = self;
        let mut entity = commands.spawn((settings, Start::Rest));
        entity.queue(move |mut entity: EntityWorldMut| content.insert(&mut entity));
        entity.id()
    }
}

impl Content {
    /// Gives it to a domain; importance that replaces another one of the same lattice sets off what depends on it.
    pub fn insert(self, entity: &mut EntityWorldMut) {
        match self {
            Self::Body(boundary, importance) => {
                entity.insert((DomainBoundary(boundary), DomainImportance(importance)));
            }
            Self::Picture(picture) => {
                entity.insert(DomainPicture(picture));
            }
        }
    }
}
