//! Draws the pictures of the gallery into `assets/gallery/picture`: `cargo run --release --example draw_gallery`.
//!
//! Everything is drawn here, with outlines of countries after Natural Earth 1:110m (public domain).

mod africa;
mod crocodile;
mod magnet;
mod map;
mod pen;
mod snake;

use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;

use homunculus::picture::animate::Palette;
use image::RgbaImage;

/// Opacities of the outline's ink, from none on: entries of a palette after its colours.
const OPACITIES: usize = 16;

/// Opaque colours of a baked picture: fewer show as bands, more only as bytes.
const COLOURS: usize = 144;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/gallery/picture");
    let folder = std::env::args().nth(1).map_or(folder, Into::into);
    let (map, countries) = map::draw();
    let (crocodile, teeth) = crocodile::draw();
    let sheets = [
        ("africa", map),
        ("africa_id", countries),
        ("magnet", magnet::draw()),
        ("crocodile", crocodile),
        ("crocodile_id", teeth),
        ("snake", snake::draw()),
    ];
    for (name, sheet) in sheets {
        let path = folder.join(name).with_extension("png");
        let (width, height) = (sheet.pixmap.width(), sheet.pixmap.height());
        let pixels = sheet.pixmap.take_demultiplied();
        let drawn = RgbaImage::from_raw(width, height, pixels).ok_or("as many bytes as pixels")?;
        if name.ends_with("_id") {
            let ids: Vec<u8> = drawn.pixels().map(|p| if p.0[3] == 0 { 0 } else { p.0[0] }).collect();
            bake(&path, (width, height), png::ColorType::Grayscale, None, &ids)?;
        } else {
            let (palette, opacities, indices) = indexed(&drawn);
            bake(&path, (width, height), png::ColorType::Indexed, Some((&palette, &opacities)), &indices)?;
        }
    }
    Ok(())
}

/// Palette, opacity of each of its entries, and `[height × width]` entries. Pixels along the outline are its ink in one of
/// few opacities.
fn indexed(drawn: &RgbaImage) -> (Vec<u8>, Vec<u8>, Vec<u8>) {
    let colours = Palette::of(&[drawn], COLOURS);
    let mut rgb = colours.rgb();
    let mut inks: BTreeMap<[u8; 3], usize> = BTreeMap::new();
    for pixel in drawn.pixels().filter(|p| (64..192).contains(&p.0[3])) {
        *inks.entry([pixel.0[0], pixel.0[1], pixel.0[2]]).or_default() += 1;
    }
    let ink = inks.iter().max_by_key(|(_, count)| **count).map_or([0; 3], |(ink, _)| *ink);
    let opacity = |step: usize| (step * 255 / OPACITIES) as u8;
    rgb.truncate(3 * COLOURS);
    rgb.extend(std::iter::repeat_n(ink, OPACITIES).flatten());
    let opacities = (0..COLOURS + OPACITIES).map(|i| if i < COLOURS { 255 } else { opacity(i - COLOURS) }).collect();
    let mut known: BTreeMap<[u8; 3], u8> = BTreeMap::new();
    let indices = drawn.pixels().map(|pixel| {
        let [r, g, b, alpha] = pixel.0;
        let step = (usize::from(alpha) * OPACITIES + 127) / 255;
        if step < OPACITIES {
            return (COLOURS + step) as u8;
        }
        *known.entry([r, g, b]).or_insert_with(|| colours.nearest([r, g, b]))
    });
    (rgb, opacities, indices.collect())
}

fn bake(
    path: &Path,
    (width, height): (u32, u32),
    kind: png::ColorType,
    palette: Option<(&[u8], &[u8])>,
    pixels: &[u8],
) -> Result<(), Box<dyn Error>> {
    let mut encoder = png::Encoder::new(std::fs::File::create(path)?, width, height);
    encoder.set_color(kind);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    encoder.set_filter(png::Filter::NoFilter);
    if let Some((rgb, opacities)) = palette {
        encoder.set_palette(rgb);
        encoder.set_trns(opacities);
    }
    encoder.write_header()?.write_image_data(pixels)?;
    Ok(())
}
