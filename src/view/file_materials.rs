//! Materials of the file, as far as the studio shows them: base colour and its texture, alpha, emission, roughness, metal, unlit.
//! Normal maps, occlusion maps and the rest of glTF are kept by the export and not drawn.

use bevy::{
    asset::RenderAssetUsages,
    image::{ImageAddressMode, ImageFilterMode, ImageSampler, ImageSamplerDescriptor},
    prelude::*,
    render::render_resource::{Extent3d, TextureDimension, TextureFormat},
};
use serde_json::Value;

use super::{Body, material::Base, premultiplied};
use crate::{boundary::source::Materials, voxel::Dimension};

/// Linear, sRGB about (203, 194, 184): clay, a little warm, so that it is neither skin nor stone.
const STUDIO_GREY: Vec4 = Vec4::new(0.60, 0.54, 0.48, 1.0);

/// One material.
pub(super) struct FileMaterial {
    pub base: Base,
    pub texture: Option<Handle<Image>>,
    pub alpha_mode: AlphaMode,
    pub is_unlit: bool,
    /// Whether it is a picture's, premultiplied.
    pub is_picture: bool,
}

impl FileMaterial {
    /// What is drawn where the file says nothing: grey, or white under vertex colours.
    fn plain(has_colours: bool) -> Self {
        let colour = if has_colours { Vec4::ONE } else { STUDIO_GREY };
        let base =
            Base { colour, emissive: Vec4::ZERO, roughness: 0.55, metallic: 0.0, alpha_cutoff: 0.0, first_row: 0 };
        Self { base, texture: None, alpha_mode: AlphaMode::Opaque, is_unlit: false, is_picture: false }
    }

    /// The file's material `index`; the plain one where there is none.
    pub fn new(body: &Body, index: u32, has_colours: bool, images: &mut Assets<Image>) -> Self {
        let materials = &body.boundary.source.materials;
        let is_picture = body.complex.dimension == Dimension::Two;
        let mut material = Self { is_picture, ..Self::plain(has_colours) };
        let Some(value) = materials.materials.get(index as usize) else { return material };
        let number = |value: &Value, default: f32| value.as_f64().map_or(default, |v| v as f32);
        let pbr = &value["pbrMetallicRoughness"];
        let factor = &pbr["baseColorFactor"];
        material.base.colour = Vec4::from_array(std::array::from_fn(|k| number(&factor[k], 1.0)));
        // Metal without surroundings to mirror is black: half of it is kept.
        material.base.metallic = 0.5 * number(&pbr["metallicFactor"], 1.0);
        if pbr["metallicRoughnessTexture"].is_object() || pbr["metallicFactor"].is_null() {
            material.base.metallic = 0.0;
        }
        material.base.roughness = number(&pbr["roughnessFactor"], 0.6).clamp(0.25, 1.0);
        let emissive = &value["emissiveFactor"];
        if !value["emissiveTexture"].is_object() {
            let glow = Vec3::from_array(std::array::from_fn(|k| number(&emissive[k], 0.0)));
            material.base.emissive = glow.extend(0.0);
        }
        material.is_unlit = value["extensions"]["KHR_materials_unlit"].is_object();
        material.alpha_mode = match value["alphaMode"].as_str() {
            Some("MASK") => AlphaMode::Mask(number(&value["alphaCutoff"], 0.5)),
            Some("BLEND") if is_picture => AlphaMode::Premultiplied,
            Some("BLEND") => AlphaMode::Blend,
            _ => AlphaMode::Opaque,
        };
        if let AlphaMode::Mask(cutoff) = material.alpha_mode {
            material.base.alpha_cutoff = cutoff;
        }
        if let Some(texture) = pbr["baseColorTexture"]["index"].as_u64() {
            material.texture = load(materials, texture as usize, is_picture).map(|image| images.add(image));
        }
        material
    }
}

/// Decodes a texture with its mip levels; `None` where it is missing or broken, which the reader has warned of.
fn load(materials: &Materials, texture: usize, is_picture: bool) -> Option<Image> {
    let texture = materials.textures.get(texture)?;
    let source = texture["source"].as_u64().or_else(|| texture["extensions"]["EXT_texture_webp"]["source"].as_u64())?;
    let file = materials.images.get(source as usize)?;
    let decoded = image::load_from_memory(&file.bytes).ok()?.into_rgba8();
    let wrap = |key: &str| {
        let sampler = texture["sampler"].as_u64().and_then(|s| materials.samplers.get(s as usize));
        match sampler.and_then(|s| s[key].as_u64()) {
            Some(33071) => ImageAddressMode::ClampToEdge,
            Some(33648) => ImageAddressMode::MirrorRepeat,
            _ => ImageAddressMode::Repeat,
        }
    };
    let levels = if is_picture { premultiplied::levels(decoded) } else { levels(decoded) };
    levels.map(|levels| texture_of(&levels, wrap("wrapS"), wrap("wrapT")))
}

/// The image and its halves, down to one pixel.
fn levels(full: image::RgbaImage) -> Option<Vec<image::RgbaImage>> {
    let (width, height) = full.dimensions();
    let mut levels = vec![full];
    for k in 1..32 - width.max(height).leading_zeros() {
        let (w, h) = ((width >> k).max(1), (height >> k).max(1));
        levels.push(image::imageops::resize(levels.last()?, w, h, image::imageops::FilterType::Triangle));
    }
    Some(levels)
}

/// A texture that stays calm when it is far away.
fn texture_of(levels: &[image::RgbaImage], wrap_u: ImageAddressMode, wrap_v: ImageAddressMode) -> Image {
    let (width, height) = levels[0].dimensions();
    let size = Extent3d { width, height, depth_or_array_layers: 1 };
    let mut image =
        Image::new_uninit(size, TextureDimension::D2, TextureFormat::Rgba8UnormSrgb, RenderAssetUsages::RENDER_WORLD);
    image.texture_descriptor.mip_level_count = levels.len() as u32;
    image.data = Some(levels.iter().flat_map(|level| level.as_raw()).copied().collect());
    image.sampler = ImageSampler::Descriptor(ImageSamplerDescriptor {
        address_mode_u: wrap_u,
        address_mode_v: wrap_v,
        mag_filter: ImageFilterMode::Linear,
        min_filter: ImageFilterMode::Linear,
        mipmap_filter: ImageFilterMode::Linear,
        anisotropy_clamp: 8,
        ..default()
    });
    image
}
