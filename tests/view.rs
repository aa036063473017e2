//! Contract of the view: the first frame is whole, the same scene gives the same pixels, what the shader deforms is what the
//! transfer computes, crossings are red, colours are the legend's, and a ray finds what is drawn.
//!
//! Needs a Vulkan driver; a software driver will do. Without one each test says `skipped`.
#![cfg(feature = "render")]
#![allow(clippy::print_stdout, reason = "skipping is said aloud")]

mod common;

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use bevy::prelude::{Entity, Vec2, Vec3};
use common::cuboids;
use glam::{DVec3, Vec3A};
use homunculus::{
    boundary::Boundary,
    view::{
        Backdrop, Body, Ghost, Looks, Mode, Orbit, Picker, Placement, Pose, Quality, Studio, Target, Unhurried,
        ViewFrame, VoxelColour, Wipe, adapter,
        headless::{Renderer, Shown},
    },
    voxel::{blend, voxelize},
};
use image::RgbaImage;

const SIZE: [u32; 2] = [160, 120];

/// One at a time: a software driver takes all cores for each.
fn renderer() -> Option<(Renderer, MutexGuard<'static, ()>)> {
    static TURN: Mutex<()> = Mutex::new(());
    let turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    match adapter() {
        Ok(_) => Some((Renderer::new(SIZE, Quality::SOFTWARE).expect("a renderer"), turn)),
        Err(error) => {
            println!("skipped: {error}");
            None
        }
    }
}

fn bound(boundary: Boundary) -> Body {
    let complex = voxelize(&boundary, 12).expect("a complex");
    Body::new(Arc::new(boundary), Arc::new(complex))
}

/// A tower with a block on one side.
fn tower() -> Body {
    bound(cuboids("tower", &[([0.0; 3], [1.0, 3.0, 1.0]), ([1.5, 0.0, 0.0], [2.5, 1.0, 1.0])]))
}

/// A square pyramid with its tip up, 1 wide and high.
fn pyramid() -> Body {
    let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    let positions = vec![at(0.0, 0.0, 0.0), at(1.0, 0.0, 0.0), at(1.0, 0.0, 1.0), at(0.0, 0.0, 1.0), at(0.5, 1.0, 0.5)];
    let triangles = vec![[0, 1, 2], [0, 2, 3], [1, 0, 4], [2, 1, 4], [3, 2, 4], [0, 3, 4]];
    bound(Boundary::from_triangles("pyramid", positions, triangles))
}

/// A state that swells and leans, differently everywhere.
fn leaning(body: &Body) -> Arc<Vec<Vec3A>> {
    let lean = |p: &Vec3A| Vec3A::new(p.x * 1.1 + 0.02 * p.y * p.y, p.y * (1.2 + 0.01 * p.x), p.z * 0.9 + 0.05 * p.y);
    Arc::new(body.complex.rest.iter().map(lean).collect())
}

fn rest(body: &Body) -> Arc<Vec<Vec3A>> {
    Arc::new(body.complex.rest.clone())
}

fn look(renderer: &mut Renderer, orbit: Orbit) {
    *renderer.orbit().expect("a camera") = orbit;
}

fn set<B: bevy::prelude::Bundle>(renderer: &mut Renderer, entity: Entity, bundle: B) {
    renderer.world_mut().entity_mut(entity).insert(bundle);
}

/// Nothing behind or below: alpha is the body.
fn alone(renderer: &mut Renderer) {
    renderer.world_mut().insert_resource(Studio { backdrop: Backdrop::Transparent, floor: false });
}

/// Share of the picture that is covered.
fn coverage(frame: &RgbaImage) -> f64 {
    frame.pixels().filter(|p| p.0[3] > 127).count() as f64 / f64::from(SIZE[0] * SIZE[1])
}

/// How many grey levels a picture has: few where nothing is drawn.
fn levels(frame: &RgbaImage) -> usize {
    let mut seen = [false; 256];
    frame.pixels().for_each(|p| seen[usize::from(p.0[1])] = true);
    seen.iter().filter(|s| **s).count()
}

