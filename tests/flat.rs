//! Contract of pictures: the same stages in the plane. Every frame of the growth is free of fold-overs and crossings, judged
//! by the engine's certificate and, independently of it, by comparing everything with everything from the written places
//! alone; regions reach the areas asked for.

mod common;

use std::{path::Path, sync::Arc};

use common::{flat, shared, states};
use glam::{DVec2, DVec3, UVec2};
use homunculus::boundary::Boundary;
use homunculus::importance::{self, field::Field};
use homunculus::picture::{self, Cut, FlatMesh};
use homunculus::voxel::Flat;
use homunculus::{
    run::{Domain, Observer, Progress, Solved, solve as solve_domain},
    settings::Settings,
};

struct Patient;

impl Observer for Patient {
    fn progress(&self, _: &Progress) {}

    fn cancelled(&self) -> bool {
        false
    }
}

fn settings(resolution: u32, fidelity: f32) -> Settings {
    Settings { resolution, fidelity, keys: 4, reference: None }
}

fn solve(flat: Flat, settings: Settings) -> Solved {
    solve_domain(Domain::picture(Arc::new(flat), settings), &Patient).expect("a solved picture")
}

/// A smooth field between a quarter and four from a few bumps; the same for the same seed.
fn random_field(size: UVec2, seed: u64) -> Vec<f32> {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    let mut random = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 40) as f64 / f64::from(1 << 24)
    };
    let bumps: Vec<(DVec2, f64, f64)> = (0..8)
        .map(|_| {
            let at = DVec2::new(random(), random()) * size.as_dvec2();
            (at, (0.08 + 0.15 * random()) * f64::from(size.max_element()), 2.0 * random() - 1.0)
        })
        .collect();
    (0..size.x * size.y)
        .map(|k| {
            let p = DVec2::new(f64::from(k % size.x), f64::from(k / size.x));
            let sum: f64 = bumps.iter().map(|(c, r, w)| 2.0 * w * (-(p - *c).length_squared() / (r * r)).exp()).sum();
            4.0_f64.powf(sum.clamp(-1.0, 1.0)) as f32
        })
        .collect()
}

