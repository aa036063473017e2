//! Which importance a pixel gets, and which area that asks for.

use crate::{Files, colourful, ids, mesh_of, picture_of, png_bytes, regions, sentence, shared};
use glam::{DVec2, dvec2};
use homunculus::{
    importance::{Field, Layer, RegionArea, areas, median_error, worst},
    picture::{self, Cut},
};
use image::{GrayImage, Luma, Rgba, RgbaImage};

fn image_layer(range: Option<(f32, f32)>) -> Layer {
    Layer::Image { path: "map.png".into(), range }
}

#[test]
fn layers_apply_in_order() {
    let picture = picture_of(colourful(40, 30));
    let disc = |value| Layer::Sphere { centre: [20.5, 15.5, 0.0], radius: 8.0, value };
    let map = png_bytes(GrayImage::from_fn(40, 30, |x, _| Luma([if x < 20 { 0 } else { 255 }])));
    let files = Files::new(&[("map.png", map)]);
    let at = |field: &Field, x: u32, y: u32| field.values[(y * 40 + x) as usize];
    let field = files.load(&[image_layer(Some((0.5, 3.0))), disc(2.0)], &picture).unwrap();
    assert_eq!((at(&field, 0, 0), at(&field, 39, 0)), (0.5, 3.0));
    assert!((at(&field, 20, 15) - 2.0).abs() < 1e-6, "the disc is over the map");
    let field = files.load(&[disc(2.0), image_layer(Some((0.5, 3.0)))], &picture).unwrap();
    assert!((at(&field, 20, 15) - 3.0).abs() < 1e-6, "the map is over the disc");
    let field = files.load(&[disc(2.0)], &picture).unwrap();
    assert_eq!(at(&field, 0, 0), 1.0);
    let half = at(&field, 24, 15);
    assert!((f64::from(half).ln() / 2f64.ln() - homunculus::importance::falloff(0.5)).abs() < 1e-6, "{half}");
    let aside = Layer::Sphere { centre: [500.0, 500.0, 0.0], radius: 3.0, value: 2.0 };
    assert!(files.load(&[aside], &picture).unwrap().warnings[0].contains("nothing of the body"));
}

#[test]
fn of_a_dab_the_third_coordinate_means_nothing_and_the_rest_is_checked() {
    let picture = picture_of(colourful(40, 30));
    let load = |centre: [f64; 3], radius: f64, value: f32| {
        let layer = Layer::Sphere { centre, radius, value };
        Field::load(&[layer], 1.0, false, &picture, std::path::Path::new(""))
    };
    let field = load([20.0, 15.0, 0.0], 8.0, 1.5).unwrap();
    assert_eq!(load([20.0, 15.0, 99.0], 8.0, 1.5).unwrap(), field);
    assert_ne!(load([20.0, 16.0, 0.0], 8.0, 1.5).unwrap(), field, "sabotage: the others do");
    for (x, radius, value) in [(3.0, -2.0, 1.5), (3.0, 2.0, 0.0), (f64::NAN, 2.0, 2.0), (3.0, f64::INFINITY, 2.0)] {
        assert!(sentence(load([x, 4.0, 0.0], radius, value)).contains("disc"));
    }
}

#[test]
fn what_speaks_of_vertices_is_refused() {
    let picture = picture_of(colourful(40, 30));
    for layer in [Layer::Attribute { name: "a".into(), range: None }, Layer::Values { path: "v.csv".into() }] {
        let problem = sentence(Field::load(&[layer], 1.0, false, &picture, std::path::Path::new("")));
        assert!(problem.contains("a picture has no vertices"), "{problem}");
    }
}

