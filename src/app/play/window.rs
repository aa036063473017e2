//! The window: panels, the viewport between them, pictures of it, and the rhythm of frames.

use std::time::{Duration, Instant};

use bevy::app::TerminalCtrlCHandlerPlugin;
use bevy::camera::visibility::RenderLayers;
use bevy::camera::{CameraOutputMode, Viewport as CameraViewport};
use bevy::log::LogPlugin;
use bevy::prelude::*;
use bevy::render::render_resource::BlendState;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured};
use bevy::window::{PresentMode, PrimaryWindow};
use bevy::winit::{UpdateMode, WinitSettings};
use bevy_egui::{EguiContexts, EguiGlobalSettings, EguiPlugin, EguiPrimaryContextPass, PrimaryEguiContext, egui};

use super::PlaySystems;
use super::keys::KeysOnPanel;
use super::pointer::{PointerOnPanel, Viewport};
use super::present::Shown;
use super::sandbox::Sandbox;
use crate::panel::{self, Facts, theme};
use crate::session::Snapshot;
use crate::view::{Legend, Looks, Orbit, Quality, SizeLegend, Unhurried, ViewPlugin};

/// Bevy, the view, and what a window adds to the sandbox. `unbound` frames come as fast as they can.
pub(super) fn build(app: &mut App, size: [u32; 2], quality: Quality, unbound: bool) {
    let window = Window {
        title: "homunculus".into(),
        name: Some("homunculus".into()),
        resolution: (size[0], size[1]).into(),
        present_mode: if unbound { PresentMode::AutoNoVsync } else { PresentMode::AutoVsync },
        resize_constraints: bevy::window::WindowResizeConstraints { min_width: 960.0, min_height: 600.0, ..default() },
        ..default()
    };
    app.add_plugins((
        DefaultPlugins
            .set(WindowPlugin { primary_window: Some(window), ..default() })
            .set(LogPlugin { filter: "error,wgpu_hal=off,rfd=off".into(), ..default() })
            .disable::<TerminalCtrlCHandlerPlugin>(),
        EguiPlugin::default(),
        WindowPluginOfPlay,
    ))
    .insert_resource(quality)
    .init_resource::<Unhurried>()
    .add_plugins(ViewPlugin);
    if unbound {
        app.insert_resource(WinitSettings {
            focused_mode: UpdateMode::Continuous,
            unfocused_mode: UpdateMode::Continuous,
        });
    } else {
        app.insert_resource(WinitSettings::desktop_app()).add_systems(Last, rhythm);
    }
}

/// Panels and the like.
struct WindowPluginOfPlay;

impl Plugin for WindowPluginOfPlay {
    fn build(&self, app: &mut App) {
        app.init_resource::<KeysOnPanel>()
            .add_systems(PreStartup, spawn_panel_camera)
            .add_systems(EguiPrimaryContextPass, panels)
            .add_systems(Update, name_window.in_set(PlaySystems::Update))
            .add_systems(Update, (place_viewport, take_pictures).after(PlaySystems::Present))
            .add_systems(Last, (autosave, close));
    }
}

