//! Contract of `boundary::split`: the pieces are the same surface, without cracks, with all data, and every format holds them: what
//! is read back has as many vertices and triangles, those of the input first.
#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

#[path = "../common/mod.rs"]
mod common;
mod formats;
mod precision;

use std::collections::HashMap;
use std::path::Path;

use glam::DVec3;
use homunculus::boundary::{self, Attribute, Boundary, Regions, Split, split_edges, split_long};

/// A box of 12 triangles whose eight corners are three vertices each, in single precision.
fn seams() -> Boundary {
    let (positions, triangles) = common::cuboid([0.0; 3], [2.1f32, 2.0, 1.7].map(f64::from));
    let mut mine = (Vec::new(), Vec::new());
    for (face, pair) in triangles.chunks(2).enumerate() {
        // The two triangles of a face share its vertices; faces share none.
        let first = mine.0.len() as u32;
        let [[a, b, c], [_, _, d]] = [pair[0], pair[1]];
        mine.0.extend([a, b, c, d].map(|v| positions[v as usize]));
        mine.1.extend([[0, 1, 2], [0, 2, 3]].map(|t| t.map(|v: u32| v + first)));
        assert_eq!(mine.0.len(), 4 * (face + 1));
    }
    Boundary::from_triangles("seams", mine.0, mine.1)
}

fn plain() -> Boundary {
    common::cuboids("box", &[([-1.0, 0.0, 0.0], [0.3, 2.0, 1.0])])
}

/// Two boxes that share a face by place.
fn touching() -> Boundary {
    common::cuboids("two", &[([0.0; 3], [1.0; 3]), ([1.0, 0.0, 0.0], [2.0, 1.0, 1.0])])
}

/// Twice the area vector.
fn normal(t: &[u32; 3], p: &[DVec3]) -> DVec3 {
    let [a, b, c] = t.map(|v| p[v as usize]);
    (b - a).cross(c - a)
}

fn area(b: &Boundary) -> f64 {
    b.triangles.iter().map(|t| normal(t, &b.positions).length() / 2.0).sum()
}

fn volume(b: &Boundary) -> f64 {
    b.triangles.iter().map(|t| normal(t, &b.positions).dot(b.positions[t[0] as usize]) / 6.0).sum()
}

/// How many directed edges have no partner in the other direction at the same place: none on a closed surface without cracks.
fn cracks(b: &Boundary) -> usize {
    let welded = b.welded();
    let mut balance: HashMap<[u32; 2], i64> = HashMap::new();
    for t in &b.triangles {
        let [a, b, c] = t.map(|v| welded[v as usize]);
        for [from, to] in [[a, b], [b, c], [c, a]].into_iter().filter(|[from, to]| from != to) {
            *balance.entry([from.min(to), from.max(to)]).or_default() += if from < to { 1 } else { -1 };
        }
    }
    balance.values().filter(|&&count| count != 0).count()
}

fn longest(b: &Boundary) -> f64 {
    let side = |t: &[u32; 3], i: usize| b.positions[t[i] as usize].distance(b.positions[t[(i + 1) % 3] as usize]);
    b.triangles.iter().flat_map(|t| [side(t, 0), side(t, 1), side(t, 2)]).fold(0.0, f64::max)
}

