//! Animated PNG, looping: every colour and soft transparency; only what changed is written again.

use std::path::Path;

use image::RgbaImage;
use png::{BlendOp, Compression, DisposeOp, EncodingError};

use super::target::{Sink, Target};
use super::{Encoder, Reel, Whole, changed};
use crate::{Error, Result};

/// An APNG on its way.
pub(super) struct Apng {
    target: Target,
    writer: png::Writer<Sink>,
    last: Option<RgbaImage>,
}

impl Apng {
    /// Opens one.
    pub fn new(path: &Path, reel: &Reel) -> Result<Self> {
        let (target, sink) = Target::new(path)?;
        let open = || {
            let mut encoder = png::Encoder::new(sink, reel.width, reel.height);
            encoder.set_color(png::ColorType::Rgba);
            encoder.set_depth(png::BitDepth::Eight);
            encoder.set_compression(Compression::Balanced);
            encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
            encoder.set_animated(reel.frames as u32, 0)?;
            encoder.set_frame_delay(1, reel.fps as u16)?;
            encoder.set_blend_op(BlendOp::Source)?;
            encoder.set_dispose_op(DisposeOp::None)?;
            encoder.write_header()
        };
        let writer = open().map_err(|e| failed(&target, e))?;
        Ok(Self { target, writer, last: None })
    }

    fn write(&mut self, frame: &RgbaImage) -> Result<(), EncodingError> {
        let Some(last) = &self.last else { return self.writer.write_image_data(frame.as_raw()) };
        let [x, y, width, height] = changed(last, frame);
        let part = image::imageops::crop_imm(frame, x, y, width, height).to_image();
        self.writer.reset_frame_position()?;
        self.writer.set_frame_dimension(width, height)?;
        self.writer.set_frame_position(x, y)?;
        self.writer.write_image_data(part.as_raw())
    }
}

impl Encoder for Apng {
    fn frame(&mut self, frame: &RgbaImage) -> Result<()> {
        self.write(frame).map_err(|e| failed(&self.target, e))?;
        self.last = Some(frame.clone());
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<Whole> {
        let Self { target, writer, .. } = *self;
        writer.finish().map_err(|e| failed(&target, e))?;
        Ok(target.whole())
    }
}

fn failed(target: &Target, error: EncodingError) -> Error {
    match error {
        EncodingError::IoError(error) => target.failed(error),
        error => Error::Fault(format!("writing PNG: {error}")),
    }
}
