//! Pictures in: PNG, JPEG and WebP, told by their content.

use std::io::Cursor;
use std::path::Path;

use glam::UVec2;
use image::metadata::Orientation;
use image::{DynamicImage, ImageDecoder as _, ImageFormat, ImageReader};

use super::cut::Cut;
use super::{Picture, Pixels};
use crate::{Error, Result};

/// Most pixels of a picture: more would take over a gigabyte in work.
pub const MAX_PIXELS: u64 = 40_000_000;

/// What a pixel takes in work: its four channels, its place in the domain, its importance, and linear light for drawing.
const BYTES_PER_PIXEL: u64 = 4 + 1 + 4 + 16;

/// Longest file read; a picture of [`MAX_PIXELS`] at 16 bits without any compression is shorter.
const MAX_FILE: u64 = 400_000_000;

/// What a file decodes to, before anything is cut out.
pub(crate) struct Decoded {
    pub pixels: Pixels,
    pub profile: Option<Vec<u8>>,
    pub warnings: Vec<String>,
}

/// Whether the content is a picture's, of whatever kind: those that cannot be read are named by [`read`].
pub fn is_picture(bytes: &[u8]) -> bool {
    kind(bytes).is_some()
}

/// Reads a picture and cuts its body out.
///
/// # Errors
/// One sentence with the file's name: not a picture, a kind that is not read, damaged or cut off, smaller than 2 × 2, larger
/// than [`MAX_PIXELS`] (told before anything is allocated, with the memory it would take), or nothing opaque in it.
pub fn read(path: &Path, cut: &Cut) -> Result<Picture> {
    let name = path.file_name().map_or_else(|| path.display().to_string(), |n| n.to_string_lossy().into_owned());
    picture(&name, path, decode(path, &file(path)?)?, cut)
}

/// [`read`] for a picture in memory; `name` stands for the file in messages.
///
/// # Errors
/// As [`read`].
pub fn read_bytes(name: &str, bytes: &[u8], cut: &Cut) -> Result<Picture> {
    picture(name, Path::new(name), decode(Path::new(name), bytes)?, cut)
}

fn picture(name: &str, path: &Path, decoded: Decoded, cut: &Cut) -> Result<Picture> {
    let Decoded { mut pixels, profile, mut warnings } = decoded;
    let size = pixels.size();
    let domain = cut.apply(&mut pixels, &mut warnings).map_err(|sentence| Error::in_file(path, sentence))?;
    Ok(Picture { name: name.into(), size, pixels, domain, profile, warnings })
}

/// The whole file, unless it is too long for any picture that is read.
pub(crate) fn file(path: &Path) -> Result<Vec<u8>> {
    let length = std::fs::metadata(path).map_err(|e| Error::reading(path, e))?.len();
    if length > MAX_FILE {
        let sentence =
            format!("the file has {} MB, more than any picture that is read; scale it down", length / 1_000_000);
        return Err(Error::in_file(path, sentence));
    }
    std::fs::read(path).map_err(|e| Error::reading(path, e))
}

/// Decodes a picture, turned as its camera was held.
pub(crate) fn decode(path: &Path, bytes: &[u8]) -> Result<Decoded> {
    let refuse = |sentence: String| Err(Error::in_file(path, sentence));
    let format = match kind(bytes) {
        Some(format @ (ImageFormat::Png | ImageFormat::Jpeg | ImageFormat::WebP)) => format,
        Some(other) => {
            let kind = format!("{other:?}").to_uppercase();
            return refuse(format!("a {kind} picture; PNG, JPEG and WebP are read, convert it to one of these"));
        }
        None if bytes.is_empty() => return refuse("the file is empty; give a PNG, JPEG or WebP".into()),
        None => return refuse("not a picture; give a PNG, JPEG or WebP".into()),
    };
    let damaged = |error: image::ImageError| {
        let reason = error.to_string().replace('\n', " ");
        Error::in_file(
            path,
            format!("the picture is damaged or cut off ({}); export it again", reason.trim_end_matches('.')),
        )
    };
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    reader.no_limits();
    let mut decoder = reader.into_decoder().map_err(damaged)?;
    let size = UVec2::from(decoder.dimensions());
    check_size(path, size)?;
    let mut limits = image::Limits::no_limits();
    // Room for the decoder's own buffers beside the picture's.
    limits.max_alloc = Some(MAX_PIXELS * 8 * 3);
    decoder.set_limits(limits).map_err(damaged)?;
    // Metadata that cannot be read is no reason to refuse the picture.
    let orientation = decoder.orientation().unwrap_or(Orientation::NoTransforms);
    let profile = decoder.icc_profile().unwrap_or(None);
    let mut decoded = DynamicImage::from_decoder(decoder).map_err(damaged)?;
    decoded.apply_orientation(orientation);

    let mut warnings = Vec::new();
    match end(format, bytes) {
        None => return refuse("the picture is cut off before its end; export or download it again".into()),
        Some(end) if end < bytes.len() => {
            warnings.push(format!(
                "{}: {} bytes after the picture's end are ignored",
                path.display(),
                bytes.len() - end
            ));
        }
        Some(_) => {}
    }
    Ok(Decoded { pixels: Pixels::from_decoded(decoded), profile, warnings })
}

fn check_size(path: &Path, size: UVec2) -> Result<()> {
    let UVec2 { x: width, y: height } = size;
    if size.min_element() < 2 {
        let sentence =
            format!("a picture of {width} × {height} pixels has nothing to warp; give one of at least 2 × 2");
        return Err(Error::in_file(path, sentence));
    }
    let pixels = u64::from(width) * u64::from(height);
    if pixels > MAX_PIXELS {
        let (gigabytes, megapixels) = (((pixels * BYTES_PER_PIXEL) as f64) / 1e9, MAX_PIXELS / 1_000_000);
        let sentence = format!(
            "a picture of {width} × {height} pixels would take {gigabytes:.1} GB of memory; scale it down to at most \
             {megapixels} megapixels"
        );
        return Err(Error::in_file(path, sentence));
    }
    Ok(())
}

/// The kinds of picture that are told by their first bytes without mistaking a mesh for one.
fn kind(bytes: &[u8]) -> Option<ImageFormat> {
    use ImageFormat::{Avif, Bmp, Gif, Jpeg, Png, Tiff, WebP};
    image::guess_format(bytes).ok().filter(|format| matches!(format, Png | Jpeg | WebP | Gif | Tiff | Bmp | Avif))
}

/// Where the picture ends in the file, `None` where the file ends before it.
fn end(format: ImageFormat, bytes: &[u8]) -> Option<usize> {
    match format {
        ImageFormat::Png => {
            // Chunks after the eight bytes of the signature: length, type, data, checksum (PNG, 5.3).
            let mut at = 8;
            loop {
                let head = bytes.get(at..at + 8)?;
                let length = u32::from_be_bytes([head[0], head[1], head[2], head[3]]) as usize;
                at = at.checked_add(length)?.checked_add(12).filter(|end| *end <= bytes.len())?;
                if &head[4..] == b"IEND" {
                    return Some(at);
                }
            }
        }
        // The marker "end of image". Within a scan 0xFF is stuffed, so it cannot be data; previews in the metadata have
        // their own, before the picture's.
        ImageFormat::Jpeg => bytes.windows(2).rposition(|pair| pair == [0xFF, 0xD9]).map(|at| at + 2),
        _ => {
            let length = u32::from_le_bytes(bytes.get(4..8)?.try_into().ok()?) as usize;
            length.checked_add(8).filter(|end| *end <= bytes.len())
        }
    }
}
