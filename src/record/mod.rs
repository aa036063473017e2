//! Films of the growth.

pub mod encode;
mod plan;
mod settings;

pub use plan::{FramePlan, Mix, plan};
pub use settings::{Camera, Draft, Ease, MAX_FRAMES, MAX_SIDE, MAX_TITLE, MIN_SIDE, Settings, View};