#[test]
fn maps_are_read_back_along_their_colours() {
    let picture = picture_of(colourful(128, 8));
    let load = |map: RgbaImage| {
        Files::new(&[("map.png", png_bytes(map))]).load(&[image_layer(Some((1.0, 2.0)))], &picture).unwrap()
    };
    let maps = [
        ("viridis", colorous::VIRIDIS, false),
        ("magma", colorous::MAGMA, false),
        ("inferno", colorous::INFERNO, false),
        ("plasma", colorous::PLASMA, false),
        ("turbo", colorous::TURBO, false),
        ("red-blue", colorous::RED_BLUE, true),
    ];
    for (name, gradient, is_reversed) in maps {
        let map = RgbaImage::from_fn(128, 8, |x, _| {
            let t = f64::from(x) / 127.0;
            let colour = gradient.eval_continuous(if is_reversed { 1.0 - t } else { t });
            Rgba([colour.r, colour.g, colour.b, 255])
        });
        let field = load(map);
        assert!(field.warnings[0].contains(name), "{:?}", field.warnings);
        let off = (0..128).map(|x| (f64::from(field.values[x]) - 1.0 - x as f64 / 127.0).abs()).fold(0.0, f64::max);
        assert!(off < 0.02, "{name}: {off} off");
    }
    let grey = load(RgbaImage::from_fn(128, 8, |x, _| Rgba([2 * x as u8, 2 * x as u8, 2 * x as u8, 255])));
    assert!(grey.warnings[0].contains("grey") && (grey.values[64] - 1.0 - 128.0 / 255.0).abs() < 1e-5);
    let photo = load(colourful(128, 8));
    assert!(photo.warnings[0].contains("no map"), "sabotage: any colours are not a map: {:?}", photo.warnings);
}

#[test]
fn values_become_importance_or_area() {
    let field = regions("region,importance\n1,2.5\n2,0.5\n", false).unwrap();
    assert_eq!((field.values[0], field.values[17], field.values[30]), (2.5, 0.5, 1.0));
    let field = regions("name,region,value\nA,1,300\nB,2,900\n", true).unwrap();
    // Of 20 columns the second region gets three quarters: 15 for its 4.
    assert!((field.values[17] - (15.0_f32 / 4.0).sqrt()).abs() < 1e-6);
    assert!((field.values[0] - (5.0_f32 / 16.0).sqrt()).abs() < 1e-6);
    assert_eq!(field.values[30], 1.0);
    let area: f64 = (0..1200).filter(|i| i % 40 < 20).map(|i| f64::from(field.values[i]).powi(2)).sum();
    assert!((area / 600.0 - 1.0).abs() < 1e-5, "the regions together keep their area");
    let regions = field.regions.as_ref().unwrap();
    assert_eq!((&regions.ids[..], &regions.names[..]), (&[1, 2][..], &["A".to_owned(), "B".to_owned()][..]));
    let rms = field.over(&[true; 1200], dvec2(15.0, 3.0), dvec2(17.0, 3.5)).unwrap();
    assert!((f64::from(rms).powi(2) - (15.0 / 4.0 + 5.0 / 16.0) / 2.0).abs() < 1e-6);
    assert_eq!(field.over(&[false; 1200], DVec2::ZERO, DVec2::splat(4.0)), None);
}

#[test]
fn tables_that_do_not_fit_are_refused_with_the_row() {
    let problem = |table: &str| sentence(regions(table, false));
    assert!(problem("region,importance\n1,2\n2,1\n7,1\n").contains("row 4: unknown region 7"));
    assert!(problem("region,importance\n1,2\n").contains("no row for region 2"));
    assert!(problem("region,importance\n1,2\n2,0\n").contains("row 3: importance 0 is not greater than 0"));
    assert!(problem("region,importance\n1,2\n2,inf\n").contains("is not finite"));
    assert!(problem("region,importance\n1,2\n2,many\n").contains("row 3"));
    assert!(problem("region,importance\n1,2\nTexas,1\n").contains("`Texas`"));
    assert!(problem("region,importance\n1,2\n1,1\n2,1\n").contains("already given on row 2"));
    assert!(problem("region,value\n1,2\n2,1\n").contains("--per-area"));
    assert!(problem("").contains("row 1"));
    assert!(problem("region,importance\n").contains("no row below"));
    assert!(sentence(regions("region,value\n1,2\n2,-5\n", true)).contains("row 3: importance -5"));

    let picture = picture_of(colourful(41, 30));
    let files = Files::new(&[
        ("id.png", png_bytes(ids())),
        ("map.png", png_bytes(ids())),
        ("v.csv", "region,importance\n1,2\n2,1\n".into()),
    ]);
    let layer = Layer::Regions { regions: "id.png".into(), values: "v.csv".into(), per_area: false };
    for layer in [layer, image_layer(None)] {
        let problem = sentence(files.load(&[layer], &picture));
        assert!(problem.contains("40 × 30") && problem.contains("41 × 30"), "{problem}");
    }
    let coloured =
        Files::new(&[("id.png", png_bytes(colourful(40, 30))), ("v.csv", "region,importance\n1,2\n".into())]);
    let layer = Layer::Regions { regions: "id.png".into(), values: "v.csv".into(), per_area: false };
    assert!(sentence(coloured.load(&[layer], &picture_of(colourful(40, 30)))).contains("is coloured"));
}

