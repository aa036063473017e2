//! Pixels of 8 or 16 bits, and the file they are written to.

use std::io::{self, Write};

use glam::UVec2;
use image::{DynamicImage, ExtendedColorType, ImageBuffer, ImageEncoder as _, Rgba, RgbaImage};

/// sRGB with straight alpha, as deep as the file was.
#[derive(Debug, Clone, PartialEq)]
pub enum Pixels {
    /// 8 bits a channel.
    Eight(RgbaImage),
    /// 16 bits a channel.
    Sixteen(ImageBuffer<Rgba<u16>, Vec<u16>>),
}

impl Pixels {
    /// Grey, palette and opaque pictures get all four channels; the depth stays.
    pub(super) fn from_decoded(decoded: DynamicImage) -> Self {
        if decoded.color().bytes_per_pixel() / decoded.color().channel_count() > 1 {
            Self::Sixteen(decoded.into_rgba16())
        } else {
            Self::Eight(decoded.into_rgba8())
        }
    }

    /// Width and height.
    pub fn size(&self) -> UVec2 {
        match self {
            Self::Eight(image) => image.dimensions().into(),
            Self::Sixteen(image) => image.dimensions().into(),
        }
    }

    /// Red, green, blue and alpha of the pixel at `index` in reading order, each 0..=65535.
    pub fn wide(&self, index: usize) -> [u16; 4] {
        match self {
            // 257 · 255 = 65535.
            Self::Eight(image) => std::array::from_fn(|c| u16::from(image.as_raw()[4 * index + c]) * 257),
            Self::Sixteen(image) => std::array::from_fn(|c| image.as_raw()[4 * index + c]),
        }
    }

    /// Sets what [`Self::wide`] gives; 8-bit pixels round.
    pub(super) fn set_wide(&mut self, index: usize, rgba: [u16; 4]) {
        for (channel, value) in rgba.into_iter().enumerate() {
            match self {
                Self::Eight(image) => image.as_mut()[4 * index + channel] = ((u32::from(value) + 128) / 257) as u8,
                Self::Sixteen(image) => image.as_mut()[4 * index + channel] = value,
            }
        }
    }

    /// As 8 bits, rounded.
    pub fn into_eight(self) -> RgbaImage {
        match self {
            Self::Eight(image) => image,
            sixteen @ Self::Sixteen(_) => DynamicImage::from(sixteen).into_rgba8(),
        }
    }

    /// Writes a PNG of the same depth; `profile` is an ICC profile that goes along.
    ///
    /// # Errors
    /// Where `out` refuses.
    pub fn write_png(&self, out: impl Write, profile: Option<&[u8]>) -> io::Result<()> {
        let mut encoder = image::codecs::png::PngEncoder::new(out);
        if let Some(profile) = profile {
            encoder.set_icc_profile(profile.to_vec()).map_err(io::Error::other)?;
        }
        let size = self.size();
        match self {
            Self::Eight(image) => encoder.write_image(image.as_raw(), size.x, size.y, ExtendedColorType::Rgba8),
            Self::Sixteen(image) => {
                let bytes: Vec<u8> = image.as_raw().iter().flat_map(|c| c.to_ne_bytes()).collect();
                encoder.write_image(&bytes, size.x, size.y, ExtendedColorType::Rgba16)
            }
        }
        .map_err(io::Error::other)
    }
}

impl From<Pixels> for DynamicImage {
    fn from(pixels: Pixels) -> Self {
        match pixels {
            Pixels::Eight(image) => Self::ImageRgba8(image),
            Pixels::Sixteen(image) => Self::ImageRgba16(image),
        }
    }
}
