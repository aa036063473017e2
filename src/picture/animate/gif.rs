//! GIF (89a): one palette of 255 colours for all frames, so that nothing flickers, and a transparent one.

use std::io::{self, Write};
use std::time::Duration;

use gif::{DisposalMethod, Encoder, Repeat};
use image::RgbaImage;

use super::palette::{Palette, TRANSPARENT};
use super::{Clock, Frame, changed, check_size};

/// Viewers slow down what is shown for less.
pub const SHORTEST_GIF_FRAME: Duration = Duration::from_millis(20);

/// Writes frames as GIF, repeated for ever. `samples` are pictures with the colours to come, such as the first and the last
/// frame: the palette is made of them. Pixels at least half opaque are shown.
///
/// # Errors
/// Where `out` refuses, a frame is an error (which is given on), is shown for less than [`SHORTEST_GIF_FRAME`], has another
/// size than the first, or is wider or taller than 65,535 pixels; where there are no frames.
pub fn gif(
    out: impl Write,
    samples: &[&RgbaImage],
    frames: impl IntoIterator<Item = io::Result<Frame>>,
) -> io::Result<()> {
    let mut frames = frames.into_iter().peekable();
    let size = match frames.peek() {
        Some(Ok(first)) => first.pixels.dimensions(),
        Some(Err(_)) => (1, 1),
        None => return Err(io::Error::other("an animation without frames")),
    };
    let side = |length: u32| {
        u16::try_from(length)
            .map_err(|_| io::Error::other(format!("a GIF of {length} pixels; it has at most 65535 a side")))
    };
    let mut palette = Palette::of(samples, 255);
    let mut encoder = Encoder::new(out, side(size.0)?, side(size.1)?, &palette.rgb()).map_err(io::Error::other)?;
    encoder.set_repeat(Repeat::Infinite).map_err(io::Error::other)?;
    let mut clock = Clock::new(100);
    let mut before: Option<RgbaImage> = None;
    // A frame stays until the next is known: it is cleared where that has holes.
    let mut next = frames.next();
    while let Some(frame) = next {
        let frame = frame?;
        check_size(size, &frame.pixels)?;
        if frame.delay < SHORTEST_GIF_FRAME {
            return Err(io::Error::other("a GIF shows at most 50 frames in a second; ask for fewer"));
        }
        next = frames.next();
        let opens = match &next {
            Some(Ok(after)) => opens(&frame.pixels, &after.pixels),
            _ => false,
        };
        // What was cleared is drawn whole.
        let changed = before.as_ref().map_or([0, 0, size.0, size.1], |b| changed(b, &frame.pixels));
        let [left, top, width, height] = if opens { [0, 0, size.0, size.1] } else { changed };
        let indices = palette.indices(&frame.pixels, (left, top, width, height));
        let drawn = gif::Frame {
            delay: clock.next(frame.delay),
            dispose: if opens { DisposalMethod::Background } else { DisposalMethod::Keep },
            transparent: Some(TRANSPARENT),
            left: side(left)?,
            top: side(top)?,
            width: side(width)?,
            height: side(height)?,
            buffer: indices.into(),
            ..gif::Frame::default()
        };
        encoder.write_frame(&drawn).map_err(io::Error::other)?;
        before = (!opens).then_some(frame.pixels);
    }
    Ok(())
}

/// Whether a pixel that is shown becomes transparent, which drawing over cannot do.
fn opens(before: &RgbaImage, after: &RgbaImage) -> bool {
    before.pixels().zip(after.pixels()).any(|(b, a)| b.0[3] >= 128 && a.0[3] < 128)
}