#[test]
fn clamp_moves_what_would_be_refused() {
    let picture = picture_of(colourful(40, 30));
    let files = Files::new(&[("id.png", png_bytes(ids())), ("v.csv", "region,importance\n1,-2\n2,90\n".into())]);
    let layer = Layer::Regions { regions: "id.png".into(), values: "v.csv".into(), per_area: false };
    let field = Field::load(&[layer], 1.0, true, &picture, files.0.path()).unwrap();
    assert_eq!((field.values[0], field.values[17], field.clamped), (0.05, 20.0, 2));
}

#[test]
fn areas_are_those_of_the_images() {
    let picture = picture_of(colourful(40, 30));
    let field = regions("region,value\n1,300\n2,900\n", true).unwrap();
    let mesh = mesh_of(&picture, 4.0);
    let measure = |place: &dyn Fn(DVec2) -> DVec2| {
        areas(&field, &picture, &mesh, &mesh.rest.iter().map(|p| place(*p)).collect::<Vec<_>>())
    };
    let still = measure(&|p| p);
    assert!((still[0].achieved - 480.0).abs() < 1e-9 && (still[1].achieved - 120.0).abs() < 1e-9);
    assert!((still[0].asked - 150.0).abs() < 1e-3 && (still[1].asked - 450.0).abs() < 1e-3);
    // x as the values want it: the first 16 columns on 5, the next 4 on 15.
    let asked = |p: DVec2| dvec2(if p.x < 16.0 { p.x * 5.0 / 16.0 } else { 5.0 + (p.x - 16.0) * 15.0 / 4.0 }, p.y);
    let reached = measure(&asked);
    assert!(reached.iter().all(|r| r.error() < 1e-6), "{reached:?}");
    assert!(median_error(&reached) < 1e-6);
    let missed = measure(&|p| 1.1 * asked(p));
    assert!((worst(&missed).unwrap().error() - 0.21).abs() < 1e-6, "sabotage: ten per cent longer is seen");
    let row = |achieved| RegionArea { name: String::new(), asked: 1.0, achieved };
    assert!((median_error(&[row(1.1), row(1.3), row(0.5), row(1.0)]) - 0.2).abs() < 1e-12);
    assert_eq!(median_error(&[]), 0.0);
}

#[test]
fn states_of_the_shared_map_are_measured() {
    let (Some(images), Some(facts)) = (shared("images"), shared("facts/us_states.csv")) else { return };
    let picture = picture::read(&images.join("us_states.png"), &Cut::default()).unwrap();
    let mut reader = csv::Reader::from_path(facts).unwrap();
    let rows = reader.records().map(|r| r.unwrap()).map(|r| format!("{},{},{}\n", &r[0], &r[1], &r[2]));
    let table = format!("region,name,value\n{}", rows.collect::<String>());
    let layer = Layer::Regions { regions: images.join("us_states_id.png"), values: "v.csv".into(), per_area: true };
    let field = Files::new(&[("v.csv", table.into())]).load(&[layer], &picture).unwrap();
    assert_eq!(field.regions.as_ref().unwrap().ids.len(), 51);
    let mesh = mesh_of(&picture, 975.0 / 256.0);
    let still = areas(&field, &picture, &mesh, &mesh.rest);
    let (asked, achieved): (f64, f64) = still.iter().fold((0.0, 0.0), |(a, b), r| (a + r.asked, b + r.achieved));
    assert!((asked / achieved - 1.0).abs() < 1e-4, "the states together keep their area: {asked} of {achieved}");
    assert_eq!(worst(&still).unwrap().name, "Wyoming", "seventeen times as large as its people ask for");
}
