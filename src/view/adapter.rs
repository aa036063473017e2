//! Whether anything can be rendered, and how well.

use std::sync::OnceLock;

use bevy::{prelude::*, render::renderer::RenderAdapterInfo, tasks::block_on};

use crate::{Error, Result};

/// What will do the drawing.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Adapter {
    /// Its name, for example `llvmpipe (LLVM 15.0.6, 256 bits)`.
    pub name: String,
    /// Whether the CPU does the work.
    pub is_software: bool,
    /// Side of the largest picture in one piece, pixels.
    pub largest_side: u32,
}

/// How much a frame may cost.
#[derive(Resource, Debug, Clone, Copy, PartialEq)]
pub struct Quality {
    /// Samples per pixel at edges: 1, 2, 4 or 8.
    pub samples: u32,
    /// Side of a shadow map, pixels.
    pub shadow_map: usize,
    /// Pixels are computed this many times finer along each side and averaged (pictures and films only), ≥ 1.
    pub supersampling: u32,
}

impl FromWorld for Quality {
    /// For the adapter that Bevy chose.
    fn from_world(world: &mut World) -> Self {
        let is_software =
            world.get_resource::<RenderAdapterInfo>().is_none_or(|info| info.device_type == wgpu::DeviceType::Cpu);
        if is_software { Self::SOFTWARE } else { Self::GPU }
    }
}

impl Quality {
    /// For a software driver: about half a second a frame of 1280×720.
    pub const SOFTWARE: Self = Self { samples: 1, shadow_map: 1024, supersampling: 1 };

    /// For a GPU.
    pub const GPU: Self = Self { samples: 4, shadow_map: 2048, supersampling: 1 };

    /// What an adapter can do at a pleasant rate.
    pub fn for_adapter(adapter: &Adapter) -> Self {
        if adapter.is_software { Self::SOFTWARE } else { Self::GPU }
    }

    /// Samples of the shadow map for each pixel: as many as keep the penumbra free of bands for the map's texels.
    pub(super) fn shadow_taps(&self) -> u32 {
        if self.shadow_map > 1024 { 24 } else { 12 }
    }
}

/// Looks for a Vulkan driver, before Bevy starts, which would panic without one.
///
/// # Errors
/// [`Error::Input`] with the package that brings a driver, where there is none.
pub fn adapter() -> Result<Adapter> {
    /// Asking takes a tenth of a second and more; what was found stays.
    static FOUND: OnceLock<Adapter> = OnceLock::new();
    match FOUND.get() {
        Some(found) => Ok(found.clone()),
        None => look().map(|found| FOUND.get_or_init(|| found).clone()),
    }
}

fn look() -> Result<Adapter> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends: wgpu::Backends::VULKAN,
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    let options = wgpu::RequestAdapterOptions { power_preference: wgpu::PowerPreference::HighPerformance, ..default() };
    let found = block_on(instance.request_adapter(&options)).map_err(|_| {
        Error::input(
            "no Vulkan driver was found, and drawing needs one: install your GPU's driver, or Mesa's software driver \
             (Debian and Ubuntu: `apt install mesa-vulkan-drivers`); warping to files works without",
        )
    })?;
    let info = found.get_info();
    Ok(Adapter {
        name: info.name,
        is_software: info.device_type == wgpu::DeviceType::Cpu,
        largest_side: found.limits().max_texture_dimension_2d,
    })
}
