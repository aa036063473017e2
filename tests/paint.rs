//! Contract of painting: a dab changes importance where it should and nowhere else, undo restores the very bits, what is
//! saved paints the same again.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

use std::path::Path;
use std::sync::Arc;

use glam::DVec3;
use homunculus::boundary::{Boundary, Regions};
use homunculus::importance::{Layer, Stack};
use homunculus::paint::{self, Action, Axis, Brush, Canvas, Dab, Edit, Falloff, Fill, Painting, Under};
use homunculus::scene::{Draft, Scene, Source};

/// Two square sheets of `n × n` quads at z = 0 and z = 3, both 0..1 in x and y, with the left half of each a region.
fn sheets(n: u32) -> Boundary {
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for sheet in 0..2 {
        let first = positions.len() as u32;
        for j in 0..=n {
            for i in 0..=n {
                positions.push(DVec3::new(
                    f64::from(i) / f64::from(n),
                    f64::from(j) / f64::from(n),
                    f64::from(sheet) * 3.0,
                ));
            }
        }
        let at = |i: u32, j: u32| first + j * (n + 1) + i;
        for j in 0..n {
            for i in 0..n {
                triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
                triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
    }
    let of_vertex = positions.iter().map(|p| u32::from(p.x > 0.5)).collect();
    let mut boundary = Boundary::from_triangles("sheets", positions, triangles);
    boundary.regions = Some(Regions { names: vec!["left".into(), "right".into()], of_vertex });
    boundary
}

fn under(boundary: &Arc<Boundary>, layers: Vec<Layer>) -> Under {
    let stack = Stack::load(&layers, 1.0, false, boundary, Path::new("")).unwrap();
    Under {
        layers,
        hidden: Vec::new(),
        base: 1.0,
        clamp: false,
        boundary: boundary.clone(),
        stack: Arc::new(stack),
        subject: (),
    }
}

fn hill() -> Layer {
    Layer::Sphere { centre: [0.3, 0.3, 0.0], radius: 0.4, value: 3.0 }
}

fn painting(layers: Vec<Layer>) -> (Arc<Boundary>, Painting) {
    let boundary = Arc::new(sheets(20));
    let canvas = Arc::new(Canvas::new(&boundary));
    let under = under(&boundary, layers);
    (boundary, Painting::new(canvas, under, Vec::new()))
}

fn brush(action: Action, value: f32, strength: f32) -> Brush {
    Brush { action, value, strength, ..Brush::default() }
}

fn stroke(painting: &mut Painting, brush: Brush, at: &[[f64; 3]], radius: f64) {
    painting.begin(brush);
    for &centre in at {
        painting.dab(Dab { centre, radius });
    }
    painting.end();
}

fn bits(painting: &Painting) -> Vec<u64> {
    painting.ln().iter().map(|ln| ln.to_bits()).collect()
}

/// Vertices whose importance is not 1.
fn changed(boundary: &Boundary, painting: &Painting) -> Vec<DVec3> {
    let changed = boundary.positions.iter().zip(painting.importance()).filter(|(_, f)| *f != 1.0);
    changed.map(|(p, _)| *p).collect()
}

#[test]
fn a_dab_changes_what_is_within_its_radius() {
    let (boundary, mut painting) = painting(vec![]);
    let centre = [0.5, 0.5, 0.0];
    stroke(&mut painting, brush(Action::Set, 2.0, 1.0), &[centre], 0.22);
    let changed = changed(&boundary, &painting);
    let within = boundary.positions.iter().filter(|p| p.distance(DVec3::from_array(centre)) < 0.22);
    assert_eq!(changed.len(), within.count());
    assert!(changed.len() > 20);
    let at = boundary.positions.iter().position(|p| *p == DVec3::from_array(centre)).unwrap();
    assert_eq!(painting.importance()[at], 2.0);
}

#[test]
fn sabotage_a_dab_elsewhere_is_seen() {
    let (boundary, mut painting) = painting(vec![]);
    stroke(&mut painting, brush(Action::Set, 2.0, 1.0), &[[0.5, 0.6, 0.0]], 0.22);
    let within = |p: &DVec3| p.distance(DVec3::new(0.5, 0.5, 0.0)) < 0.22;
    assert!(changed(&boundary, &painting).iter().any(|p| !within(p)));
}

#[test]
fn each_action_does_what_it_says() {
    let centre = [0.5, 0.5, 0.0];
    let after = |action, value| {
        let (boundary, mut painting) = painting(vec![Layer::Sphere { centre, radius: 5.0, value: 2.0 }]);
        let at = boundary.positions.iter().position(|p| *p == DVec3::from_array(centre)).unwrap();
        stroke(&mut painting, brush(Action::Set, 8.0, 0.5), &[centre], 0.3);
        assert!((painting.importance()[at] - 4.0).abs() < 1e-5, "half-way in the logarithm from 2 to 8");
        stroke(&mut painting, brush(action, value, 1.0), &[centre], 0.3);
        painting.importance()[at]
    };
    assert!((after(Action::Set, 0.5) - 0.5).abs() < 1e-5);
    assert!((after(Action::Add, 2.0) - 8.0).abs() < 1e-5);
    assert!((after(Action::Subtract, 2.0) - 2.0).abs() < 1e-5);
    assert!((after(Action::Erase, 9.0) - 2.0).abs() < 1e-5, "back to the layer");
    let smoothed = after(Action::Smooth, 9.0);
    assert!(smoothed < 4.0 && smoothed > 2.0, "{smoothed}");
    assert!((after(Action::Add, 20.0) - 20.0).abs() < 1e-4, "what is added stays within what the method can do");
}

#[test]
fn a_stroke_is_no_stronger_for_passing_twice() {
    let at = [[0.4, 0.5, 0.0], [0.5, 0.5, 0.0], [0.4, 0.5, 0.0]];
    let (_, mut once) = painting(vec![]);
    let (_, mut twice) = painting(vec![]);
    stroke(&mut once, brush(Action::Add, 2.0, 0.5), &at[..2], 0.2);
    stroke(&mut twice, brush(Action::Add, 2.0, 0.5), &at, 0.2);
    assert_eq!(bits(&once), bits(&twice));
    stroke(&mut twice, brush(Action::Add, 2.0, 0.5), &at[..1], 0.2);
    assert_ne!(bits(&once), bits(&twice), "a second stroke is");
}

#[test]
fn a_mirror_paints_both_sides() {
    let (boundary, mut painting) = painting(vec![]);
    let brush = Brush { mirror: [true, false, true], falloff: Falloff::Constant, ..brush(Action::Set, 2.0, 1.0) };
    stroke(&mut painting, brush, &[[0.2, 0.4, 0.0]], 0.11);
    let painted = changed(&boundary, &painting);
    assert!(!painted.is_empty());
    for p in &painted {
        let mirrored = DVec3::new(1.0 - p.x, p.y, 3.0 - p.z);
        assert!(painted.iter().any(|q| q.distance(mirrored) < 1e-9), "{p}");
    }
}

#[test]
fn fills_reach_what_they_name() {
    let fill = |fill| {
        let (boundary, mut painting) = painting(vec![]);
        painting.apply(Edit::Fill(fill)).unwrap();
        (changed(&boundary, &painting), painting.importance())
    };
    assert!(fill(Fill::Region { name: "left".into(), value: 2.0 }).0.iter().all(|p| p.x <= 0.5));
    let (connected, _) = fill(Fill::Connected { vertex: 0, value: 2.0 });
    assert_eq!(connected.len(), 21 * 21);
    assert!(connected.iter().all(|p| p.z == 0.0));
    assert_eq!(fill(Fill::All { value: 2.0 }).0.len(), 2 * 21 * 21);
    let (_, gradient) = fill(Fill::Gradient { axis: Axis::X, from: 0.5, to: 2.0 });
    assert!((gradient[0] - 0.5).abs() < 1e-6 && (gradient[10] - 1.0).abs() < 1e-6 && (gradient[20] - 2.0).abs() < 1e-6);
}

/// A hundred and fifty changes of every kind.
fn many(painting: &mut Painting, boundary: &Arc<Boundary>) -> Vec<Vec<u64>> {
    let mut random = 7_u64;
    let mut unit = || {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (random >> 11) as f64 / (1_u64 << 53) as f64
    };
    let actions = [Action::Set, Action::Add, Action::Subtract, Action::Smooth, Action::Erase];
    let mut seen = vec![bits(painting)];
    for k in 0..150 {
        match k % 10 {
            8 => painting.apply(Edit::Fill(Fill::Region { name: "right".into(), value: 1.5 })).unwrap(),
            9 => {
                let layers = if k % 20 == 9 { vec![hill()] } else { vec![] };
                painting.set_under(under(boundary, layers));
            }
            _ => {
                let brush = Brush { mirror: [k % 3 == 0, false, false], ..brush(actions[k % 5], 2.0, 0.7) };
                let at: Vec<[f64; 3]> =
                    (0..4).map(|_| [unit(), unit(), if unit() < 0.5 { 0.0 } else { 3.0 }]).collect();
                stroke(painting, brush, &at, 0.25);
            }
        }
        seen.push(bits(painting));
    }
    seen
}

#[test]
fn undo_and_redo_restore_the_bits() {
    let (boundary, mut painting) = painting(vec![hill()]);
    let seen = many(&mut painting, &boundary);
    for before in seen.iter().rev().skip(1) {
        assert!(painting.undo());
        assert_eq!(bits(&painting), *before);
    }
    assert!(!painting.undo(), "nothing is left to undo");
    for after in &seen[1..] {
        assert!(painting.redo());
        assert_eq!(bits(&painting), *after);
    }
    assert!(!painting.redo());
}

#[test]
fn sabotage_a_change_that_is_not_undone_is_seen() {
    let (boundary, mut painting) = painting(vec![hill()]);
    let seen = many(&mut painting, &boundary);
    painting.undo();
    assert_ne!(bits(&painting), *seen.last().unwrap());
}

#[test]
fn a_new_change_forgets_what_was_undone_and_a_cancelled_stroke_never_was() {
    let (_, mut painting) = painting(vec![]);
    let before = bits(&painting);
    painting.begin(brush(Action::Set, 3.0, 1.0));
    painting.dab(Dab { centre: [0.5, 0.5, 0.0], radius: 0.3 });
    assert_ne!(bits(&painting), before);
    assert!(painting.cancel());
    assert_eq!((bits(&painting), painting.depth()), (before, (0, 0)));
    stroke(&mut painting, brush(Action::Set, 3.0, 1.0), &[[0.5, 0.5, 0.0]], 0.3);
    painting.undo();
    stroke(&mut painting, brush(Action::Set, 2.0, 1.0), &[[0.5, 0.5, 0.0]], 0.3);
    assert_eq!(painting.depth(), (1, 0));
}

#[test]
fn what_is_saved_paints_the_same_again() {
    let (boundary, mut painting) = painting(vec![hill()]);
    many(&mut painting, &boundary);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("s.ron");
    let mut draft = Draft::of(Source::Gallery("hand".into()));
    draft.layers = painting.under().layers.clone();
    draft.strokes = painting.edits().to_vec();
    let scene = Scene::new(draft).unwrap();
    scene.save(&path).unwrap();
    let loaded = Scene::load(&path).unwrap();
    assert_eq!(*loaded, *scene);
    let again = Painting::new(
        Arc::new(Canvas::new(&boundary)),
        under(&boundary, loaded.layers.clone()),
        loaded.strokes.clone(),
    );
    assert_eq!(bits(&again), bits(&painting));
    // And so does the command line.
    let stack = Stack::load(&loaded.layers, 1.0, false, &boundary, Path::new("")).unwrap();
    let differences = paint::differences(&boundary, &stack, &loaded.strokes).unwrap();
    let stack = stack.painted(differences);
    assert_eq!(stack.at_vertices(&boundary), painting.stack().at_vertices(&boundary));
}

#[test]
fn between_vertices_the_layers_keep_their_detail() {
    // One large triangle with a small sphere in its middle, and paint on one corner only.
    let boundary = Arc::new(Boundary::from_triangles("t", vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]]));
    let layers = vec![Layer::Sphere { centre: [0.3, 0.3, 0.0], radius: 0.1, value: 4.0 }];
    let mut painting = Painting::new(Arc::new(Canvas::new(&boundary)), under(&boundary, layers), Vec::new());
    stroke(&mut painting, brush(Action::Set, 2.0, 1.0), &[[1.0, 0.0, 0.0]], 0.1);
    let sample = homunculus::importance::Sample { triangle: 0, weights: [0.4, 0.3, 0.3] };
    let found = painting.stack().evaluate(&boundary, &[sample])[0];
    assert!((found - 4.0 * 2f32.powf(0.3)).abs() < 1e-4, "{found}");
}

#[test]
fn what_cannot_be_meant_is_refused() {
    let boundary = sheets(2);
    let refusal =
        |edit: Edit| paint::differences(&boundary, &Stack::uniform(1.0).unwrap(), &[edit]).unwrap_err().to_string();
    let region = refusal(Edit::Fill(Fill::Region { name: "nose".into(), value: 2.0 }));
    assert_eq!(region, "stroke 0: the surface has no region `nose`; it has left, right");
    assert!(refusal(Edit::Fill(Fill::All { value: 0.0 })).contains("0.05 to 20"));
    assert!(refusal(Edit::Fill(Fill::Connected { vertex: 99, value: 1.0 })).contains("no vertex 99; it has 18"));
    let dab = |radius| Edit::Stroke { brush: Brush::default(), dabs: vec![Dab { centre: [0.0; 3], radius }] };
    assert!(refusal(dab(0.0)).contains("radius > 0") && refusal(dab(f64::NAN)).contains("radius > 0"));
    let weak = Edit::Stroke { brush: brush(Action::Set, 1.0, 1.5), dabs: vec![] };
    assert!(refusal(weak).contains("strength 1.5 is not within 0 to 1"));
}
