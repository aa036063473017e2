//! The contract of pictures around the method: what is read, what is refused and how, what importance a pixel gets, and that
//! what is drawn is the picture: nothing moved, cracked, fringed or lost.
#![allow(clippy::print_stdout, reason = "skipping is said aloud")]

mod animation;
mod drawing;
mod importance;
mod reading;
mod scenes;

use glam::{DVec2, UVec2, dvec2};
use homunculus::importance::{Field, Layer};
use homunculus::picture::{Cut, FlatMesh, Picture, Pixels, read_bytes};
use image::{DynamicImage, GrayImage, ImageFormat, Luma, Rgba, RgbaImage};
use std::io::Cursor;
use std::path::{Path, PathBuf};
/// A picture that changes everywhere, opaque.
fn colourful(width: u32, height: u32) -> RgbaImage {
    RgbaImage::from_fn(width, height, |x, y| {
        Rgba([(x * 7 % 256) as u8, (y * 5 % 256) as u8, ((x * x + 3 * y) % 256) as u8, 255])
    })
}

/// A disc with a smoothed edge; `outside` is the colour under what is transparent.
fn disc(size: u32, radius: f64, inside: [u8; 3], outside: [u8; 3]) -> RgbaImage {
    let centre = DVec2::splat(f64::from(size) / 2.0);
    RgbaImage::from_fn(size, size, |x, y| {
        let distance = (dvec2(f64::from(x), f64::from(y)) + 0.5).distance(centre);
        let alpha = ((radius + 0.5 - distance).clamp(0.0, 1.0) * 255.0).round() as u8;
        let [r, g, b] = if alpha > 0 { inside } else { outside };
        Rgba([r, g, b, alpha])
    })
}

fn encoded(image: impl Into<DynamicImage>, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.into().write_to(&mut bytes, format).expect("encoded");
    bytes.into_inner()
}

fn png_bytes(image: impl Into<DynamicImage>) -> Vec<u8> {
    encoded(image, ImageFormat::Png)
}

fn picture_of(image: RgbaImage) -> Picture {
    read_bytes("test.png", &png_bytes(image), &Cut::default()).expect("a picture")
}

/// The cells of side `cell` that overlap the domain, two triangles each.
fn mesh_of(picture: &Picture, cell: f64) -> FlatMesh {
    let size = picture.size.as_dvec2();
    let (columns, rows) = ((size.x / cell).ceil() as usize, (size.y / cell).ceil() as usize);
    let mut vertices = vec![u32::MAX; (columns + 1) * (rows + 1)];
    let mut mesh = FlatMesh::default();
    for (column, row) in (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row))) {
        let low = dvec2(column as f64, row as f64) * cell;
        let (first, last) = (low.floor().as_uvec2(), (low + cell).ceil().as_uvec2().min(picture.size));
        let mut pixels =
            (first.y..last.y).flat_map(|y| (first.x..last.x).map(move |x| (y * picture.size.x + x) as usize));
        if !pixels.any(|pixel| picture.domain[pixel]) {
            continue;
        }
        let mut vertex = |i: usize, j: usize| {
            let at = (row + j) * (columns + 1) + column + i;
            if vertices[at] == u32::MAX {
                vertices[at] = mesh.rest.len() as u32;
                mesh.rest.push(low + dvec2(i as f64, j as f64) * cell);
            }
            vertices[at]
        };
        let [a, b, c, d] = [vertex(0, 0), vertex(1, 0), vertex(1, 1), vertex(0, 1)];
        mesh.triangles.extend([[a, b, c], [a, c, d]]);
    }
    mesh
}

/// Grows around the middle and waves: smooth, nowhere folded.
fn waved(mesh: &FlatMesh, size: UVec2) -> Vec<DVec2> {
    let centre = size.as_dvec2() / 2.0;
    let place = |p: &DVec2| {
        let from = *p - centre;
        let near = (-from.length_squared() / (0.08 * size.as_dvec2().length_squared())).exp();
        centre + from * (1.0 + 0.9 * near) + 3.0 * dvec2((p.y / 23.0).sin(), (p.x / 31.0).sin())
    };
    mesh.rest.iter().map(place).collect()
}

/// Greatest difference of two pictures, levels of 255, of what is seen: the colour of the transparent is nobody's.
fn difference(a: &Pixels, b: &Pixels) -> f64 {
    assert_eq!(a.size(), b.size());
    let seen = |rgba: [u16; 4]| {
        let [r, g, b, alpha] = rgba.map(f64::from);
        [r, g, b].map(|c| c * alpha / 65535.0 / 257.0).into_iter().chain([alpha / 257.0])
    };
    let count = (a.size().x * a.size().y) as usize;
    (0..count).flat_map(|i| seen(a.wide(i)).zip(seen(b.wide(i)))).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

fn sentence(result: homunculus::Result<impl Sized>) -> String {
    let sentence = result.err().expect("refused").to_string();
    assert!(!sentence.contains('\n') && !sentence.is_empty(), "{sentence}");
    sentence
}

fn shared(file: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data").join(file);
    if !path.exists() {
        println!("skipped: no {} beside the checkout", path.display());
        return None;
    }
    Some(path)
}

/// Files in a folder that goes with them.
struct Files(tempfile::TempDir);

impl Files {
    fn new(files: &[(&str, Vec<u8>)]) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        files.iter().for_each(|(name, bytes)| std::fs::write(folder.path().join(name), bytes).expect("written"));
        Self(folder)
    }

    fn load(&self, layers: &[Layer], picture: &Picture) -> homunculus::Result<Field> {
        Field::load(layers, 1.0, false, picture, self.0.path())
    }
}

/// Regions 1 (16 columns), 2 (4 columns) and none (20 columns) of 40 × 30.
fn ids() -> GrayImage {
    GrayImage::from_fn(40, 30, |x, _| {
        Luma([if x < 16 {
            1
        } else if x < 20 {
            2
        } else {
            0
        }])
    })
}

fn regions(table: &str, per_area: bool) -> homunculus::Result<Field> {
    let files = Files::new(&[("id.png", png_bytes(ids())), ("v.csv", table.into())]);
    let layer = Layer::Regions { regions: "id.png".into(), values: "v.csv".into(), per_area };
    files.load(&[layer], &picture_of(colourful(40, 30)))
}