#[test]
fn the_first_frame_is_whole_and_no_frame_is_blank() {
    let Some((mut renderer, _turn)) = renderer() else { return };
    let empty = renderer.frame().expect("a frame");
    let body = renderer.show(Shown::new(tower()));
    let first = renderer.frame().expect("a frame");
    let second = renderer.frame().expect("a frame");
    assert_eq!(first.dimensions(), (SIZE[0], SIZE[1]));
    assert_eq!(first, second, "the first frame lacks something");
    assert!(levels(&first) > 120, "{} levels", levels(&first));
    // Sabotage: a picture of nothing is seen to be one.
    assert!(levels(&empty) < 100, "{} levels without a body", levels(&empty));
    // A change shows at once, in whatever is changed.
    let shape = tower();
    let mut before = second;
    let values = Arc::new(vec![2.0; shape.boundary.positions.len()]);
    let nodes = Arc::new(vec![0.5; shape.complex.nodes()]);
    let looks = [
        Looks { mode: Mode::Importance, importance: Some(values), ..Looks::default() },
        Looks { mode: Mode::Voxels(VoxelColour::Importance), voxels: Some(nodes), ..Looks::default() },
        Looks { mode: Mode::Voxels(VoxelColour::Plain), ..Looks::default() },
        Looks { wipe: Some(Wipe { at: 0.5, keeps_left: true }), ..Looks::default() },
    ];
    for looks in looks {
        set(&mut renderer, body, looks.clone());
        let after = renderer.frame().expect("a frame");
        assert_ne!(after, before, "{:?} is not shown at once", looks.mode);
        assert_eq!(renderer.frame().expect("a frame"), after, "{:?} is not whole at once", looks.mode);
        before = after;
    }
    let leaning = leaning(&shape);
    renderer.pose(body, Pose::still(leaning));
    set(&mut renderer, body, Ghost::default());
    let after = renderer.frame().expect("a frame");
    assert_ne!(after, before);
    assert_eq!(renderer.frame().expect("a frame"), after);
}

#[test]
fn the_same_scene_gives_the_same_pixels() {
    let frame = |amount: f32| {
        let (mut renderer, _turn) = renderer()?;
        let body = tower();
        let pose = Pose { from: rest(&body), to: leaning(&body), blend: amount };
        renderer.show(Shown { pose: Some(pose), ghost: Some(Ghost::default()), ..Shown::new(body) });
        Some(renderer.frame().expect("a frame"))
    };
    let Some(first) = frame(0.5) else { return };
    assert_eq!(frame(0.5), Some(first.clone()));
    // Sabotage: a hair's breadth further is seen.
    assert_ne!(frame(0.52), Some(first));
}

/// Where the tip of the pyramid is on the screen, by the transfer on the CPU; view space, standing on the floor.
fn tip(body: &Body, nodes: &[Vec3A]) -> Vec3 {
    let frame = ViewFrame::of(&body.boundary);
    let positions: Vec<Vec3> = body.binding.apply(nodes).iter().map(|p| frame.world_from_source(*p)).collect();
    let lowest = positions.iter().fold(f32::INFINITY, |low, p| low.min(p.y));
    positions[4] - Vec3::Y * lowest
}

#[test]
fn the_shader_deforms_as_the_transfer_does() {
    let Some((mut renderer, _turn)) = renderer() else { return };
    alone(&mut renderer);
    let body = pyramid();
    let (from, to) = (rest(&body), leaning(&body));
    let entity = renderer.show(Shown::new(body.clone()));
    for amount in [0.0, 0.5, 1.0] {
        let expected = tip(&body, &blend(&from, &to, amount));
        renderer.pose(entity, Pose { from: from.clone(), to: to.clone(), blend: amount });
        // A picture 0.04 high: a pixel is 3.3e-4.
        let distance = 0.02 / (0.5 * homunculus::view::FIELD_OF_VIEW).tan();
        let front = Orbit { target: expected, yaw: 0.0, pitch: 0.0, distance, orthographic: true, turntable: 0.0 };
        look(&mut renderer, front);
        let picture = renderer.frame().expect("a frame");
        let covered = |x: u32, y: u32| picture.get_pixel(x, y).0[3] > 127;
        let top = (0..SIZE[1]).find(|&y| (0..SIZE[0]).any(|x| covered(x, y))).expect("the tip");
        let row: Vec<u32> = (0..SIZE[0]).filter(|&x| covered(x, top + 2)).collect();
        let middle = row.iter().sum::<u32>() as f64 / row.len() as f64;
        assert!((f64::from(top) - 60.0).abs() <= 3.0, "blend {amount}: the tip is in row {top}");
        assert!((middle - 80.0).abs() <= 3.0, "blend {amount}: the tip is in column {middle}");
        // Sabotage: the tip of another blend is not there.
        let other = tip(&body, &blend(&from, &to, if amount < 0.5 { amount + 0.1 } else { amount - 0.1 }));
        assert!(expected.distance(other) > 10.0 * 3.3e-4);
    }
}