/// Triangles of the mesh that are not positive, and pairs of outline edges that meet beyond a common end: by comparing all
/// pairs in plain double precision, which is exact in the products of the single precision places that are written.
fn faults(mesh: &Boundary, places: &[DVec3]) -> (usize, usize) {
    let turn = |a: DVec3, b: DVec3, c: DVec3| (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    let at = |v: u32| places[v as usize];
    let inverted = mesh.triangles.iter().filter(|&&[a, b, c]| turn(at(a), at(b), at(c)) <= 0.0).count();
    let mut directed: Vec<[u32; 2]> = mesh.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
    directed.sort_unstable();
    let outline: Vec<[u32; 2]> =
        directed.iter().copied().filter(|&[a, b]| directed.binary_search(&[b, a]).is_err()).collect();
    let mut crossings = 0;
    for (k, &[a, b]) in outline.iter().enumerate() {
        for &[c, d] in &outline[k + 1..] {
            if a == c || a == d || b == c || b == d {
                continue;
            }
            let (p, q, r, s) = (at(a), at(b), at(c), at(d));
            let apart = p.max(q).cmplt(r.min(s)).any() || r.max(s).cmplt(p.min(q)).any();
            if apart {
                continue;
            }
            let (abc, abd, cda, cdb) = (turn(p, q, r), turn(p, q, s), turn(r, s, p), turn(r, s, q));
            crossings += usize::from(abc * abd <= 0.0 && cda * cdb <= 0.0);
        }
    }
    (inverted, crossings)
}

fn expect_sound(name: &str, solved: &Solved) {
    assert!(solved.outcome.frames.len() >= 2, "{name}");
    for frame in &solved.outcome.frames {
        assert!(frame.certificate.certified(), "{name} at λ {}: {:?}", frame.lambda, frame.certificate);
        let found = faults(&solved.boundary, &frame.positions);
        assert_eq!(found, (0, 0), "{name} at λ {}", frame.lambda);
    }
    // Half-way between frames too.
    for pair in solved.outcome.frames.windows(2) {
        let half: Vec<DVec3> = pair[0].positions.iter().zip(&pair[1].positions).map(|(a, b)| (*a + *b) / 2.0).collect();
        assert_eq!(faults(&solved.boundary, &half), (0, 0), "{name} after λ {}", pair[0].lambda);
    }
}

#[test]
fn random_fields_on_real_pictures_stay_sound() {
    for file in ["crocodile_512.png", "magnet_512.png", "twemoji_snake_512.png", "us_states.png"] {
        let Some(path) = shared("images").map(|images| images.join(file)) else { continue };
        let picture = picture::read(&path, &Cut::default()).expect("a picture");
        for seed in 1..=2 {
            let mut flat = flat(&picture, &Field::load(&[], 1.0, false, &picture, Path::new("")).expect("a field"));
            flat.importance = random_field(picture.size, seed);
            let solved = solve(flat, settings(64, 1.0));
            expect_sound(&format!("{file}, seed {seed}"), &solved);
        }
    }
}

#[test]
fn what_would_overlap_does_not() {
    // Two bars a few pixels apart that ask for three times their size: scaled they would lie in each other.
    let size = UVec2::new(64, 48);
    let inside: Vec<bool> = (0..size.x * size.y)
        .map(|k| (8..56).contains(&(k % size.x)) && matches!(k / size.x, 10..=18 | 22..=30))
        .collect();
    let bars = Flat { name: "bars".into(), size, importance: vec![3.0; inside.len()], inside, regions: None };
    let solved = solve(bars.clone(), settings(48, 1.0));
    assert_eq!(solved.complex.bodies, 2);
    expect_sound("bars", &solved);
    assert!(solved.outcome.classic.expect("looked at").crossings > 0, "the linear solution has to cross");

    // Sabotage: the judge has to see it when one bar is laid over the other, and when a triangle turns over.
    let mut places = solved.outcome.frames[0].positions.clone();
    let low = places.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
    places.iter_mut().filter(|p| p.y < low + 10.0).for_each(|p| p.y += 6.5);
    assert!(faults(&solved.boundary, &places).1 > 0);
    let mut places = solved.outcome.frames[0].positions.clone();
    let [a, b, _] = solved.boundary.triangles[0];
    places.swap(a as usize, b as usize);
    assert!(faults(&solved.boundary, &places).0 > 0);
}

#[test]
fn a_hole_is_not_closed_and_an_island_stays_in_it() {
    // A ring around an island, which asks for more room than the ring leaves.
    let size = UVec2::splat(48);
    let radius = |k: u32| (DVec2::new(f64::from(k % size.x), f64::from(k / size.x)) - 23.5).length();
    let inside: Vec<bool> =
        (0..size.x * size.y).map(|k| radius(k) < 6.0 || (10.0..20.0).contains(&radius(k))).collect();
    let importance = (0..size.x * size.y).map(|k| if radius(k) < 8.0 { 2.5 } else { 0.8 }).collect();
    let ring = Flat { name: "ring".into(), size, inside, importance, regions: None };
    let solved = solve(ring, settings(40, 1.0));
    assert_eq!(solved.complex.bodies, 2);
    expect_sound("ring", &solved);
}

#[test]
fn states_become_as_large_as_their_population() {
    let Some((picture, field)) = states() else { return };
    let solved = solve(flat(&picture, &field), settings(256, 1.0));
    for frame in &solved.outcome.frames {
        assert!(frame.certificate.certified(), "λ {}: {:?}", frame.lambda, frame.certificate);
    }
    assert!(solved.complex.bodies > 3, "Alaska and islands are bodies of their own");

    let height = f64::from(picture.size.y);
    let places = |p: &[DVec3]| p.iter().map(|p| DVec2::new(p.x, height - p.y)).collect::<Vec<_>>();
    let mesh = FlatMesh { rest: places(&solved.boundary.positions), triangles: solved.boundary.triangles.clone() };
    let last = places(&solved.outcome.frames.last().expect("frames").positions);
    let mut areas = importance::areas(&field, &picture, &mesh, &last);
    // The District of Columbia has four pixels: less than a cell.
    areas.retain(|a| a.name != "District of Columbia");
    assert_eq!(areas.len(), 50);
    let worst = importance::worst(&areas).expect("states");
    eprintln!("worst {} {:.4}, median {:.4}", worst.name, worst.error(), importance::median_error(&areas));
    assert!(worst.error() <= 0.03, "{} is {:.1} % off", worst.name, 100.0 * worst.error());
    assert!(importance::median_error(&areas) <= 0.005);
    let asked: f64 = areas.iter().map(|a| a.asked).sum();
    assert!((asked / picture.domain_area() as f64 - 1.0).abs() < 0.1, "the total area is kept");

    // Sabotage: the map as it was is far off.
    let mut unchanged = importance::areas(&field, &picture, &mesh, &mesh.rest);
    unchanged.retain(|a| a.name != "District of Columbia");
    assert!(importance::worst(&unchanged).expect("states").error() > 1.0);
}

#[test]
fn the_same_bits_with_any_number_of_threads() {
    let size = UVec2::new(60, 40);
    let inside = (0..size.x * size.y).map(|k| k % 7 != 3 || k / size.x > 10).collect();
    let flat = Flat { name: "threads".into(), size, inside, importance: random_field(size, 7), regions: None };
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        let solved = pool.install(|| solve(flat.clone(), settings(48, 0.8)));
        solved
            .film
            .keyframes()
            .last()
            .expect("a film")
            .positions
            .iter()
            .flat_map(|p| p.to_array())
            .map(f32::to_bits)
            .collect()
    };
    let one: Vec<u32> = with(1);
    for threads in [2, 3, 7] {
        assert_eq!(with(threads), one, "{threads} threads");
    }
}
