//! Frames without a window: the same scene gives the same pixels, on one machine, every time.

use std::time::Duration;

use bevy::{
    anti_alias::fxaa::Fxaa,
    app::TerminalCtrlCHandlerPlugin,
    camera::{ImageRenderTarget, RenderTarget},
    core_pipeline::tonemapping::{DebandDither, Tonemapping},
    log::LogPlugin,
    prelude::*,
    render::{
        RenderApp, RenderPlugin,
        pipelined_rendering::PipelinedRenderingPlugin,
        render_asset::RenderAssets,
        render_resource::{
            BufferDescriptor, BufferUsages, CommandEncoderDescriptor, MapMode, PipelineCache, PollType,
            TexelCopyBufferInfo, TexelCopyBufferLayout, TextureFormat, TextureUsages,
        },
        renderer::{RenderDevice, RenderQueue},
        texture::GpuImage,
    },
    time::TimeUpdateStrategy,
    window::ExitCondition,
};
use bevy_egui::{EguiContexts, EguiPlugin, EguiPrimaryContextPass, egui};
use image::RgbaImage;

use super::{Backdrop, Body, Ghost, Looks, Orbit, Placement, Pose, Quality, Studio, ViewPlugin, adapter};
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
    target: Handle<Image>,
    size: [u32; 2],
    supersampling: u32,
    /// Updates before the next frame counts.
    warming: usize,
}

/// Draws over each frame.
type Draw = Box<dyn FnMut(&egui::Context) + Send + Sync>;

/// What [`Renderer::overlay`] was given.
#[derive(Resource, Default)]
struct Overlay(Option<Draw>);

/// Updates without a frame after which the driver is given up: shaders are compiled in the first few.
const MOST_UPDATES: usize = 100;

/// Updates until a new overlay is laid out: fonts, sizes.
const OVERLAY_UPDATES: usize = 2;

/// What the clock advances by for each frame.
const TICK: Duration = Duration::from_millis(16);

impl Renderer {
    /// A renderer of pictures `[width, height]` in pixels, up to what the adapter holds
    /// ([`Adapter::largest_side`](super::Adapter::largest_side), at least 8192 on any GPU of the last ten years).
    ///
    /// # Errors
    /// [`Error::Input`] without a driver or for a size it cannot hold.
    pub fn new(size: [u32; 2], quality: Quality) -> Result<Self> {
        let largest = adapter()?.largest_side;
        let supersampling = quality.supersampling.max(1);
        let [width, height] = size.map(|side| side.saturating_mul(supersampling));
        if width.min(height) == 0 || width.max(height) > largest {
            return Err(Error::input(format!(
                "a picture of {}×{} pixels cannot be drawn; its sides must be from 1 to {}",
                size[0],
                size[1],
                largest / supersampling
            )));
        }
        let mut app = App::new();
        let plugins = DefaultPlugins
            .set(WindowPlugin { primary_window: None, exit_condition: ExitCondition::DontExit, ..default() })
            .set(RenderPlugin { synchronous_pipeline_compilation: true, ..default() })
            .disable::<PipelinedRenderingPlugin>()
            .disable::<TerminalCtrlCHandlerPlugin>()
            .disable::<LogPlugin>();
        #[cfg(feature = "window")]
        let plugins = plugins.disable::<bevy::winit::WinitPlugin>();
        app.add_plugins((plugins, EguiPlugin::default(), ViewPlugin))
            .insert_resource(quality)
            .insert_resource(TimeUpdateStrategy::ManualDuration(TICK))
            .init_resource::<Overlay>()
            .add_systems(EguiPrimaryContextPass, draw_overlay);
        app.finish();
        app.cleanup();
        let mut image = Image::new_target_texture(width, height, TextureFormat::Rgba8UnormSrgb, None);
        image.texture_descriptor.usage |= TextureUsages::COPY_SRC;
        let target = app.world_mut().resource_mut::<Assets<Image>>().add(image);
        let camera = (
            Camera3d::default(),
            Camera { clear_color: ClearColorConfig::Custom(Color::NONE), ..default() },
            // Panels are laid out in pixels of the finished picture.
            RenderTarget::Image(ImageRenderTarget { handle: target.clone(), scale_factor: supersampling as f32 }),
            Msaa::from_samples(quality.samples),
            Tonemapping::None,
            DebandDither::Disabled,
            Orbit::default(),
        );
        let camera = app.world_mut().spawn(camera).id();
        if quality.samples == 1 && supersampling == 1 {
            app.world_mut().entity_mut(camera).insert(Fxaa::default());
        }
        Ok(Self { app, camera, target, size, supersampling, warming: 0 })
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

    /// Everything else: resources [`Studio`], components of the bodies.
    pub fn world_mut(&mut self) -> &mut World {
        self.app.world_mut()
    }

    /// The camera.
    pub fn orbit(&mut self) -> Option<Mut<'_, Orbit>> {
        self.app.world_mut().get_mut::<Orbit>(self.camera)
    }