#[test]
fn marked_triangles_are_red() {
    let Some((mut renderer, _turn)) = renderer() else { return };
    let body = tower();
    let entity = renderer.show(Shown::new(body.clone()));
    let red =
        |frame: &RgbaImage| frame.pixels().filter(|p| i32::from(p.0[0]) - i32::from(p.0[1].max(p.0[2])) > 60).count();
    assert_eq!(red(&renderer.frame().expect("a frame")), 0);
    let marked = Some(Arc::new((0..12).collect::<Vec<u32>>()));
    set(&mut renderer, entity, Looks { marked, ..Looks::default() });
    let some = red(&renderer.frame().expect("a frame"));
    assert!(some > 200, "{some} red pixels");
    let marked = Some(Arc::new((0..24).collect::<Vec<u32>>()));
    set(&mut renderer, entity, Looks { marked, ..Looks::default() });
    assert!(red(&renderer.frame().expect("a frame")) > some);
}

#[test]
fn colours_in_full_light_are_those_of_the_legend() {
    let Some((mut renderer, _turn)) = renderer() else { return };
    alone(&mut renderer);
    let body = tower();
    let entity = renderer.show(Shown::new(body.clone()));
    // Looked at from where the key light stands.
    look(&mut renderer, Orbit { yaw: 0.3, pitch: 0.7, ..Orbit::default() });
    let distance = |a: [u8; 3], b: [u8; 3]| a.iter().zip(b).map(|(a, b)| a.abs_diff(b)).max().unwrap_or(0);
    for value in [0.25_f32, 0.5, 1.0, 2.0, 4.0] {
        let importance = Some(Arc::new(vec![value; body.boundary.positions.len()]));
        let looks = Looks { mode: Mode::Importance, importance, range: Some([0.25, 4.0]), ..Looks::default() };
        let legend = looks.legend().expect("a legend");
        let said = |v: f32| {
            let nearest = |s: &&(f32, [u8; 3])| (s.0 / v).ln().abs();
            legend.stops.iter().min_by(|a, b| nearest(a).total_cmp(&nearest(b))).expect("stops").1
        };
        set(&mut renderer, entity, looks.clone());
        let frame = renderer.frame().expect("a frame");
        let body = frame.pixels().filter(|p| p.0[3] == 255).map(|p| [p.0[0], p.0[1], p.0[2]]);
        let brightest = body.max_by_key(|c| c.iter().map(|&v| u32::from(v)).sum::<u32>()).expect("the body");
        assert!(distance(brightest, said(value)) <= 6, "×{value}: {brightest:?} drawn, {:?} said", said(value));
        // Sabotage: the colour of another value is told apart.
        assert!(distance(brightest, said(if value < 2.0 { value * 2.0 } else { value / 2.0 })) > 12);
    }
}

#[test]
fn a_wipe_keeps_its_side_and_placements_move() {
    let Some((mut renderer, _turn)) = renderer() else { return };
    alone(&mut renderer);
    let entity = renderer.show(Shown::new(tower()));
    look(&mut renderer, Orbit { yaw: 0.0, ..Orbit::default() });
    let whole = coverage(&renderer.frame().expect("a frame"));
    let mut parts = 0.0;
    for keeps_left in [true, false] {
        set(&mut renderer, entity, Looks { wipe: Some(Wipe { at: 0.5, keeps_left }), ..Looks::default() });
        let frame = renderer.frame().expect("a frame");
        let is_kept = |x: u32| (x < SIZE[0] / 2) == keeps_left;
        assert!(frame.enumerate_pixels().all(|(x, _, p)| is_kept(x) || p.0[3] == 0));
        parts += coverage(&frame);
    }
    assert!(whole > 0.05 && (parts - whole).abs() < 0.005, "{whole} in parts {parts}");
    // Away from the camera's sight nothing is left.
    set(&mut renderer, entity, (Looks::default(), Placement { offset: Vec3::X * 20.0 }));
    assert_eq!(coverage(&renderer.frame().expect("a frame")), 0.0);
}

