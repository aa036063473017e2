//! The studio: key, fill and rim lights, a background without horizon, a floor that only catches shadows.

use bevy::prelude::*;

/// What stands around the bodies. A resource; change it at any time.
#[derive(Resource, Debug, Clone, PartialEq)]
pub struct Studio {
    /// Behind everything.
    pub backdrop: Backdrop,
    /// Whether shadows fall on a floor at y = 0. Off for pictures.
    pub floor: bool,
}

/// Behind everything.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Backdrop {
    /// Very light grey, a little darker towards the rim.
    #[default]
    Studio,
    /// One sRGB colour.
    Plain([u8; 3]),
    /// Nothing: alpha 0 where no body is; shadows on the floor are translucent.
    Transparent,
}

impl Default for Studio {
    fn default() -> Self {
        Self { backdrop: Backdrop::Studio, floor: true }
    }
}