/// Whether pieces are the same surface, by all that can be counted and measured.
fn is_same_surface(before: &Boundary, split: &Split) -> Result<(), String> {
    let after = &split.boundary;
    let own = before.positions.len();
    let bits = |p: &DVec3| p.to_array().map(f64::to_bits);
    if !after.is_sound() {
        return Err("it is not sound".into());
    }
    if !before.positions.iter().map(bits).eq(after.positions[..own].iter().map(bits)) {
        return Err("vertices of the input moved".into());
    }
    if (after.positions.len() - own, after.triangles.len() - before.triangles.len())
        != (split.added_vertices(), split.added_triangles())
    {
        return Err("it miscounts".into());
    }
    if cracks(before) != cracks(after) && cracks(before) == 0 {
        return Err(format!("{} cracks", cracks(after)));
    }
    let (was, is) = (before.welded(), after.welded());
    if before.boundary_loops(&was) != after.boundary_loops(&is) || before.components(&was) != after.components(&is) {
        return Err("other holes or pieces".into());
    }
    let size = before.bounds().map_or(1.0, |(low, high)| (high - low).max_element());
    let (areas, volumes) = (area(before) - area(after), volume(before) - volume(after));
    if areas.abs() > 1e-6 * size * size || volumes.abs() > 1e-6 * size.powi(3) {
        return Err(format!("area differs by {areas}, volume by {volumes}"));
    }
    if !split.parents.is_sorted() {
        return Err("triangles are not in the order of the input".into());
    }
    // Each lies in its parent, turned as it is; together they cover it.
    let mut covered = vec![DVec3::ZERO; before.triangles.len()];
    for ((t, &parent), corners) in after.triangles.iter().zip(&split.parents).zip(&split.corners) {
        let of = before.triangles[parent as usize];
        for (&vertex, weights) in t.iter().zip(corners) {
            let place: DVec3 = of.iter().zip(weights).map(|(&v, &w)| before.positions[v as usize] * f64::from(w)).sum();
            if weights.iter().sum::<f32>() != 1.0 || place.distance(after.positions[vertex as usize]) > 1e-6 * size {
                return Err(format!("vertex {vertex} is not where its weights say"));
            }
        }
        covered[parent as usize] += normal(t, &after.positions);
    }
    let missing = before
        .triangles
        .iter()
        .zip(&covered)
        .any(|(t, sum)| (normal(t, &before.positions) - *sum).length() > 1e-6 * size * size);
    if missing { Err("a triangle is not covered".into()) } else { Ok(()) }
}

#[test]
fn pieces_are_the_same_surface_without_cracks() {
    for body in [plain(), seams(), touching()] {
        assert_eq!(cracks(&body), 0);
        for part in [3.0, 1.0, 0.7, 0.31, 0.1] {
            let split = split_long(&body, part, usize::MAX);
            is_same_surface(&body, &split).unwrap_or_else(|what| panic!("{} at {part}: {what}", body.name));
            assert!(
                split.longest <= part && (split.longest - longest(&split.boundary)).abs() < 1e-12,
                "{}",
                split.longest
            );
            assert_eq!(split.added_vertices() > 0, longest(&body) > part);
        }
    }
}

#[test]
fn real_meshes_are_the_same_surface_in_pieces() {
    let Some(folder) = common::shared("meshes") else { return };
    for path in common::files(&folder) {
        let body = boundary::read(&path).unwrap();
        let split = split_long(&body, 0.3 * longest(&body), usize::MAX);
        is_same_surface(&body, &split).unwrap_or_else(|what| panic!("{}: {what}", path.display()));
        assert!(split.added_vertices() > 0);
    }
}

#[test]
fn sabotage_splitting_by_index_leaves_a_crack() {
    let body = seams();
    let edge = [[0, 1]];
    assert_eq!(cracks(&split_edges(&body, &edge).boundary), 0);
    // The vertices of the first face somewhere else while it is split, so that its edge is nobody else's; then back.
    let mut apart = body.clone();
    apart.positions[..4].iter_mut().for_each(|p| *p += DVec3::X);
    let mut split = split_edges(&apart, &edge);
    let own = body.positions.len();
    split.boundary.positions[..4].iter_mut().for_each(|p| *p -= DVec3::X);
    for (added, ends) in split.ends.iter().enumerate() {
        let [a, b] = ends.map(|end| split.boundary.positions[end as usize]);
        split.boundary.positions[own + added] = (a + b) / 2.0;
    }
    assert!(cracks(&split.boundary) > 0);
    assert!(is_same_surface(&body, &split).unwrap_err().contains("cracks"));
}

#[test]
fn sabotage_other_faults_are_seen() {
    let body = seams();
    let good = split_long(&body, 0.8, usize::MAX);
    assert_eq!(is_same_surface(&body, &good), Ok(()));
    let broken = |break_it: fn(&mut Split)| {
        let mut split = good.clone();
        break_it(&mut split);
        is_same_surface(&body, &split)
    };
    assert!(broken(|s| s.boundary.positions[2].x += 1e-15).is_err());
    assert!(broken(|s| s.boundary.positions[30] += DVec3::splat(1e-3)).is_err());
    assert!(broken(|s| s.boundary.triangles[5].swap(0, 1)).is_err());
    assert!(broken(|s| s.boundary.triangles[5] = s.boundary.triangles[6]).is_err());
    assert!(broken(|s| s.parents[3] += 1).is_err());
    assert!(broken(|s| s.corners[3].swap(0, 1)).is_err());
}

