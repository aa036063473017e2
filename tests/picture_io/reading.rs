//! What is read, and what is refused and how.

use crate::{colourful, encoded, png_bytes, sentence};
use glam::{DVec2, UVec2, dvec2};
use homunculus::picture::{self, Cut, Picture, Pixels, is_picture, read_bytes};
use image::{DynamicImage, GrayImage, ImageFormat, Luma, Rgba, RgbaImage};
use std::path::Path;

#[test]
fn reads_every_kind_of_pixel() {
    let image = colourful(31, 17);
    for format in [ImageFormat::Png, ImageFormat::WebP] {
        let bytes = encoded(image.clone(), format);
        assert!(is_picture(&bytes));
        let picture = read_bytes("x", &bytes, &Cut::default()).unwrap();
        assert_eq!(picture.size, UVec2::new(31, 17));
        assert_eq!(picture.pixels, Pixels::Eight(image.clone()), "{format:?}");
        assert_eq!(picture.domain_area(), 31 * 17, "an opaque picture is its full rectangle");
        assert!(picture.warnings.is_empty());
    }
    let grey = GrayImage::from_fn(9, 5, |x, y| Luma([(x * 20 + y) as u8]));
    let picture = read_bytes("x", &png_bytes(grey), &Cut::default()).unwrap();
    assert_eq!(picture.pixels.wide(1), [20 * 257, 20 * 257, 20 * 257, 65535]);
    let deep = image::ImageBuffer::<Luma<u16>, Vec<u16>>::from_fn(9, 5, |x, y| Luma([(x * 7001 + y) as u16]));
    let picture = read_bytes("x", &png_bytes(deep), &Cut::default()).unwrap();
    assert_eq!(picture.pixels.wide(10), [7002, 7002, 7002, 65535], "16 bits stay 16 bits");
    let jpeg = encoded(DynamicImage::ImageRgba8(image).into_rgb8(), ImageFormat::Jpeg);
    assert_eq!(read_bytes("x.png", &jpeg, &Cut::default()).unwrap().size, UVec2::new(31, 17), "told by content");
}

/// A palette of red, transparent and half transparent blue.
fn palette_png() -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 3, 2);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_palette(vec![255, 0, 0, 9, 9, 9, 0, 0, 255]);
    encoder.set_trns(vec![255, 0, 127]);
    encoder.write_header().and_then(|mut writer| writer.write_image_data(&[0, 1, 2, 0, 0, 0])).expect("encoded");
    bytes
}

#[test]
fn alpha_over_the_threshold_is_the_body() {
    let picture = read_bytes("x", &palette_png(), &Cut::default()).unwrap();
    assert_eq!(picture.domain, [true, false, false, true, true, true], "127 of 255 is less than half");
    let looser = Cut { alpha: 0.4, background: None };
    assert_eq!(read_bytes("x", &palette_png(), &looser).unwrap().domain, [true, false, true, true, true, true]);
    let loosest = Cut { alpha: 0.0, background: None };
    assert!(!read_bytes("x", &palette_png(), &loosest).unwrap().domain[1], "the transparent is never the body");
}

/// A JPEG with an EXIF block that says how the camera was held.
fn turned_jpeg(orientation: u8) -> Vec<u8> {
    let image = image::RgbImage::from_fn(32, 16, |x, _| image::Rgb(if x < 16 { [250, 0, 0] } else { [0, 0, 250] }));
    let jpeg = encoded(image, ImageFormat::Jpeg);
    let mut exif = b"Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0".to_vec();
    exif.extend([orientation, 0, 0, 0, 0, 0, 0]);
    let mut bytes = jpeg[..2].to_vec();
    bytes.extend([0xFF, 0xE1, 0, exif.len() as u8 + 2]);
    bytes.extend(exif);
    bytes.extend(&jpeg[2..]);
    bytes
}

#[test]
fn pictures_stand_as_the_camera_was_held() {
    let is_red = |picture: &Picture, x: u32, y: u32| picture.pixels.wide((y * picture.size.x + x) as usize)[0] > 50000;
    let upright = read_bytes("x", &turned_jpeg(1), &Cut::default()).unwrap();
    assert!(upright.size == UVec2::new(32, 16) && is_red(&upright, 3, 8) && !is_red(&upright, 28, 8));
    let turned = read_bytes("x", &turned_jpeg(6), &Cut::default()).unwrap();
    assert!(turned.size == UVec2::new(16, 32) && is_red(&turned, 8, 3) && !is_red(&turned, 8, 28));
}

