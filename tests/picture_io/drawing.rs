//! What is drawn is the picture: nothing moved, cracked, fringed or lost.

use crate::{colourful, difference, disc, mesh_of, picture_of, png_bytes, sentence, shared, waved};
use glam::{DVec2, dvec2};
use homunculus::picture::render::{Canvas, mark, render};
use homunculus::picture::{self, Cut, FlatMesh, Picture, Pixels, read_bytes};
use image::{Rgba, RgbaImage};

#[test]
fn nothing_moved_is_the_same_picture() {
    let check = |picture: &Picture, cell: f64, moved: DVec2| {
        let mesh = mesh_of(picture, cell);
        let warped: Vec<DVec2> = mesh.rest.iter().map(|p| *p + moved).collect();
        difference(&render(picture, &mesh, &warped, &Canvas::of(picture, 1.0).unwrap()), &picture.pixels)
    };
    for picture in [picture_of(colourful(67, 45)), picture_of(disc(64, 25.3, [200, 40, 30], [0, 255, 0]))] {
        for cell in [1.0, 3.7, 16.0] {
            let off = check(&picture, cell, DVec2::ZERO);
            assert!(off <= 1.0, "{off} levels off at cells of {cell}");
            assert!(check(&picture, cell, dvec2(0.5, 0.0)) > 1.0, "sabotage: half a pixel aside is seen");
        }
    }
    if let Some(folder) = shared("images") {
        for name in ["us_states.png", "crocodile_512.png", "magnet_512.png"] {
            let picture = picture::read(&folder.join(name), &Cut::default()).unwrap();
            let off = check(&picture, 4.0, DVec2::ZERO);
            assert!(off <= 1.0, "{name}: {off} levels off");
        }
    }
}

#[test]
fn sixteen_bits_stay_sixteen_bits() {
    let deep = image::ImageBuffer::<Rgba<u16>, Vec<u16>>::from_fn(40, 30, |x, y| {
        Rgba([(x * 1601) as u16, (y * 2003) as u16, (x * y * 50) as u16, 65535])
    });
    let picture = read_bytes("x", &png_bytes(deep), &Cut::default()).unwrap();
    let mesh = mesh_of(&picture, 7.0);
    let drawn = render(&picture, &mesh, &mesh.rest, &Canvas::of(&picture, 1.0).unwrap());
    assert!(matches!(drawn, Pixels::Sixteen(_)));
    assert!(difference(&drawn, &picture.pixels) <= 2.0 / 257.0, "{}", difference(&drawn, &picture.pixels));
    let mut bytes = Vec::new();
    drawn.write_png(&mut bytes, None).unwrap();
    assert_eq!(read_bytes("x", &bytes, &Cut::default()).unwrap().pixels, drawn);
}

/// Whether each pixel well inside the warped picture has exactly this colour.
fn is_whole(drawn: &Pixels, canvas: &Canvas, centre: DVec2, radius: f64, colour: [u16; 4]) -> bool {
    let width = drawn.size().x as usize;
    let place = |i: usize| canvas.to_plane(dvec2((i % width) as f64 + 0.5, (i / width) as f64 + 0.5));
    let mut inside = (0..width * drawn.size().y as usize).filter(|i| place(*i).distance(centre) < radius).peekable();
    assert!(inside.peek().is_some(), "something is looked at");
    inside.all(|i| drawn.wide(i) == colour)
}

#[test]
fn elements_meet_without_cracks() {
    let picture = picture_of(disc(120, 50.0, [180, 60, 90], [0, 0, 0]));
    let mut mesh = mesh_of(&picture, 3.0);
    let warped = waved(&mesh, picture.size);
    let colour = [180, 60, 90, 255].map(|c| c * 257);
    for scale in [0.4, 1.0, 2.3] {
        let canvas = Canvas::around(&picture, &mesh, [&warped[..]], scale).unwrap();
        let drawn = render(&picture, &mesh, &warped, &canvas);
        assert!(is_whole(&drawn, &canvas, DVec2::splat(60.0), 42.0, colour), "scale {scale}");
    }
    let canvas = Canvas::around(&picture, &mesh, [&warped[..]], 1.0).unwrap();
    // Wider than the outermost maps go on.
    mesh.triangles.retain(|t| mesh.rest[t[0] as usize].distance(DVec2::splat(60.0)) > 8.0);
    let drawn = render(&picture, &mesh, &warped, &canvas);
    assert!(!is_whole(&drawn, &canvas, DVec2::splat(60.0), 42.0, colour), "sabotage: missing elements are seen");
}

