//! `homunculus gallery --render FOLDER`: each scene at its own resolution, on a page.

use std::io::Cursor;
use std::path::Path;

use image::RgbImage;
use image::codecs::jpeg::JpegEncoder;

use super::exhibit::{Exhibit, Found, NAMES};
use super::photographer::Photographer;
use super::{page, sheet};
use crate::app::{Verdict, cancel, note, say};
use crate::file::write_atomically;
use crate::gallery::Entry;
use crate::{Error, Result};

/// Of the pictures on the page: no blocks are seen, and a page of all scenes stays below 3 MB.
const QUALITY: u8 = 88;

/// Of thumbnails, which are part of the program.
const THUMBNAIL_QUALITY: u8 = 82;

/// Warps and draws the scenes, and writes the page: also of those that failed.
///
/// # Errors
/// Where nothing can be drawn or written, or the user stops it; then there is no page.
pub(super) fn run(entries: &[Entry], folder: &Path) -> Result<Verdict> {
    cancel::listen();
    let (pictures, thumbnails) = (folder.join("pictures"), folder.join("thumbnails"));
    for folder in [&pictures, &thumbnails] {
        std::fs::create_dir_all(folder).map_err(|e| Error::writing(folder, e))?;
    }
    let mut photographer = Photographer::new()?;
    let mut exhibits = Vec::with_capacity(entries.len());
    for (k, entry) in entries.iter().enumerate() {
        note(&format!("[{}/{}] {} …", k + 1, entries.len(), entry.name));
        let found = Found::of(entry, &mut photographer);
        if cancel::asked() {
            return Err(Error::Cancelled);
        }
        let exhibit = Exhibit { entry: *entry, found: found.map_err(|error| error.to_string()) };
        if let Ok(found) = &exhibit.found {
            for (picture, (name, _)) in found.pictures.iter().zip(NAMES) {
                write_jpeg(picture, QUALITY, &pictures.join(format!("{}-{name}.jpg", entry.name)))?;
            }
            let small = thumbnails.join(format!("{}.jpg", entry.name));
            write_jpeg(&sheet::thumbnail(found), THUMBNAIL_QUALITY, &small)?;
        }
        note(&exhibit.line());
        exhibits.push(exhibit);
    }
    drop(photographer);
    write_png(&sheet::contact_sheet(&exhibits)?, &folder.join("contact-sheet.png"))?;
    if let Some(strip) = sheet::strip(&exhibits)? {
        write_jpeg(&strip, QUALITY, &folder.join("strip.jpg"))?;
    }
    let index = folder.join("index.html");
    let page = page::html(&exhibits);
    write_atomically(&index, |file| std::io::Write::write_all(file, page.as_bytes()))?;
    let certified = exhibits.iter().filter(|exhibit| exhibit.is_certified()).count();
    say(&format!("{certified} of {} scenes certified; written: {}", exhibits.len(), index.display()));
    if let Some(why) = exhibits.iter().find_map(|exhibit| exhibit.found.as_ref().err()) {
        return Err(Error::Fault(format!("a scene of the gallery failed, see the page: {why}")));
    }
    Ok(if certified == exhibits.len() { Verdict::Done } else { Verdict::NotCertified })
}

fn write_jpeg(picture: &RgbImage, quality: u8, path: &Path) -> Result<()> {
    let mut bytes = Vec::new();
    JpegEncoder::new_with_quality(&mut bytes, quality)
        .encode_image(picture)
        .map_err(|e| Error::Fault(format!("a picture to JPEG: {e}")))?;
    write_atomically(path, |file| std::io::Write::write_all(file, &bytes))
}

fn write_png(picture: &RgbImage, path: &Path) -> Result<()> {
    let mut bytes = Cursor::new(Vec::new());
    picture
        .write_to(&mut bytes, image::ImageFormat::Png)
        .map_err(|e| Error::Fault(format!("a picture to PNG: {e}")))?;
    write_atomically(path, |file| std::io::Write::write_all(file, bytes.get_ref()))
}
