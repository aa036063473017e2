//! Contract of the scenes of Fig. 7: each model is one closed surface that lies on its implicit shape, its table covers
//! its regions, and it shows the paper's point: Eq. 1 alone makes it cross itself, the method does not, in any frame.

mod common;

use std::collections::{HashMap, HashSet};
use std::path::Path;

use homunculus::boundary::{Attribute, Boundary};
use homunculus::gallery::models::{Figure, figures};
use homunculus::gallery::{self, with_values};
use homunculus::importance::{Layer, Stack};
use homunculus::{
    run,
    run::Outcome,
    settings::{Reference, Settings},
};

/// Cells along the longest side in these tests: coarse, so that all nine take a minute.
const COARSE: u32 = 36;

/// The figure's surface with its importance as an attribute.
fn boundary(figure: &Figure) -> Boundary {
    let scene = gallery::open(figure.name).expect("a listed scene opens");
    let mut boundary = scene.model.boundary;
    boundary.attributes.push(Attribute { name: "importance".into(), values: scene.importance });
    boundary
}

fn warp(boundary: &Boundary, resolution: u32, keys: usize, reference: Option<Reference>) -> Outcome {
    let layers = [Layer::Attribute { name: "importance".into(), range: None }];
    let stack = Stack::load(&layers, 1.0, false, boundary, Path::new("")).expect("the attribute is there");
    let settings = Settings { resolution, fidelity: 0.8, keys, reference };
    run::warp(boundary, &stack, &settings, &common::Quiet).expect("it can be warped")
}

/// What is wrong with a surface that should be one closed, oriented manifold; empty when nothing is.
fn surface_faults(boundary: &Boundary) -> Vec<String> {
    let mut faults = Vec::new();
    let mut directed: HashMap<(u32, u32), u32> = HashMap::new();
    for t in &boundary.triangles {
        for k in 0..3 {
            *directed.entry((t[k], t[(k + 1) % 3])).or_default() += 1;
        }
    }
    let bad = directed.iter().filter(|((a, b), n)| **n != 1 || directed.get(&(*b, *a)) != Some(&1)).count();
    if bad > 0 {
        faults.push(format!("{bad} edges are not shared by exactly two triangles in opposite directions"));
    }
    // Each vertex has one fan of triangles: going round it from edge to edge meets them all.
    let mut around: HashMap<u32, HashMap<u32, u32>> = HashMap::new();
    for t in &boundary.triangles {
        for k in 0..3 {
            around.entry(t[k]).or_default().insert(t[(k + 1) % 3], t[(k + 2) % 3]);
        }
    }
    let pinched = around.values().filter(|fan| {
        let start = fan.keys().next().copied().unwrap_or_default();
        let (mut at, mut seen) = (start, 0);
        while let Some(&next) = fan.get(&at) {
            seen += 1;
            at = next;
            if at == start || seen > fan.len() {
                break;
            }
        }
        seen != fan.len()
    });
    let pinched = pinched.count();
    if pinched > 0 {
        faults.push(format!("{pinched} vertices at which the surface is pinched"));
    }
    let mut reached: HashSet<u32> = HashSet::new();
    let mut open: Vec<u32> = boundary.triangles.first().map_or_else(Vec::new, |t| vec![t[0]]);
    while let Some(v) = open.pop() {
        if reached.insert(v) {
            open.extend(around.get(&v).into_iter().flat_map(HashMap::keys));
        }
    }
    if reached.len() != boundary.positions.len() {
        faults.push(format!("{} of {} vertices hang together", reached.len(), boundary.positions.len()));
    }
    faults
}

#[test]
fn each_model_is_one_closed_surface() {
    assert_eq!(figures().len(), 9);
    for figure in figures() {
        let model = figure.model().expect("the baked model reads");
        assert_eq!(surface_faults(&model.boundary), Vec::<String>::new(), "{}", figure.name);
        assert!((15_000..=60_000).contains(&model.boundary.triangles.len()), "{}", figure.name);
    }
}

#[test]
fn sabotage_a_hole_a_turned_triangle_a_pinch_and_a_loose_vertex_are_seen() {
    let good = figures()[0].model().expect("the baked model reads").boundary;
    let spoiled = |change: &dyn Fn(&mut Boundary)| {
        let mut boundary = good.clone();
        change(&mut boundary);
        surface_faults(&boundary).len()
    };
    assert_eq!(spoiled(&|_| ()), 0);
    assert!(spoiled(&|b| b.triangles.truncate(b.triangles.len() - 1)) > 0);
    assert!(spoiled(&|b| b.triangles[7].swap(0, 1)) > 0);
    assert!(spoiled(&|b| b.positions.push(glam::DVec3::ZERO)) > 0);
    assert!(spoiled(&|b| b.triangles.iter_mut().flatten().filter(|v| **v == 900).for_each(|v| *v = 3)) > 0);
}