#[test]
fn the_same_bits_each_time() {
    // Each run hashes otherwise, as other threads would.
    let all = |split: &Split| {
        let places: Vec<_> = split.boundary.positions.iter().map(|p| p.to_array().map(f64::to_bits)).collect();
        (places, split.boundary.triangles.clone(), split.ends.clone(), split.parents.clone())
    };
    let body = touching();
    let first = split_long(&body, 0.13, 900);
    for _ in 0..5 {
        assert_eq!(all(&first), all(&split_long(&body, 0.13, 900)));
    }
}

#[test]
fn edges_at_one_place_are_halved_at_one_place() {
    let split = split_edges(&seams(), &[[1, 0], [1, 0], [0, 0], [0, 9999]]);
    let places: Vec<_> = split.boundary.positions[24..].to_vec();
    assert_eq!(places.len(), 2, "one for each side of the seam");
    assert_eq!(places[0], places[1]);
    assert_eq!(split.added_triangles(), 2);
    // Not an edge of any triangle.
    assert_eq!(split_edges(&seams(), &[[0, 6]]).added_vertices(), 0);
    // The face that two boxes share is cut alike by both: as many places as vertices of one of them.
    let body = touching();
    let split = split_long(&body, 0.4, usize::MAX).boundary;
    let on_face = |first: bool| {
        let of = |t: &&[u32; 3]| {
            t.iter().all(|&v| split.positions[v as usize].x == 1.0) && (normal(t, &split.positions).x > 0.0) == first
        };
        let mut triangles: Vec<_> = split
            .triangles
            .iter()
            .filter(of)
            .map(|t| {
                let mut places = t.map(|v| split.positions[v as usize].to_array().map(f64::to_bits));
                places.sort_unstable();
                places
            })
            .collect();
        triangles.sort_unstable();
        triangles
    };
    // Their own diagonals differ, so only the rim can be compared.
    let rim = |triangles: &[[[u64; 3]; 3]]| {
        let mut places: Vec<_> = triangles.iter().flatten().copied().filter(|p| p[1] == 0).collect();
        places.sort_unstable();
        places.dedup();
        places
    };
    assert!(on_face(true).len() >= 8);
    assert_eq!(rim(&on_face(true)), rim(&on_face(false)));
}

#[test]
fn middles_of_single_precision_are_single() {
    let is_single = |p: &DVec3| p.as_vec3().as_dvec3() == *p;
    let split = split_long(&seams(), 0.05, usize::MAX).boundary;
    assert!(split.positions.iter().all(is_single));
    let mut double = seams();
    double.positions.iter_mut().for_each(|p| *p *= 1.000_000_1);
    assert!(!split_long(&double, 0.5, usize::MAX).boundary.positions.iter().all(is_single));
}

#[test]
fn numbers_without_a_middle_end_it() {
    let step = f32::EPSILON;
    let places = [[1.0, 0.0, 0.0], [1.0 + 4.0 * step, 0.0, 0.0], [1.0, 4.0 * step, 0.0]];
    let positions = places.map(|p: [f32; 3]| DVec3::from_array(p.map(f64::from))).to_vec();
    let tiny = Boundary::from_triangles("tiny", positions, vec![[0, 1, 2]]);
    let split = split_long(&tiny, 1e-30, 10_000);
    assert!(split.longest > 1e-30 && split.boundary.is_sound());
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(split_long(&tiny, bad, 100).added_vertices(), 0);
    }
    let huge = Boundary::from_triangles("huge", vec![DVec3::ZERO, DVec3::X * 1e300, DVec3::Y * 1e300], vec![[0, 1, 2]]);
    let split = split_long(&huge, 3e299, 1000);
    assert!(split.longest <= 3e299 && split.boundary.is_sound(), "{}", split.longest);
}

