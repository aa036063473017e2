//! GIF, looping, with one palette for the whole film.

use std::path::Path;

use gif::{DisposalMethod, EncodingError, Frame, Repeat};
use image::RgbaImage;

use super::palette::{CLEAR, Palette};
use super::target::{Sink, Target};
use super::{Encoder, Reel, Whole};
use crate::{Error, Result};

/// Most frames per second: browsers slow down what shows a frame for less than two hundredths of a second.
const MOST_FPS: u32 = 50;

/// Whether GIF can hold it.
pub(super) fn check(path: &Path, reel: &Reel) -> Result<()> {
    if reel.fps > MOST_FPS {
        let sentence = format!("GIFs play at up to {MOST_FPS} frames per second; take --fps 30");
        return Err(Error::in_file(path, sentence));
    }
    Ok(())
}

/// A GIF on its way.
pub(super) struct Gif {
    target: Target,
    encoder: gif::Encoder<Sink>,
    palette: Palette,
    reel: Reel,
    frame: usize,
    shown: Vec<u8>,
}

impl Gif {
    /// Opens one with the colours of the samples.
    pub fn new(path: &Path, reel: &Reel, samples: &[RgbaImage]) -> Result<Self> {
        check(path, reel)?;
        let palette = Palette::of(samples);
        let (target, sink) = Target::new(path)?;
        let (width, height) = (reel.width as u16, reel.height as u16);
        let opened = gif::Encoder::new(sink, width, height, &palette.bytes());
        let mut encoder = opened.map_err(|e| failed(&target, e))?;
        encoder.set_repeat(Repeat::Infinite).map_err(|e| failed(&target, e))?;
        Ok(Self { target, encoder, palette, reel: *reel, frame: 0, shown: Vec::new() })
    }

    /// Hundredths of a second for which a frame is shown: whole numbers whose sum keeps to the time.
    fn delay(&self) -> u16 {
        let at = |frame: usize| (100.0 * frame as f64 / f64::from(self.reel.fps)).round() as usize;
        (at(self.frame + 1) - at(self.frame)) as u16
    }
}

impl Encoder for Gif {
    fn frame(&mut self, frame: &RgbaImage) -> Result<()> {
        let indices = self.palette.indices(frame);
        let mut picture = Frame {
            delay: self.delay(),
            transparent: Some(CLEAR),
            width: self.reel.width as u16,
            height: self.reel.height as u16,
            ..Frame::default()
        };
        if self.reel.transparent {
            picture.dispose = DisposalMethod::Background;
            picture.buffer = indices.into();
        } else {
            picture.dispose = DisposalMethod::Keep;
            let changes = indices.iter().enumerate().map(|(i, &index)| match self.shown.get(i) {
                Some(&before) if before == index => CLEAR,
                _ => index,
            });
            picture.buffer = changes.collect();
            self.shown = indices;
        }
        self.frame += 1;
        self.encoder.write_frame(&picture).map_err(|e| failed(&self.target, e))
    }

    fn finish(self: Box<Self>) -> Result<Whole> {
        let Self { target, encoder, .. } = *self;
        let sink = encoder.into_inner().map_err(|e| failed(&target, e))?;
        target.finish(sink)
    }
}

fn failed(target: &Target, error: EncodingError) -> Error {
    match error {
        EncodingError::Io(error) => target.failed(error),
        error => Error::Fault(format!("writing GIF: {error}")),
    }
}
