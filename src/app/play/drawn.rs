//! Whether all that was to be drawn was: at first shaders are compiled, and what needs them is left out.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use bevy::prelude::*;
use bevy::render::render_resource::PipelineCache;
use bevy::render::{Render, RenderApp, RenderSystems};

/// What the renderer tells.
#[derive(Resource)]
struct IsDrawn(Arc<AtomicBool>);

/// Looks after each frame whether the renderer waits for no shader; it is one frame behind.
pub(super) fn watch(app: &mut App) -> Arc<AtomicBool> {
    let is_drawn: Arc<AtomicBool> = Arc::default();
    if let Some(render) = app.get_sub_app_mut(RenderApp) {
        let look = |is_drawn: Res<IsDrawn>, cache: Res<PipelineCache>| {
            is_drawn.0.store(cache.waiting_pipelines().next().is_none(), Ordering::Relaxed);
        };
        render.insert_resource(IsDrawn(is_drawn.clone())).add_systems(Render, look.in_set(RenderSystems::Cleanup));
    }
    is_drawn
}
