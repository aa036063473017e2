//! APNG (PNG, third edition, 2025): a PNG whose further frames are chunks that other readers skip.

use std::io::{self, Write};

use image::GenericImageView as _;
use png::{BitDepth, BlendOp, ColorType, DisposeOp, Encoder};

use super::{Clock, Frame, changed, check_size};

/// Writes `count` frames as APNG, repeated for ever; only what changes of a frame is written.
///
/// # Errors
/// Where `out` refuses, a frame is an error (which is given on), there are not `count` frames, or one has another size.
pub fn apng(out: impl Write, count: u32, frames: impl IntoIterator<Item = io::Result<Frame>>) -> io::Result<()> {
    let mut frames = frames.into_iter();
    let first = frames.next().ok_or_else(|| io::Error::other("an animation without frames"))??;
    let size = first.pixels.dimensions();
    let mut clock = Clock::new(1000);
    let mut encoder = Encoder::new(out, size.0, size.1);
    encoder.set_color(ColorType::Rgba);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder.set_compression(png::Compression::Balanced);
    encoder.set_animated(count, 0)?;
    encoder.set_blend_op(BlendOp::Source)?;
    encoder.set_dispose_op(DisposeOp::None)?;
    encoder.set_frame_delay(clock.next(first.delay), 1000)?;
    let mut writer = encoder.write_header()?;
    writer.write_image_data(first.pixels.as_raw())?;
    let mut before = first.pixels;
    let mut written = 1;
    for frame in frames {
        let frame = frame?;
        check_size(size, &frame.pixels)?;
        let [left, top, width, height] = changed(&before, &frame.pixels);
        writer.reset_frame_position()?;
        writer.set_frame_dimension(width, height)?;
        writer.set_frame_position(left, top)?;
        writer.set_frame_delay(clock.next(frame.delay), 1000)?;
        writer.write_image_data(frame.pixels.view(left, top, width, height).to_image().as_raw())?;
        before = frame.pixels;
        written += 1;
    }
    writer.finish()?;
    if written == count {
        return Ok(());
    }
    Err(io::Error::other(format!("an animation of {count} frames has {written}")))
}
