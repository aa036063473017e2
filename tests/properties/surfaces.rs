//! Surfaces: crossings found through the tree are those of all pairs, and each pair is judged as exact integers judge it;
//! contacts found through the hash are those of all pairs.

use std::collections::BTreeMap;

use glam::{DVec3, I64Vec3, Vec3A};
use homunculus::{
    certificate::{Surface, Triangle, triangles_cross},
    collision::contact,
    voxel::Complex,
};
use proptest::prelude::*;

use super::{boxes_with_gaps, cases, common::Random, rough};

// ── triangles, against integers ──

/// Whether the hulls of two point sets are apart along one of `axes`. Exact.
fn apart(a: &[I64Vec3], b: &[I64Vec3], axes: &[I64Vec3]) -> bool {
    let range = |set: &[I64Vec3], axis: I64Vec3| {
        set.iter().map(|p| p.dot(axis)).fold((i64::MAX, i64::MIN), |(l, h), d| (l.min(d), h.max(d)))
    };
    axes.iter().any(|&axis| {
        let ((a_low, a_high), (b_low, b_high)) = (range(a, axis), range(b, axis));
        a_high < b_low || b_high < a_low
    })
}

fn edges(p: &[I64Vec3]) -> Vec<I64Vec3> {
    (0..p.len()).map(|k| p[(k + 1) % p.len()] - p[k]).collect()
}

/// All normals that the difference of two triangles, or of a segment and a triangle, can have.
fn axes(a: &[I64Vec3], b: &[I64Vec3]) -> Vec<I64Vec3> {
    let (of_a, of_b) = (edges(a), edges(b));
    let mut normals: Vec<I64Vec3> = vec![of_b[0].cross(of_b[1])];
    if a.len() == 3 {
        normals.push(of_a[0].cross(of_a[1]));
    }
    let flat = normals.iter().flat_map(|n| of_a.iter().chain(&of_b).map(|e| n.cross(*e)));
    let mut axes: Vec<I64Vec3> = flat.collect();
    axes.extend(of_a.iter().flat_map(|e| of_b.iter().map(|f| e.cross(*f))));
    axes.extend(normals);
    axes
}

/// Whether two triangles with area have a point in common beyond what they share, by separating axes.
fn cross_by_integers(points: &[I64Vec3], s: [u32; 3], t: [u32; 3]) -> bool {
    let at = |id: u32| points[id as usize];
    let shared: Vec<u32> = s.into_iter().filter(|i| t.contains(i)).collect();
    let others = |of: [u32; 3]| of.into_iter().filter(|i| !shared.contains(i)).map(at).collect::<Vec<_>>();
    match shared[..] {
        [] => {
            let (s, t) = (s.map(at), t.map(at));
            !apart(&s, &t, &axes(&s, &t))
        }
        // Cones at the common corner: a section of one against the other, long enough for any of these coordinates (a
        // point 11 away is at most 150 of the cone's edges away), short enough for i64.
        [v] => {
            const LONG: i64 = 1000;
            let (v, far_s, far_t) = (at(v), others(s), others(t));
            let cone = [v, v + LONG * (far_t[0] - v), v + LONG * (far_t[1] - v)];
            !apart(&far_s, &cone, &axes(&far_s, &cone))
        }
        // Half-planes at the common edge.
        [v, w] => {
            let e = at(w) - at(v);
            let (n, m) = (e.cross(others(s)[0] - at(v)), e.cross(others(t)[0] - at(v)));
            n.cross(m) == I64Vec3::ZERO && n.dot(m) > 0
        }
        _ => true,
    }
}

fn triangle(points: &[I64Vec3], id: [u32; 3]) -> Triangle {
    Triangle { at: id.map(|i| points[i as usize].as_dvec3()), id }
}