    /// Draws panels, titles and legends over every following frame: runs once a frame in the camera's egui context, whose
    /// points are pixels of the picture. Replaces an earlier one.
    ///
    /// egui lays areas and windows out in their first frame and shows them in the next; two frames are run for that here.
    /// What changes its size later is late by one frame: paint that with `Context::layer_painter`.
    pub fn overlay(&mut self, draw: impl FnMut(&egui::Context) + Send + Sync + 'static) {
        self.app.insert_resource(Overlay(Some(Box::new(draw))));
        self.warming = OVERLAY_UPDATES;
    }

    /// The next picture: everything as it is now. Alpha is straight, and 255 unless the backdrop is
    /// [`Backdrop::Transparent`].
    ///
    /// # Errors
    /// [`Error::Fault`] where the driver fails.
    pub fn frame(&mut self) -> Result<RgbaImage> {
        for _ in 0..MOST_UPDATES {
            self.app.update();
            if self.warming > 0 {
                self.warming -= 1;
            } else if self.is_drawn()? {
                let pixels = self.read()?;
                return Ok(self.finished(pixels));
            }
        }
        Err(Error::Fault("the driver did not finish the shaders".into()))
    }

    /// Whether nothing waits for a shader.
    fn is_drawn(&self) -> Result<bool> {
        let Some(render) = self.app.get_sub_app(RenderApp) else {
            return Err(Error::Fault("the renderer is gone".into()));
        };
        let Some(cache) = render.world().get_resource::<PipelineCache>() else { return Ok(false) };
        Ok(cache.waiting_pipelines().next().is_none())
    }

    /// Copies the target to memory: rows of RGBA, alpha premultiplied.
    fn read(&self) -> Result<RgbaImage> {
        let fault = |what: &str| Error::Fault(format!("the picture could not be read back: {what}"));
        let render = self.app.get_sub_app(RenderApp).ok_or_else(|| fault("no renderer"))?.world();
        let (Some(images), Some(device), Some(queue)) = (
            render.get_resource::<RenderAssets<GpuImage>>(),
            render.get_resource::<RenderDevice>(),
            render.get_resource::<RenderQueue>(),
        ) else {
            return Err(fault("no device"));
        };
        let texture = &images.get(&self.target).ok_or_else(|| fault("no target"))?.texture;
        let (width, height) = (texture.width(), texture.height());
        let row = RenderDevice::align_copy_bytes_per_row(4 * width as usize);
        let buffer = device.create_buffer(&BufferDescriptor {
            label: Some("frame"),
            size: (row * height as usize) as u64,
            usage: BufferUsages::MAP_READ | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut encoder = device.create_command_encoder(&CommandEncoderDescriptor::default());
        let layout = TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row as u32), rows_per_image: None };
        encoder.copy_texture_to_buffer(
            texture.as_image_copy(),
            TexelCopyBufferInfo { buffer: &buffer, layout },
            texture.size(),
        );
        queue.submit([encoder.finish()]);
        let (sender, receiver) = std::sync::mpsc::channel();
        let slice = buffer.slice(..);
        slice.map_async(MapMode::Read, move |result| {
            // The receiver waits below; if it is gone nobody wants to know.
            let _ = sender.send(result);
        });
        device.poll(PollType::wait_indefinitely()).map_err(|error| fault(&error.to_string()))?;
        receiver.recv().map_err(|_| fault("no answer"))?.map_err(|error| fault(&error.to_string()))?;
        let mapped = slice.get_mapped_range();
        let pixels = mapped.chunks(row).flat_map(|line| &line[..4 * width as usize]).copied().collect();
        RgbaImage::from_raw(width, height, pixels).ok_or_else(|| fault("its size is wrong"))
    }

    /// Averages supersampled pixels in linear light and makes alpha straight.
    fn finished(&self, pixels: RgbaImage) -> RgbaImage {
        let backdrop = self.app.world().get_resource::<Studio>().map(|studio| studio.backdrop);
        let is_opaque = backdrop != Some(Backdrop::Transparent);
        if is_opaque && self.supersampling == 1 {
            return pixels;
        }
        let k = self.supersampling;
        let [width, height] = self.size;
        RgbaImage::from_fn(width, height, |x, y| {
            let mut sum = Vec4::ZERO;
            for (dx, dy) in (0..k).flat_map(|dy| (0..k).map(move |dx| (dx, dy))) {
                let [r, g, b, a] = pixels.get_pixel(k * x + dx, k * y + dy).0;
                sum += LinearRgba::from(Srgba::rgba_u8(r, g, b, a)).to_vec4();
            }
            let mean = sum / (k * k) as f32;
            let alpha = if is_opaque { 1.0 } else { mean.w };
            let colour = if alpha > 0.0 { mean.truncate() / alpha } else { Vec3::ZERO };
            let [r, g, b, _] = Srgba::from(LinearRgba::rgb(colour.x, colour.y, colour.z)).to_u8_array();
            image::Rgba([r, g, b, (alpha * 255.0).round() as u8])
        })
    }
}

fn draw_overlay(mut contexts: EguiContexts, mut overlay: ResMut<Overlay>) {
    let (Some(draw), Ok(context)) = (&mut overlay.0, contexts.ctx_mut()) else { return };
    // Nothing fades in: the clock is the frame number.
    context.all_styles_mut(|style| style.animation_time = 0.0);
    draw(context);
}