#[test]
fn no_triangle_passes_through_another() {
    for figure in figures() {
        let boundary = figure.model().expect("the baked model reads").boundary;
        match common::self_intersections(&boundary) {
            Some(count) => assert_eq!(count, 0, "{}", figure.name),
            None => return eprintln!("skipped: python3 with meshlib is not here"),
        }
    }
}

/// Share of the vertices that lie farther than a millimetre from the implicit shape.
fn off_the_shape(figure: &Figure, boundary: &Boundary) -> f64 {
    let solid = (figure.solid)();
    let off = boundary.positions.iter().filter(|p| solid.distance(p.as_vec3()).abs() > 1e-3).count();
    off as f64 / boundary.positions.len() as f64
}

#[test]
fn the_baked_models_lie_on_the_implicit_ones() {
    for figure in figures() {
        let mut boundary = figure.model().expect("the baked model reads").boundary;
        // A sharp furrow (between the folds of a gut) holds a few vertices that Newton's method swings about.
        let share = off_the_shape(figure, &boundary);
        assert!(share < 0.002, "{}: {share} lie off it; run `cargo run --release --example bake_models`", figure.name);
        boundary.positions.iter_mut().for_each(|p| p.y += 0.01);
        assert!(off_the_shape(figure, &boundary) > 0.2, "sabotage: a moved surface must be seen");
    }
}

#[test]
fn each_table_covers_its_regions_and_says_where_it_is_from() {
    for figure in figures() {
        let model = figure.model().expect("the baked model reads");
        let values = figure.values().expect("a shipped table reads");
        assert!(with_values(&model, &values).is_ok(), "{}", figure.name);
        assert!(with_values(&model, &values[1..]).is_err(), "sabotage: a region without a value must be seen");
        let labels = &model.boundary.regions.as_ref().expect("a model has regions").of_vertex;
        for (k, name) in model.region_names.iter().enumerate() {
            assert!(labels.contains(&(k as u32)), "{}: region `{name}` is empty", figure.name);
        }
        let mut rows = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(figure.table().as_bytes());
        for row in rows.records() {
            let row = row.expect("a row");
            assert_eq!(row.len(), 6, "{}", figure.name);
            assert!(row.iter().all(|cell| !cell.trim().is_empty()), "{}: every cell is filled", figure.name);
        }
    }
}

/// The importance column against what the table's comment says it is, for a table whose comment states a formula.
fn off_the_formula(name: &str, formula: &dyn Fn(f64) -> f64) -> usize {
    let figure = figures().iter().find(|f| f.name == name).expect("a figure");
    let mut rows = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(figure.table().as_bytes());
    let number = |row: &csv::StringRecord, k: usize| row[k].parse::<f64>().expect("a number");
    rows.records().map(|r| r.expect("a row")).filter(|r| (number(r, 1) - formula(number(r, 2))).abs() > 6e-4).count()
}

#[test]
fn tables_hold_what_their_formulas_say() {
    let price = |p: f64| 3.2 * (p / 2100.0).powf(0.484);
    let torque = |t: f64| if t > 0.0 { 2.3 * (t / 120.0).sqrt() } else { 0.8 };
    let heat = |t: f64| (2.4 * ((t - 20.0) / 180.0).powf(0.4)).max(0.7);
    assert_eq!(off_the_formula("elephant", &price), 0);
    assert_eq!(off_the_formula("robot", &torque), 0);
    assert_eq!(off_the_formula("lamp", &heat), 0);
    for name in ["airplane", "goalkeeper", "flowers", "bike", "colon", "comic"] {
        assert_eq!(off_the_formula(name, &|v| v), 0, "{name}");
    }
    assert!(off_the_formula("elephant", &torque) > 0, "sabotage: another formula must not fit");
}

#[test]
fn each_scene_is_certified_in_every_frame() {
    for figure in figures() {
        let start = std::time::Instant::now();
        let outcome = warp(&boundary(figure), COARSE, 3, None);
        for frame in &outcome.frames {
            assert!(frame.certificate.certified(), "{} at λ = {}: {:?}", figure.name, frame.lambda, frame.certificate);
        }
        println!("{}: {} frames, {:.1} s", figure.name, outcome.frames.len(), start.elapsed().as_secs_f64());
    }
}

#[test]
fn classic_deformation_crosses_itself_in_each_scene() {
    for figure in figures() {
        let mut boundary = boundary(figure);
        let crossings =
            |boundary: &Boundary| warp(boundary, figure.resolution, 1, Some(Reference::Eq1)).certificate.crossings();
        let count = crossings(&boundary);
        println!("{}: {count} crossings", figure.name);
        assert!(count > 0, "{}", figure.name);
        if figure.name == "airplane" {
            boundary.attributes.iter_mut().for_each(|a| a.values.fill(1.0));
            assert_eq!(crossings(&boundary), 0, "sabotage: where all keeps its size, nothing may be counted");
        }
    }
}