/// Points on a coarse lattice and three of them for each triangle, which all have area.
fn coarse(random: &mut Random, side: f64, count: usize) -> (Vec<I64Vec3>, Vec<[u32; 3]>) {
    let mut number = |below: f64| (random.unit() * below) as i64;
    let points: Vec<I64Vec3> = (0..count).map(|_| I64Vec3::new(number(side), number(side), number(side))).collect();
    let mut triangles = Vec::new();
    for _ in 0..2 * count {
        let id = [0; 3].map(|_: i32| number(count as f64) as u32);
        let [a, b, c] = id.map(|i| points[i as usize]);
        if (b - a).cross(c - a) != I64Vec3::ZERO {
            triangles.push(id);
        }
    }
    (points, triangles)
}

proptest! {
    #![proptest_config(cases(40))]

    #[test]
    fn pairs_of_triangles_are_judged_as_by_integers(seed in any::<u64>(), side in 2.0..6.0_f64) {
        // Few enough points that most pairs touch, share, or are flat.
        let (points, triangles) = coarse(&mut Random(seed), side, 9);
        let mut told = [0_usize; 2];
        for (k, &s) in triangles.iter().enumerate() {
            for &t in &triangles[..k] {
                let expected = cross_by_integers(&points, s, t);
                told[usize::from(expected)] += 1;
                let (s, t) = (triangle(&points, s), triangle(&points, t));
                prop_assert_eq!(triangles_cross(&s, &t), expected, "{:?} and {:?}", s, t);
                prop_assert_eq!(triangles_cross(&t, &s), expected, "{:?} and {:?}", t, s);
            }
        }
        prop_assert!(triangles.len() < 6 || told[1] > 0, "nothing crosses: {told:?}");
    }

    #[test]
    fn crossings_are_those_of_all_pairs(seed in any::<u64>(), count in 3..60_usize, fine in prop::bool::ANY) {
        let mut random = Random(seed);
        let (points, triangles) = coarse(&mut random, if fine { 4000.0 } else { 8.0 }, count);
        let rest: Vec<Vec3A> = points.iter().map(|p| p.as_vec3a()).collect();
        let surface = Surface::new(triangles, &rest);
        // At rest, and in a state that has little to do with it.
        let moved: Vec<Vec3A> = rest.iter().map(|p| *p * random.unit() as f32).collect();
        for state in [&rest, &moved] {
            let exact: Vec<DVec3> = state.iter().map(|p| p.as_dvec3()).collect();
            prop_assert_eq!(surface.crossings(state), surface.crossings_by_brute_force(&exact));
        }
    }

    #[test]
    fn contacts_are_those_of_all_pairs(complex in boxes_with_gaps(7), seed in any::<u64>(), scale in 0.3_f32..1.5, spread in 0.1_f64..4.0) {
        let mut random = Random(seed);
        let radius = rough(&mut random, complex.nodes(), 0.4, 0.4 + spread);
        let noise = |random: &mut Random| Vec3A::from_array([0; 3].map(|_: i32| random.unit() as f32));
        let positions: Vec<Vec3A> = complex.rest.iter().map(|p| *p * scale + noise(&mut random)).collect();
        let boundary: Vec<u32> = (0..complex.nodes() as u32).filter(|&i| complex.on_boundary[i as usize]).collect();
        let found = found(&complex, &boundary, &radius, &positions);
        let expected = all_pairs(&complex, &boundary, &radius, &positions);
        prop_assert_eq!(&found, &expected);

        // Sabotage: radii a little larger are other contacts, where there are any.
        let larger: Vec<f32> = radius.iter().map(|r| 1.01 * r).collect();
        prop_assert!(expected.is_empty() || all_pairs(&complex, &boundary, &larger, &positions) != found);
    }
}

#[test]
fn sabotage_a_tree_of_other_boxes_misses_crossings() {
    let at = |p: [f32; 3]| Vec3A::from_array(p);
    let rest = [[0., 0., 0.], [2., 0., 0.], [0., 2., 0.], [0.5, 0.5, -1.], [0.5, 0.5, 1.], [3., 3., 1.]].map(at);
    let surface = Surface::new(vec![[0, 1, 2], [3, 4, 5]], &rest);
    assert_eq!(surface.crossings(&rest), [(0, 1)]);
    let apart: Vec<Vec3A> =
        rest.iter().enumerate().map(|(k, p)| *p + if k > 2 { Vec3A::X * 9.0 } else { Vec3A::ZERO }).collect();
    let stale = surface.near_pairs(&apart, &apart, 0.0);
    assert!(surface.crossing_pairs(&stale, &rest).is_empty());
}