/// Whether all that is seen is white, within a level.
fn is_white(drawn: &Pixels) -> bool {
    let count = (drawn.size().x * drawn.size().y) as usize;
    (0..count).map(|i| drawn.wide(i)).all(|[r, g, b, alpha]| alpha < 4 * 257 || r.min(g).min(b) >= 254 * 257)
}

#[test]
fn no_fringe_at_the_edge() {
    let draw = |picture: &Picture, scale| {
        let mesh = mesh_of(picture, 5.0);
        let warped = waved(&mesh, picture.size);
        render(picture, &mesh, &warped, &Canvas::around(picture, &mesh, [&warped[..]], scale).unwrap())
    };
    // What is transparent is black beneath.
    let picture = picture_of(disc(100, 40.0, [255; 3], [0; 3]));
    for scale in [0.3, 1.0, 3.0] {
        assert!(is_white(&draw(&picture, scale)), "scale {scale}");
    }
    let mut dirty = disc(100, 40.0, [255; 3], [0; 3]);
    dirty.pixels_mut().filter(|p| p.0[3] > 0 && p.0[3] < 255).for_each(|p| p.0[0] = 0);
    assert!(!is_white(&draw(&picture_of(dirty), 1.0)), "sabotage: a dark rim is seen");
}

/// Area that is seen, output pixels.
fn opaque_area(drawn: &Pixels) -> f64 {
    (0..(drawn.size().x * drawn.size().y) as usize).map(|i| f64::from(drawn.wide(i)[3]) / 65535.0).sum()
}

#[test]
fn the_edge_is_smooth_and_keeps_its_area() {
    for cell in [1.0, 2.0, 9.0] {
        let picture = picture_of(disc(100, 40.0, [90, 90, 90], [0; 3]));
        let mesh = mesh_of(&picture, cell);
        let warped: Vec<DVec2> = mesh.rest.iter().map(|p| 1.7 * *p).collect();
        let canvas = Canvas::around(&picture, &mesh, [&warped[..]], 1.0).unwrap();
        let drawn = render(&picture, &mesh, &warped, &canvas);
        let wanted = std::f64::consts::PI * (1.7_f64 * 40.0).powi(2);
        let area = opaque_area(&drawn);
        assert!((area / wanted - 1.0).abs() < 0.005, "{area} of {wanted} with cells of {cell}");
        let is_partial = |i: &usize| (1..65534).contains(&drawn.wide(*i)[3]);
        let partial = (0..(drawn.size().x * drawn.size().y) as usize).filter(is_partial).count();
        assert!(partial > 400, "an edge of 427 pixels has more than {partial} partly covered");
    }
}

#[test]
fn what_shrinks_is_averaged_in_linear_light() {
    let board = RgbaImage::from_fn(256, 256, |x, y| Rgba(if (x + y) % 2 == 0 { [255; 4] } else { [0, 0, 0, 255] }));
    let picture = picture_of(board);
    let mesh = mesh_of(&picture, 8.0);
    // Half of the light is 188 in sRGB; naive means of the coded values are 128, single places 0 or 255.
    let is_half = |drawn: &Pixels, margin: u32| {
        let size = drawn.size();
        let inner =
            (margin..size.y - margin).flat_map(|y| (margin..size.x - margin).map(move |x| (y * size.x + x) as usize));
        inner.map(|i| drawn.wide(i)[0] / 257).all(|v| v.abs_diff(188) <= 6)
    };
    for factor in [0.25, 0.125, 1.0 / 7.3] {
        let canvas = Canvas::of(&picture, factor).unwrap();
        assert!(is_half(&render(&picture, &mesh, &mesh.rest, &canvas), 1), "scale {factor}");
    }
    // Shrunk in one direction only, and not along the axes.
    let turn =
        glam::DMat2::from_angle(0.4) * glam::DMat2::from_diagonal(dvec2(0.2, 1.0)) * glam::DMat2::from_angle(-0.4);
    let warped: Vec<DVec2> = mesh.rest.iter().map(|p| dvec2(128.0, 128.0) + turn * (*p - 128.0)).collect();
    let drawn = render(&picture, &mesh, &warped, &Canvas::of(&picture, 1.0).unwrap());
    let near = (118..138_usize).flat_map(|y| (118..138).map(move |x| y * 256 + x)).map(|i| drawn.wide(i)[0] / 257);
    let values: Vec<u16> = near.collect();
    let (low, high) = (values.iter().min().unwrap(), values.iter().max().unwrap());
    assert!(*low > 150 && *high < 220, "{low}..{high}");
    assert!(!is_half(&picture.pixels, 1), "sabotage: the board itself is no grey");
}

