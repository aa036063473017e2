//! Frames to files. Each encoder writes beside its target and takes the final name only when all is written; dropping one
//! before that leaves nothing.

mod apng;
mod ffmpeg;
mod folder;
mod gif;
mod mp4;
mod palette;
mod target;

use std::path::Path;

use image::RgbaImage;

use crate::picture::animate::changed;
use crate::{Error, Result};
pub use target::Whole;

/// Turns frames into a file.
pub trait Encoder: Send {
    /// Takes the next frame, of the size announced, straight alpha.
    ///
    /// # Errors
    /// [`Error::File`] where the system refuses.
    fn frame(&mut self, frame: &RgbaImage) -> Result<()>;

    /// Completes the file; it has yet to be given its name.
    ///
    /// # Errors
    /// [`Error::File`] where the system refuses; nothing is left then.
    fn finish(self: Box<Self>) -> Result<Whole>;
}

/// What is to be encoded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Reel {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Frames per second.
    pub fps: u32,
    /// Frames there will be.
    pub frames: usize,
    /// Whether alpha counts.
    pub transparent: bool,
}

/// What a film is written as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// H.264 in MP4.
    Mp4,
    /// GIF.
    Gif,
    /// Animated PNG.
    Apng,
    /// A folder of numbered PNGs.
    PngFolder,
    /// One PNG.
    Still,
    /// What the program `ffmpeg` writes.
    Ffmpeg(ffmpeg::Recipe),
}

/// Frames a palette is made from: ends, middle and what lies between.
const PALETTE_FRAMES: usize = 5;

impl Format {
    /// The format a name asks for, of a film or of a single picture.
    ///
    /// # Errors
    /// A name that asks for none.
    pub fn of(path: &Path, is_still: bool) -> Result<Self> {
        let is_folder = path.as_os_str().to_string_lossy().ends_with(['/', std::path::MAIN_SEPARATOR]);
        let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
        match extension.as_deref() {
            Some("png") if is_still && !is_folder => Ok(Self::Still),
            _ if is_still => Err(Error::in_file(path, "a still is written as .png; give it such a name")),
            _ if is_folder => Ok(Self::PngFolder),
            Some("png-folder") => Ok(Self::PngFolder),
            Some("mp4") => Ok(Self::Mp4),
            Some("gif") => Ok(Self::Gif),
            Some("apng") => Ok(Self::Apng),
            Some("png") => Err(Error::in_file(
                path,
                "a PNG is one picture; give --still LAMBDA, or .apng for a film, or FOLDER/ for numbered pictures",
            )),
            extension => extension.and_then(ffmpeg::Recipe::of).map(Self::Ffmpeg).ok_or_else(|| {
                Error::in_file(
                    path,
                    "films are written as .mp4, .gif, .apng or FOLDER/ (numbered PNGs), and with ffmpeg as .webm, .mov, \
                     .mkv or .webp",
                )
            }),
        }
    }

    /// Whether a film can be had in this format here; asked before the work begins.
    ///
    /// # Errors
    /// One sentence with what the format or this machine lacks.
    pub fn check(self, path: &Path, reel: &Reel) -> Result<()> {
        match self {
            Self::Mp4 => mp4::check(path, reel),
            Self::Gif => gif::check(path, reel),
            Self::PngFolder => folder::check(path),
            Self::Apng | Self::Still => Ok(()),
            Self::Ffmpeg(recipe) => ffmpeg::check(recipe, path),
        }
    }

    /// Which of so many frames the encoder wants to see before it begins.
    pub fn samples(self, frames: usize) -> Vec<usize> {
        if self != Self::Gif {
            return Vec::new();
        }
        let mut samples: Vec<usize> =
            (0..PALETTE_FRAMES).map(|k| k * frames.saturating_sub(1) / (PALETTE_FRAMES - 1)).collect();
        samples.dedup();
        samples
    }

    /// Opens an encoder. `samples`: the frames it wanted to see.
    ///
    /// # Errors
    /// As [`check`](Self::check), and [`Error::File`] where the system refuses.
    pub fn begin(self, path: &Path, reel: &Reel, samples: &[RgbaImage]) -> Result<Box<dyn Encoder>> {
        Ok(match self {
            Self::Mp4 => Box::new(mp4::Mp4::new(path, reel)?),
            Self::Gif => Box::new(gif::Gif::new(path, reel, samples)?),
            Self::Apng => Box::new(apng::Apng::new(path, reel)?),
            Self::PngFolder => Box::new(folder::Folder::new(path, reel)?),
            Self::Still => Box::new(folder::Picture::new(path, reel)?),
            Self::Ffmpeg(recipe) => Box::new(ffmpeg::Ffmpeg::new(recipe, path, reel)?),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgba;

    #[test]
    fn names_ask_for_formats() {
        for (name, format) in [
            ("a.mp4", Format::Mp4),
            ("a.GIF", Format::Gif),
            ("x/a.apng", Format::Apng),
            ("frames/", Format::PngFolder),
            ("frames.png-folder", Format::PngFolder),
        ] {
            assert_eq!(Format::of(Path::new(name), false).unwrap(), format, "{name}");
        }
        assert!(matches!(Format::of(Path::new("a.webm"), false), Ok(Format::Ffmpeg(_))));
        assert_eq!(Format::of(Path::new("a.png"), true).unwrap(), Format::Still);
        for (name, is_still, expected) in
            [("a.png", false, "--still"), ("a.txt", false, ".mp4"), ("a", false, ".mp4"), ("a.mp4", true, ".png")]
        {
            let error = Format::of(Path::new(name), is_still).unwrap_err().to_string();
            assert!(error.contains(expected), "{name}: {error}");
        }
    }

    #[test]
    fn the_changed_part_is_found() {
        let before = RgbaImage::from_pixel(9, 7, Rgba([1, 2, 3, 255]));
        assert_eq!(changed(&before, &before), [0, 0, 1, 1]);
        for corners in [[(2, 3), (2, 3)], [(0, 0), (8, 6)], [(8, 0), (1, 5)], [(3, 6), (7, 2)], [(8, 6), (8, 6)]] {
            let mut after = before.clone();
            corners.iter().for_each(|&(x, y)| after.put_pixel(x, y, Rgba([9, 9, 9, 9])));
            let [(a, b), (c, d)] = corners;
            let expected = [a.min(c), b.min(d), a.abs_diff(c) + 1, b.abs_diff(d) + 1];
            assert_eq!(changed(&before, &after), expected, "{corners:?}");
        }
    }
}