#[test]
fn a_ray_finds_what_is_drawn() {
    let body = pyramid();
    let (from, to) = (rest(&body), leaning(&body));
    let pose = Pose { from: from.clone(), to: to.clone(), blend: 0.5 };
    let nodes = blend(&from, &to, 0.5);
    let expected = tip(&body, &nodes);
    let placement = Placement { offset: Vec3::new(0.3, 0.1, -0.2) };
    let mut picker = Picker::default();
    let aim =
        |y: f32| Orbit { target: expected + placement.offset + Vec3::Y * y, yaw: 0.2, pitch: 0.1, ..Orbit::default() };
    let below_rest = Orbit { target: tip(&body, &from) + placement.offset - Vec3::Y * 0.3, ..aim(0.0) };
    let found_at_rest =
        Picker::default().pick(&body, Some(&pose), &placement, below_rest.ray(Vec2::ZERO), Target::Rest);
    let mut pick = |y: f32, pose, target| picker.pick(&body, pose, &placement, aim(y).ray(Vec2::ZERO), target);
    assert_eq!(pick(0.01, Some(&pose), Target::Surface), None, "above the tip there is nothing");
    let hit = pick(-0.05, Some(&pose), Target::Surface).expect("the pyramid below its tip");
    assert!(hit.position.distance(expected + placement.offset) < 0.2 && hit.normal.is_normalized());
    // The place found lies on the deformed surface: the same weights at rest give the place in rest space.
    let frame = ViewFrame::of(&body.boundary);
    let corners = body.boundary.triangles[hit.triangle as usize];
    let at = |positions: &[DVec3]| -> DVec3 {
        hit.barycentric.iter().zip(corners).map(|(&w, v)| f64::from(w) * positions[v as usize]).sum()
    };
    let at_rest = frame.world_from_source(at(&body.boundary.positions));
    assert!(hit.rest_position.distance(at_rest) < 1e-4);
    let lifted = tip(&body, &nodes).y - frame.world_from_source(body.binding.apply(&nodes)[4]).y;
    let deformed = frame.world_from_source(at(&body.binding.apply(&nodes))) + Vec3::Y * lifted + placement.offset;
    assert!(hit.position.distance(deformed) < 1e-3, "{} {deformed}", hit.position);
    // The rest shape is lower: the same ray passes above it.
    assert_eq!(pick(-0.05, Some(&pose), Target::Rest), None);
    assert!(found_at_rest.is_some_and(|hit| hit.rest_position.distance(hit.position - placement.offset) < 1e-4));
    // Sabotage: at another blend the ray meets another place.
    let other = Pose { blend: 0.6, ..pose.clone() };
    let moved = pick(-0.05, Some(&other), Target::Surface).expect("a hit");
    assert!(moved.rest_position.distance(hit.rest_position) > 1e-3);
}

#[test]
fn a_body_that_comes_grown_is_never_seen_at_rest() {
    let Some((mut renderer, _turn)) = renderer() else { return };
    let body = tower();
    let grown = |renderer: &mut Renderer| {
        let shown = Shown { pose: Some(Pose::still(leaning(&body))), ..Shown::new(body.clone()) };
        let entity = renderer.show(shown);
        (entity, renderer.frame().expect("a frame"))
    };
    // Shaders and all are there when it counts.
    let at_rest = renderer.show(Shown::new(body.clone()));
    let resting = renderer.frame().expect("a frame");
    renderer.world_mut().despawn(at_rest);
    let (entity, expected) = grown(&mut renderer);
    renderer.world_mut().despawn(entity);
    renderer.frame().expect("a frame");
    renderer.world_mut().init_resource::<Unhurried>();
    let (entity, first) = grown(&mut renderer);
    assert!(first == expected, "another state was shown first");
    assert!(first != resting);
    // Sabotage: what it is told later comes when it is computed, and is not waited for.
    set(&mut renderer, entity, Pose::still(rest(&body)));
    assert!(renderer.world_mut().get::<Pose>(entity).is_some());
    let frames: Vec<RgbaImage> = (0..50).map(|_| renderer.frame().expect("a frame")).collect();
    assert!(frames.last() == Some(&resting), "it comes at last");
}
