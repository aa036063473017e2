//! Numbered PNGs in a folder that appears when all are there; and single pictures.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use image::RgbaImage;
use png::{Compression, EncodingError};
use tempfile::TempDir;

use super::target::{Sink, Target};
use super::{Encoder, Reel, Whole};
use crate::file::beside;
use crate::{Error, Result};

/// Whether the folder can come to be: not there yet, or empty.
pub(super) fn check(path: &Path) -> Result<()> {
    let is_free = match std::fs::read_dir(path) {
        Ok(mut entries) => entries.next().is_none(),
        Err(error) => error.kind() == io::ErrorKind::NotFound,
    };
    if is_free {
        return Ok(());
    }
    Err(Error::in_file(path, "it is there already and no empty folder; give another name or remove it"))
}

/// A folder on its way.
pub(super) struct Folder {
    path: PathBuf,
    temporary: TempDir,
    transparent: bool,
    frame: usize,
}

impl Folder {
    /// Opens one.
    pub fn new(path: &Path, reel: &Reel) -> Result<Self> {
        check(path)?;
        let (parent, mut builder) = beside(path);
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt as _;
            // As any new folder: the user's mask narrows it.
            builder.permissions(std::fs::Permissions::from_mode(0o777));
        }
        let temporary = builder.tempdir_in(parent).map_err(|e| Error::writing(path, e))?;
        Ok(Self { path: path.into(), temporary, transparent: reel.transparent, frame: 0 })
    }
}

impl Encoder for Folder {
    fn frame(&mut self, frame: &RgbaImage) -> Result<()> {
        let name = self.temporary.path().join(format!("frame_{:05}.png", self.frame));
        self.frame += 1;
        let write = || {
            let mut file = io::BufWriter::new(std::fs::File::create(name)?);
            png(frame, self.transparent, &mut file)?;
            file.flush()
        };
        write().map_err(|e| Error::writing(&self.path, e))
    }

    fn finish(self: Box<Self>) -> Result<Whole> {
        Ok(Whole::folder(self.path, self.temporary))
    }
}

/// A single picture on its way.
pub(super) struct Picture {
    target: Target,
    sink: Sink,
    transparent: bool,
}

impl Picture {
    /// Opens one.
    pub fn new(path: &Path, reel: &Reel) -> Result<Self> {
        let (target, sink) = Target::new(path)?;
        Ok(Self { target, sink, transparent: reel.transparent })
    }
}

impl Encoder for Picture {
    fn frame(&mut self, frame: &RgbaImage) -> Result<()> {
        png(frame, self.transparent, &mut self.sink).map_err(|e| self.target.failed(e))
    }

    fn finish(self: Box<Self>) -> Result<Whole> {
        self.target.finish(self.sink)
    }
}

/// A PNG, in sRGB; without alpha where that says nothing.
fn png(picture: &RgbaImage, transparent: bool, sink: impl Write) -> io::Result<()> {
    let rgb: Vec<u8>;
    let (colour, bytes) = if transparent {
        (png::ColorType::Rgba, picture.as_raw())
    } else {
        rgb = picture.pixels().flat_map(|p| [p.0[0], p.0[1], p.0[2]]).collect();
        (png::ColorType::Rgb, &rgb)
    };
    let write = || {
        let mut encoder = png::Encoder::new(sink, picture.width(), picture.height());
        encoder.set_color(colour);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(Compression::Balanced);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(bytes)?;
        writer.finish()
    };
    write().map_err(|error: EncodingError| match error {
        EncodingError::IoError(error) => error,
        error => io::Error::other(error),
    })
}