#[test]
fn an_opening_gap_shows_nothing_of_the_other_side() {
    // A red and a green half, one pixel apart.
    let image = RgbaImage::from_fn(60, 40, |x, _| match x {
        0..=29 => Rgba([220, 0, 0, 255]),
        30 => Rgba([0; 4]),
        _ => Rgba([0, 220, 0, 255]),
    });
    let picture = picture_of(image);
    let quads = [[0.0, 30.0], [31.0, 60.0]]
        .map(|[low, high]| [dvec2(low, 0.0), dvec2(high, 0.0), dvec2(high, 40.0), dvec2(low, 40.0)]);
    let mesh = FlatMesh { rest: quads.concat(), triangles: vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]] };
    let warped: Vec<DVec2> = mesh.rest.iter().map(|p| if p.x > 30.5 { *p + dvec2(10.0, 0.0) } else { *p }).collect();
    let canvas = Canvas::around(&picture, &mesh, [&warped[..]], 1.0).unwrap();
    let drawn = render(&picture, &mesh, &warped, &canvas);
    let row: Vec<[u16; 4]> = (0..drawn.size().x).map(|x| drawn.wide((20 * drawn.size().x + x) as usize)).collect();
    let is_clean = |row: &[[u16; 4]]| row.iter().enumerate().all(|(x, p)| p[3] == 0 || (p[0] > p[1]) == (x < 35));
    assert!(is_clean(&row), "{row:?}");
    assert_eq!(row[34][3], 0, "the gap is open");
    let mut ghost = row.clone();
    ghost[33] = [0, 50000, 0, 65535];
    assert!(!is_clean(&ghost), "sabotage");
}

#[test]
fn same_bits_for_any_number_of_threads() {
    let picture = picture_of(disc(90, 35.0, [10, 200, 90], [0; 3]));
    let mesh = mesh_of(&picture, 4.0);
    let warped = waved(&mesh, picture.size);
    let canvas = Canvas::around(&picture, &mesh, [&warped[..]], 1.3).unwrap();
    let drawn = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| render(&picture, &mesh, &warped, &canvas))
    };
    assert_eq!(drawn(1), drawn(3));
}

#[test]
fn the_canvas_holds_every_state() {
    let picture = picture_of(colourful(50, 40));
    let mesh = mesh_of(&picture, 10.0);
    let moved = |offset: DVec2| mesh.rest.iter().map(|p| *p + offset).collect::<Vec<_>>();
    let (left, down) = (moved(dvec2(-20.3, 0.0)), moved(dvec2(0.0, 7.5)));
    assert_eq!(Canvas::around(&picture, &mesh, [&mesh.rest[..]], 1.0).unwrap(), Canvas::of(&picture, 1.0).unwrap());
    let canvas = Canvas::around(&picture, &mesh, [&left[..], &down[..]], 2.0).unwrap();
    assert!(canvas.low.x <= -21 && canvas.low.y == 0);
    assert!(canvas.size.x >= 2 * 71 && canvas.size.y >= 2 * 48 && canvas.size.y < 2 * 52, "{canvas:?}");
    for state in [&left, &down] {
        let area = opaque_area(&render(&picture, &mesh, state, &canvas));
        assert!((area / (4.0 * 2000.0) - 1.0).abs() < 0.01, "all of it is drawn: {area}");
    }
    assert!(sentence(Canvas::of(&picture, 1000.0)).contains("scale of at most"));
    for scale in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(sentence(Canvas::of(&picture, scale)).contains("scale"));
    }
}

#[test]
fn crossings_are_marked_in_red() {
    let picture = picture_of(colourful(50, 40));
    let canvas = Canvas::of(&picture, 2.0).unwrap();
    let mut drawn = Pixels::Eight(RgbaImage::new(100, 80));
    mark(&mut drawn, &canvas, &[(dvec2(5.0, 20.0), dvec2(45.0, 20.0))], 3.0, Rgba([230, 0, 0, 255]));
    let Pixels::Eight(image) = &drawn else { unreachable!() };
    assert_eq!(image.get_pixel(50, 39).0, [230, 0, 0, 255]);
    assert_eq!(image.get_pixel(50, 10).0[3], 0);
    let covered = opaque_area(&drawn);
    assert!((covered - (80.0 * 3.0 + std::f64::consts::PI * 1.5 * 1.5)).abs() < 4.0, "{covered}");
}