#[test]
fn a_background_is_cut_out_from_the_rim() {
    // A red disc with a white hole on white; smoothed as it is drawn.
    let drawn = RgbaImage::from_fn(64, 64, |x, y| {
        let distance = (dvec2(f64::from(x), f64::from(y)) + 0.5).distance(DVec2::splat(32.0));
        let share = (20.5 - distance).clamp(0.0, 1.0) - (6.5 - distance).clamp(0.0, 1.0);
        let mixed = |c: f64| (c * share + 255.0 * (1.0 - share)).round() as u8;
        Rgba([mixed(200.0), mixed(10.0), mixed(20.0), 255])
    });
    let bytes = png_bytes(drawn);
    let cut = Cut { background: Some("white,0.05".parse().unwrap()), ..Cut::default() };
    let picture = read_bytes("x", &bytes, &cut).unwrap();
    let at = |x: u32, y: u32| (y * 64 + x) as usize;
    assert!(!picture.domain[at(1, 1)] && picture.domain[at(32, 16)]);
    assert!(picture.domain[at(32, 32)], "the hole does not reach the rim");
    let area = std::f64::consts::PI * 400.0;
    assert!((picture.domain_area() as f64 / area - 1.0).abs() < 0.03, "{} of {area}", picture.domain_area());
    assert!(is_red_without(&picture));
    let untouched = read_bytes("x", &bytes, &Cut::default()).unwrap();
    assert!(!is_red_without(&untouched), "sabotage: without the cut the rim is pink");
    let elsewhere = Cut { background: Some("#00ff00,0.02".parse().unwrap()), ..Cut::default() };
    assert_eq!(read_bytes("x", &bytes, &elsewhere).unwrap().warnings.len(), 1);
    let all = Cut { background: Some("white,1".parse().unwrap()), ..Cut::default() };
    assert!(sentence(read_bytes("x", &bytes, &all)).contains("lower the tolerance"));
}

/// Whether what is seen beyond 18 pixels from the middle of a 64 × 64 picture is red, however transparent.
fn is_red_without(picture: &Picture) -> bool {
    (0..64 * 64_u32).all(|i| {
        let from_middle = dvec2(f64::from(i % 64), f64::from(i / 64)).distance(DVec2::splat(31.5));
        let [_, green, _, alpha] = picture.pixels.wide(i as usize);
        from_middle < 18.0 || alpha == 0 || green < 20 * 257
    })
}

#[test]
fn backgrounds_are_written_as_in_css() {
    for text in ["white,0.1", "#fff,0.05", "#ffffff, 0.05", "rgb(255, 255, 255),0", "WHITE,1"] {
        let background: picture::Background = text.parse().unwrap();
        assert_eq!(background.colour, [1.0; 3], "{text}");
    }
    for text in ["white", "whitish,0.1", "white,2", "white,-0.1", "white,NaN", "white,", ",0.1", ""] {
        let problem = text.parse::<picture::Background>().unwrap_err();
        assert!(problem.contains("COLOUR,TOLERANCE"), "{text}: {problem}");
    }
}

/// A PNG of any size in its header, and nothing but a few bytes of pixels.
fn claims(width: u32, height: u32) -> Vec<u8> {
    let mut bytes = png_bytes(colourful(8, 8));
    bytes[16..20].copy_from_slice(&width.to_be_bytes());
    bytes[20..24].copy_from_slice(&height.to_be_bytes());
    let checksum = crc32(&bytes[12..29]);
    bytes[29..33].copy_from_slice(&checksum.to_be_bytes());
    bytes
}

/// PNG, annex D.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |c, _| if c & 1 == 1 { 0xEDB8_8320 ^ (c >> 1) } else { c >> 1 })
    })
}

#[test]
fn bad_pictures_are_refused_in_one_sentence() {
    let read = |bytes: &[u8]| read_bytes("bad.png", bytes, &Cut::default());
    let whole = png_bytes(colourful(40, 30));
    for length in [8, 20, 40, whole.len() / 2, whole.len() - 13, whole.len() - 4] {
        let problem = sentence(read(&whole[..length]));
        assert!(problem.starts_with("bad.png: ") && problem.contains("cut off"), "{length}: {problem}");
    }
    let jpeg = encoded(DynamicImage::ImageRgba8(colourful(40, 30)).into_rgb8(), ImageFormat::Jpeg);
    assert!(sentence(read(&jpeg[..jpeg.len() / 2])).contains("cut off"));
    let webp = encoded(colourful(40, 30), ImageFormat::WebP);
    assert!(sentence(read(&webp[..webp.len() / 2])).contains("cut off"));

    assert!(sentence(read(b"")).contains("empty"));
    assert!(sentence(read(b"solid cube\nfacet normal 0 0 1")).contains("not a picture"));
    assert!(sentence(read(b"GIF89a\x01\0\x01\0\0\0\0")).contains("GIF"));
    assert!(sentence(read(&claims(0, 7))).contains("bad.png: "));
    assert!(sentence(read(&png_bytes(colourful(1, 1)))).contains("1 × 1"));
    let transparent = RgbaImage::new(12, 12);
    assert!(sentence(read(&png_bytes(transparent))).contains("nothing to warp"));
    let huge = sentence(read(&claims(30_000, 30_000)));
    assert!(huge.contains("30000 × 30000") && huge.contains("22.5 GB"), "{huge}");
    assert!(sentence(picture::read(Path::new("nowhere.png"), &Cut::default())).contains("nowhere.png"));

    let mut longer = whole.clone();
    longer.extend(b"and more");
    let picture = read(&longer).unwrap();
    assert!(picture.warnings.len() == 1 && picture.warnings[0].contains("8 bytes"), "{:?}", picture.warnings);
}

#[test]
fn meshes_are_not_pictures() {
    for bytes in
        [&b"ply\nformat ascii 1.0"[..], b"OFF\n8 6 0", b"glTF\x02\0\0\0", b"solid x", b"# obj\nv 0 0 0", b"{}", b""]
    {
        assert!(!is_picture(bytes));
    }
}