#[test]
fn a_triangle_without_area_crosses_nothing_from_either_side() {
    let floor = [[0., 0., 0.], [4., 0., 0.], [0., 4., 0.]].map(DVec3::from);
    let good = Triangle { at: floor, id: [0, 1, 2] };
    for (at, id) in [
        // A corner twice, as welding leaves it; three corners on a line through the floor.
        ([floor[0], floor[0], floor[1]], [0, 0, 1]),
        ([floor[0], floor[1], floor[1]], [0, 1, 1]),
        ([floor[0], floor[0], floor[0]], [0, 0, 0]),
        ([DVec3::new(1., 1., -1.), DVec3::new(1., 1., 0.), DVec3::new(1., 1., 1.)], [3, 4, 5]),
    ] {
        let flat = Triangle { at, id };
        assert!(!triangles_cross(&good, &flat), "{flat:?}");
        assert!(!triangles_cross(&flat, &good), "{flat:?}");
    }
}

/// A triangle without area beside another, on a common edge, and where its middle corner goes.
fn opened(middle: [f32; 3]) -> (Surface, Vec<Vec3A>, Vec<Vec3A>) {
    let at = |p: [f32; 3]| Vec3A::from_array(p);
    let rest = [[0., 0., 0.], [4., 0., 0.], [0., 4., 0.], [2., 0., 0.]].map(at).to_vec();
    let surface = Surface::new(vec![[0, 1, 2], [0, 3, 1]], &rest);
    let mut to = rest.clone();
    to[3] = at(middle);
    (surface, rest, to)
}

#[test]
fn a_triangle_without_area_is_looked_at_where_nothing_can_be_proven() {
    let (surface, rest, to) = opened([2., -1., 0.5]);
    assert!(surface.unproven_pairs(&rest, &to).is_empty());
}

#[test]
fn sabotage_one_that_folds_onto_its_neighbour_is_seen() {
    let (surface, rest, to) = opened([2., 1., 0.]);
    assert_eq!(surface.unproven_pairs(&rest, &to), [(0, 1)]);
}

/// Depth and direction of each ordered pair, as bits.
type Pairs = BTreeMap<(u32, u32), (u32, [u32; 3])>;

fn found(complex: &Complex, boundary: &[u32], radius: &[f32], positions: &[Vec3A]) -> Pairs {
    let contacts = contact::find(complex, boundary, radius, positions);
    let pairs: Pairs = (0..complex.nodes() as u32)
        .flat_map(|i| contacts.of(i as usize).iter().map(move |c| (i, c)))
        .map(|(i, c)| ((i, c.other), (c.depth.to_bits(), c.direction.to_array().map(f32::to_bits))))
        .collect();
    assert_eq!(pairs.len(), 2 * contacts.len(), "a pair is listed twice");
    pairs
}

fn all_pairs(complex: &Complex, boundary: &[u32], radius: &[f32], positions: &[Vec3A]) -> Pairs {
    let mut pairs = Pairs::new();
    for &i in boundary {
        for &j in boundary.iter().filter(|&&j| j != i) {
            let apart = positions[i as usize] - positions[j as usize];
            let reach = radius[i as usize].max(radius[j as usize]);
            let common = |n: &u32| complex.neighbours[j as usize].contains(n);
            let near = complex.neighbours[i as usize].iter().any(|n| *n == j || common(n));
            if apart.length_squared() < reach * reach && !near {
                let value = (reach - apart.length(), apart / apart.length());
                pairs.insert((i, j), (value.0.to_bits(), value.1.to_array().map(f32::to_bits)));
            }
        }
    }
    pairs
}