/// Panels have a camera of their own, over the view's, which has only the middle.
fn spawn_panel_camera(mut commands: Commands, mut settings: ResMut<EguiGlobalSettings>) {
    settings.auto_create_primary_context = false;
    commands.spawn((
        PrimaryEguiContext,
        Camera2d,
        Msaa::Off,
        RenderLayers::none(),
        Camera {
            order: 1,
            output_mode: CameraOutputMode::Write {
                blend_state: Some(BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                clear_color: ClearColorConfig::None,
            },
            clear_color: ClearColorConfig::Custom(Color::NONE),
            ..default()
        },
    ));
}

#[expect(clippy::too_many_arguments, reason = "one for each thing panels show or say")]
fn panels(
    mut contexts: EguiContexts,
    mut sandbox: ResMut<Sandbox>,
    mut viewport: ResMut<Viewport>,
    mut on_panel: ResMut<PointerOnPanel>,
    mut keys_on_panel: ResMut<KeysOnPanel>,
    looks: Query<Ref<Looks>, With<Shown>>,
    references: Query<&SizeLegend>,
    mut legend: Local<Option<Legend>>,
    mut themed: Local<bool>,
    #[cfg(feature = "record")] mut preview: Local<preview::Preview>,
) -> Result {
    let context = contexts.ctx_mut()?;
    if !std::mem::replace(&mut *themed, true) {
        theme::apply(context);
    }
    match looks.single() {
        Ok(looks) if looks.is_changed() => *legend = looks.legend(),
        Ok(_) => {}
        Err(_) => *legend = None,
    }
    #[cfg(feature = "record")]
    let filming = preview.follow(context, sandbox.filming.as_ref());
    let sizes = references.iter().flat_map(|sizes| named(sizes, &sandbox.seen_from, &viewport)).collect();
    let mut choice = sandbox.choice.clone();
    let mut wishes = Vec::new();
    let mut root = egui::Ui::new(
        context.clone(),
        "root".into(),
        egui::UiBuilder::new().layer_id(egui::LayerId::background()).max_rect(context.viewport_rect()),
    );
    let draft = sandbox.open.as_ref().map(|open| open.draft());
    let title = sandbox.open.as_ref().map_or_else(String::new, |open| open.title());
    let facts = Facts {
        title: &title,
        file: sandbox.open.as_ref().and_then(|open| open.file.as_deref()),
        is_changed: sandbox.open.as_ref().is_some_and(|open| open.is_changed()),
        draft: draft.as_ref(),
        painting: sandbox.open.as_ref().map(|open| &open.painting),
        snapshot: &sandbox.snapshot,
        legend: legend.clone(),
        recent: sandbox.memory.recent(),
        busy: sandbox.busy(),
        problem: sandbox.problem.as_deref(),
        warnings: sandbox.open.as_ref().map_or(&[], |open| &open.warnings),
        can_restore: sandbox.memory.can_restore(),
        #[cfg(feature = "record")]
        filming: sandbox.filming.as_ref().map(|film| preview::facts(film, filming)),
        filmed: sandbox.filmed.as_ref().map(|(told, certified)| (told.as_str(), *certified)),
        sizes,
    };
    let middle = panel::draw(&mut root, &facts, &mut choice, &mut wishes);
    if sandbox.choice != choice {
        sandbox.choice = choice;
    }
    if !wishes.is_empty() {
        sandbox.wishes.extend(wishes);
    }
    let wanted =
        Viewport { min: Vec2::new(middle.min.x, middle.min.y), size: Vec2::new(middle.width(), middle.height()) };
    viewport.set_if_neq(wanted);
    let is_over = context.pointer_latest_pos().is_some_and(|at| {
        !middle.contains(at) || context.layer_id_at(at).is_some_and(|layer| layer.order != egui::Order::Background)
    });
    on_panel.set_if_neq(PointerOnPanel(is_over || context.egui_is_using_pointer()));
    keys_on_panel.set_if_neq(KeysOnPanel(context.text_edit_focused()));
    Ok(())
}

/// Where the names of reference shapes go, points of the window.
fn named(sizes: &SizeLegend, from: &Orbit, viewport: &Viewport) -> Vec<(egui::Pos2, &'static str)> {
    let seen = sizes.labels().into_iter().filter_map(|(at, name)| Some((from.seen(at)?, name)));
    let place = |at: Vec2| viewport.min + 0.5 * viewport.size + at * viewport.size.y;
    seen.map(|(at, name)| (place(at), name)).map(|(at, name)| (egui::pos2(at.x, at.y), name)).collect()
}

/// Gives the view's camera the middle.
fn place_viewport(
    viewport: Res<Viewport>,
    mut cameras: Query<&mut Camera, With<Orbit>>,
    windows: Query<&Window, With<PrimaryWindow>>,
) {
    let (Ok(mut camera), Ok(window)) = (cameras.single_mut(), windows.single()) else { return };
    let scale = window.scale_factor();
    let all = UVec2::new(window.physical_width(), window.physical_height());
    let corner = (viewport.min * scale).round().as_uvec2().min(all.saturating_sub(UVec2::ONE));
    let size = (viewport.size * scale).round().as_uvec2().min(all - corner).max(UVec2::ONE);
    if all.min_element() == 0 || corner.cmpge(all).any() {
        return;
    }
    let is_same = camera.viewport.as_ref().is_some_and(|v| v.physical_position == corner && v.physical_size == size);
    if !is_same {
        camera.viewport = Some(CameraViewport { physical_position: corner, physical_size: size, ..default() });
    }
}

fn name_window(sandbox: Res<Sandbox>, mut windows: Query<&mut Window, With<PrimaryWindow>>) {
    let (Some(open), Ok(mut window)) = (&sandbox.open, windows.single_mut()) else { return };
    let title = format!("{}{} – homunculus", if open.is_changed() { "• " } else { "" }, open.title());
    if window.title != title {
        window.title = title;
    }
}

fn take_pictures(mut commands: Commands, mut sandbox: ResMut<Sandbox>) {
    if sandbox.screenshots.is_empty() {
        return;
    }
    for path in std::mem::take(&mut sandbox.screenshots) {
        commands.spawn(Screenshot::primary_window()).observe(
            move |captured: On<ScreenshotCaptured>, mut sandbox: ResMut<Sandbox>| match captured
                .image
                .clone()
                .try_into_dynamic()
            {
                Ok(picture) => sandbox.write_picture(picture, path.clone()),
                Err(error) => sandbox.problem = Some(format!("{}: no picture could be taken: {error}", path.display())),
            },
        );
    }
}

/// How often unsaved work is kept.
const AUTOSAVE_EVERY: Duration = Duration::from_secs(5);

fn autosave(mut sandbox: ResMut<Sandbox>, mut last: Local<Option<Instant>>) {
    if last.is_none_or(|last| last.elapsed() >= AUTOSAVE_EVERY) {
        *last = Some(Instant::now());
        sandbox.autosave();
    }
}

fn close(mut exits: MessageReader<AppExit>, sandbox: Res<Sandbox>) {
    if exits.read().next().is_some() {
        sandbox.close();
    }
}

/// After something has happened frames come as fast as the screen for so long, then only when something happens.
const AWAKE: Duration = Duration::from_millis(600);

/// While something is awaited it is looked for this often.
const POLL: Duration = Duration::from_millis(33);

/// At rest a frame is drawn this often, for the autosave.
const REST: Duration = Duration::from_secs(5);

fn rhythm(
    sandbox: Res<Sandbox>,
    mut settings: ResMut<WinitSettings>,
    mut awake: Local<Option<Instant>>,
    mut seen: Local<Option<(u64, Option<u64>)>>,
    buttons: Res<ButtonInput<MouseButton>>,
    unhurried: Res<Unhurried>,
) {
    let Snapshot { version, .. } = *sandbox.snapshot;
    let now = (version, sandbox.open.as_ref().map(|open| open.painting.version()));
    let moves = unhurried.is_waiting
        || sandbox.choice.player.is_playing
        || (sandbox.choice.turntable && !sandbox.open.as_ref().is_some_and(|open| open.is_flat()))
        || buttons.get_pressed().next().is_some();
    if moves || *seen != Some(now) {
        *awake = Some(Instant::now());
        *seen = Some(now);
    }
    let is_awake = awake.is_some_and(|at| at.elapsed() < AWAKE);
    let mode = if is_awake {
        UpdateMode::Continuous
    } else {
        UpdateMode::reactive_low_power(if sandbox.awaits() { POLL } else { REST })
    };
    if settings.focused_mode != mode {
        *settings = WinitSettings { focused_mode: mode, unfocused_mode: mode };
    }
}

/// The last frame of a film that is being recorded, as a picture panels can show.
#[cfg(feature = "record")]
mod preview {
    use std::sync::Arc;

    use bevy_egui::egui;
    use image::RgbaImage;

    use super::super::Filming;
    use crate::panel::FilmFacts;

    /// What is shown, if anything, and of which frame.
    #[derive(Default)]
    pub(super) struct Preview {
        frame: Option<Arc<RgbaImage>>,
        texture: Option<egui::TextureHandle>,
    }

    /// A texture and its size, pixels.
    type Shown = Option<(egui::TextureId, egui::Vec2)>;

    impl Preview {
        /// Brings the picture up to date; without a film it goes.
        pub(super) fn follow(&mut self, context: &egui::Context, filming: Option<&Filming>) -> Shown {
            let Some(frame) = filming.and_then(Filming::preview) else {
                *self = Self::default();
                return None;
            };
            if !self.frame.as_ref().is_some_and(|shown| Arc::ptr_eq(shown, &frame)) {
                let size = [frame.width() as usize, frame.height() as usize];
                let picture = egui::ColorImage::from_rgba_unmultiplied(size, frame.as_raw());
                match &mut self.texture {
                    Some(texture) => texture.set(picture, egui::TextureOptions::LINEAR),
                    None => self.texture = Some(context.load_texture("film", picture, egui::TextureOptions::LINEAR)),
                }
                self.frame = Some(frame);
            }
            self.texture.as_ref().map(|texture| (texture.id(), texture.size_vec2()))
        }
    }

    /// What panels are told.
    pub(super) fn facts(film: &Filming, preview: Shown) -> FilmFacts<'_> {
        FilmFacts { path: &film.path, drawn: film.drawn(), frames: film.frames, left: film.left(), preview }
    }
}