#[test]
fn most_triangles_are_kept_to_and_the_longest_go_first() {
    let body = plain();
    for most in [0, 12, 13, 30, 50, 100, 1000] {
        let split = split_long(&body, 0.05, most);
        assert!(split.boundary.triangles.len() <= most.max(12), "{most}: {}", split.boundary.triangles.len());
        assert!(split.longest > 0.05);
        assert_eq!(is_same_surface(&body, &split), Ok(()));
        if most > 12 {
            assert!(split.longest <= longest(&body));
        }
    }
    assert!(split_long(&body, 0.05, 100).longest < longest(&body));
    let room = split_long(&body, 0.5, usize::MAX).boundary.triangles.len();
    assert!(split_long(&body, 0.5, room).longest <= 0.5, "exactly enough is enough");
}

#[test]
fn values_follow() {
    let mut body = plain();
    let height: Vec<f32> = body.positions.iter().map(|p| (p.x + 2.0 * p.y - p.z) as f32).collect();
    body.attributes.push(Attribute { name: "height".into(), values: height.clone() });
    let mut not = height.clone();
    not[0] = f32::NAN;
    body.attributes.push(Attribute { name: "not".into(), values: not });
    let of_vertex: Vec<u32> = body.positions.iter().map(|p| if p.y > 1.0 { 1 } else { 0 }).collect();
    body.regions = Some(Regions { names: vec!["low".into(), "high".into()], of_vertex: of_vertex.clone() });
    let split = split_long(&body, 0.3, usize::MAX);
    let after = &split.boundary;
    assert!(after.is_sound());
    for (p, value) in after.positions.iter().zip(&after.attributes[0].values) {
        assert!(((p.x + 2.0 * p.y - p.z) as f32 - value).abs() < 1e-5);
    }
    assert_eq!(split.carry(&height, |a, b| 0.5 * a + 0.5 * b), after.attributes[0].values);
    assert!(after.attributes[1].values[8..].iter().any(|v| v.is_nan()));
    let regions = after.regions.as_ref().unwrap();
    assert_eq!(regions.of_vertex[..8], of_vertex);
    for (added, &[a, b]) in split.ends.iter().enumerate() {
        let [a, b] = [a, b].map(|end| regions.of_vertex[end as usize]);
        assert_eq!(regions.of_vertex[8 + added], a);
        assert!(a == b || split.ends[added][0] != split.ends[added][1]);
    }
    // What is said of triangles of the input can be told at each added vertex.
    for ((triangle, weights), p) in split.places().iter().zip(&after.positions[8..]) {
        let corners = body.triangles[*triangle as usize];
        let place: DVec3 = corners.iter().zip(weights).map(|(&v, &w)| body.positions[v as usize] * f64::from(w)).sum();
        assert!(place.distance(*p) < 1e-6);
    }
}

#[test]
fn splits_follow_each_other() {
    let body = seams();
    let first = split_long(&body, 1.2, usize::MAX);
    let t = first.boundary.triangles[7];
    let more = split_edges(&first.boundary, &[[t[0], t[1]], [t[1], t[2]]]);
    let third = split_long(&more.boundary, 0.9, usize::MAX);
    assert!(more.added_vertices() >= 2 && third.added_vertices() > 0);
    let whole = first.then(more).then(third);
    assert_eq!(is_same_surface(&body, &whole), Ok(()));
    let height: Vec<f32> = body.positions.iter().map(|p| p.y as f32).collect();
    let carried = whole.carry(&height, |a, b| 0.5 * a + 0.5 * b);
    assert!(carried.iter().zip(&whole.boundary.positions).all(|(h, p)| (f64::from(*h) - p.y).abs() < 1e-6));
    // Nothing to do is nothing done.
    let none = split_long(&whole.boundary, 0.9, usize::MAX);
    assert_eq!((none.added_vertices(), none.added_triangles()), (0, 0));
    assert_eq!(none.boundary.triangles, whole.boundary.triangles);
}

/// Reads a file with some content.
fn read(folder: &Path, name: &str, bytes: &[u8]) -> Boundary {
    let path = folder.join(name);
    std::fs::write(&path, bytes).unwrap();
    boundary::read(&path).unwrap()
}
