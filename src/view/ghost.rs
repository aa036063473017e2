//! The rest shape, translucent, around what has grown out of it.

use bevy::prelude::*;

/// Shows the rest shape of the [`Body`](super::Body) on the same entity, translucent.
#[derive(Component, Debug, Clone, Copy, PartialEq)]
pub struct Ghost {
    /// 0..=1.
    pub opacity: f32,
}

impl Default for Ghost {
    fn default() -> Self {
        Self { opacity: 0.28 }
    }
}
