//! What is carried between surface and lattice: the binding of vertices, importance spread to nodes, and the whole warp
//! where nothing, or the same everywhere, is asked for.

use glam::{DVec3, Vec3A};
use homunculus::{
    boundary::Boundary,
    importance::{Layer, Sample, Sampling},
    transfer::Binding,
    voxel::{Complex, Grid, MAX_RESOLUTION, MIN_RESOLUTION, voxelize},
};
use proptest::prelude::*;

use super::{
    cases,
    common::{Random, cuboids, warp},
    rough,
};

/// Any triangles, in places that a single can say.
fn soup(seed: u64, count: usize, scale: f32) -> Boundary {
    let mut random = Random(seed);
    let mut number = || (scale * random.unit() as f32).into();
    let positions: Vec<DVec3> = (0..3 * count).map(|_| DVec3::new(number(), number(), number())).collect();
    let triangles = (0..count as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    Boundary::from_triangles("soup", positions, triangles)
}

fn soups() -> impl Strategy<Value = Boundary> {
    (any::<u64>(), 1..20_usize, prop_oneof![Just(1.0_f32), Just(1.0e-6), Just(1.0e6)])
        .prop_map(|(seed, count, scale)| soup(seed, count, scale))
}

fn bits(positions: &[DVec3]) -> Vec<[u64; 3]> {
    positions.iter().map(|p| p.to_array().map(f64::to_bits)).collect()
}

/// Nodes moved by an affine map take the surface with them, as far as f32 tells.
fn follows(boundary: &Boundary, complex: &Complex, binding: &Binding) -> Result<(), String> {
    let map = |p: DVec3| DVec3::new(1.5 * p.x + 0.5 * p.y, p.y - 0.25 * p.z, 2.0 * p.z + 1.0);
    let nodes: Vec<Vec3A> = complex.rest.iter().map(|p| map(p.as_dvec3()).as_vec3a()).collect();
    for (v, (at, rest)) in binding.apply(&nodes).iter().zip(&boundary.positions).enumerate() {
        let expected = map(complex.grid.lattice_from_source(*rest));
        let off = (complex.grid.lattice_from_source(*at) - expected).length();
        if off > 1e-4 {
            return Err(format!("vertex {v} is {off} cells off"));
        }
    }
    Ok(())
}

/// Whether every value is within the range; `None` where it is.
fn outside(values: &[f32], low: f32, high: f32) -> Option<usize> {
    values.iter().position(|&f| !(low..=high).contains(&f))
}

/// The vertex that lies on or beyond the lattice's outer faces, if any; or that the resolution is another one.
fn beyond(boundary: &Boundary, grid: &Grid, resolution: u32) -> Result<(), String> {
    if grid.cells.max_element() != resolution {
        return Err(format!("{} cells at resolution {resolution}", grid.cells));
    }
    let at = |p: &DVec3| grid.lattice_from_source(*p);
    let out = |p: &DVec3| p.min_element() <= 0.0 || (grid.cells.as_dvec3() - *p).min_element() <= 0.0;
    boundary.positions.iter().map(at).find(out).map_or(Ok(()), |p| Err(format!("{p} is beyond {}", grid.cells)))
}

proptest! {
    #![proptest_config(cases(64))]

    #[test]
    fn the_grid_holds_the_boundary(extent in prop::array::uniform3(0.01_f64..10.0), place in prop::array::uniform3(-5.0_f64..5.0)) {
        let place = DVec3::from(place);
        let boundary = cuboids("box", &[(place.to_array(), (place + DVec3::from(extent)).to_array())]);
        for resolution in MIN_RESOLUTION..=MAX_RESOLUTION {
            let mut grid = Grid::around(&boundary, resolution).unwrap();
            prop_assert_eq!(beyond(&boundary, &grid, resolution), Ok(()), "{}", resolution);
            // Sabotage: half a cell aside.
            grid.origin.z -= 0.5 * grid.cell_size;
            prop_assert!(extent[2] < extent[0].max(extent[1]) || beyond(&boundary, &grid, resolution).is_err());
        }
    }
}

proptest! {
    #![proptest_config(cases(32))]

    #[test]
    fn bindings_are_inside_and_rest_where_nothing_moves(boundary in soups(), resolution in 8..12_u32) {
        let complex = voxelize(&boundary, resolution).unwrap();
        prop_assert_eq!(complex.is_conforming(), Ok(()));
        let binding = Binding::new(&boundary, &complex);
        prop_assert_eq!(binding.is_inside(), Ok(()));
        prop_assert!(binding.weights.iter().all(|w| w.iter().sum::<f32>() > 0.5), "a vertex is outside of all cells");
        prop_assert_eq!(bits(&binding.apply(&complex.rest)), bits(&boundary.positions));
        prop_assert_eq!(follows(&boundary, &complex, &binding), Ok(()));
    }

    #[test]
    fn sabotage_wrong_weights_are_seen(boundary in soups(), at in any::<prop::sample::Index>(), k in 0..4_usize) {
        let complex = voxelize(&boundary, 8).unwrap();
        let binding = Binding::new(&boundary, &complex);
        let v = at.index(boundary.positions.len());
        for wrong in [binding.weights[v][k] + 0.01, -0.01, f32::NAN] {
            let mut broken = binding.clone();
            broken.weights[v][k] = wrong;
            prop_assert_eq!(broken.is_inside(), Err(v));
        }
        let mut broken = binding;
        broken.nodes[v].reverse();
        let [a, b, c, d] = broken.weights[v];
        let symmetric = (a - d).abs() < 1e-3 && (b - c).abs() < 1e-3;
        prop_assert!(symmetric || follows(&boundary, &complex, &broken).is_err());
    }

    #[test]
    fn importance_is_spread_within_its_range(boundary in soups(), resolution in 8..16_u32, seed in any::<u64>(), low in 0.05_f64..1.0, ratio in 1.0_f64..100.0) {
        let complex = voxelize(&boundary, resolution).unwrap();
        let sampling = Sampling::new(&boundary, &complex);
        let asked = rough(&mut Random(seed), sampling.samples.len(), low, low * ratio);
        let (least, most) = asked.iter().fold((f32::INFINITY, 0.0_f32), |(l, h), &f| (l.min(f), h.max(f)));
        let nodes = sampling.spread(&complex, &asked);
        prop_assert_eq!(nodes.len(), complex.nodes());
        prop_assert_eq!(outside(&nodes, least, most), None);

        // What is the same everywhere stays so, to the last bit.
        let same = sampling.spread(&complex, &vec![asked[0]; asked.len()]);
        prop_assert!(same.iter().all(|f| *f == asked[0]));

        // Sabotage: one value beyond, or none at all.
        for wrong in [most * 1.0001, least * 0.9999, f32::NAN] {
            let mut broken = nodes.clone();
            broken[seed as usize % nodes.len()] = wrong;
            prop_assert!(outside(&broken, least, most).is_some());
        }
    }

    #[test]
    fn what_is_smooth_on_the_surface_arrives(seed in any::<u64>()) {
        // A box twice as important at one end as at the other, evenly in the logarithm.
        let side = 0.3 + Random(seed).unit();
        let boundary = cuboids("box", &[([0.0; 3], [1.0, side, side])]);
        let complex = voxelize(&boundary, 16).unwrap();
        let sampling = Sampling::new(&boundary, &complex);
        let at = |s: &Sample| -> DVec3 {
            let corners = boundary.triangles[s.triangle as usize].map(|v| boundary.positions[v as usize]);
            corners.iter().zip(s.weights).map(|(p, w)| *p * f64::from(w)).sum()
        };
        let wanted = |p: DVec3| p.x.exp2();
        let asked: Vec<f32> = sampling.samples.iter().map(|s| wanted(at(s)) as f32).collect();
        let nodes = sampling.spread(&complex, &asked);
        let off = complex.rest.iter().zip(&nodes).map(|(p, &f)| {
            let p = complex.grid.source_from_lattice(p.as_dvec3());
            (f64::from(f) / wanted(p.clamp(DVec3::ZERO, DVec3::ONE))).ln().abs()
        }).fold(0.0, f64::max);
        prop_assert!(off < 0.1, "{off}");
    }
}

proptest! {
    #![proptest_config(cases(6))]

    #[test]
    fn importance_one_leaves_every_bit(boundary in soups(), resolution in 8..11_u32) {
        let outcome = warp(&boundary, &[], resolution, 0.5).unwrap();
        for frame in &outcome.frames {
            prop_assert_eq!(bits(&frame.positions), bits(&boundary.positions), "λ = {}", frame.lambda);
            prop_assert!(frame.certificate.certified());
        }
    }

    #[test]
    fn the_same_importance_everywhere_scales_the_shape(side in 0.4_f64..1.0, gap in 0.3_f64..0.6, s in 0.4_f32..3.0, mu in 0.0_f32..=0.9) {
        // Up to μ = 0.9: nearer to 1 shape is hardly held, and comes to rest slowly a third of a cell off.
        // Bars in a row, so near each other that all but one must give way; one bar alone, which scales in place.
        let near = gap < 0.4;
        let bar = |z: f64| ([0.0, 0.0, z], [1.0, side, z + side]);
        let bars = [bar(0.0), bar(side + gap)];
        let boundary = cuboids("bars", &bars[..if near { 2 } else { 1 }]);
        let layers = [Layer::Sphere { centre: [0.5, 0.0, 0.0], radius: 1.0e4, value: s }];
        let outcome = warp(&boundary, &layers, 10, mu).unwrap();
        prop_assert!(outcome.frames.iter().all(|f| f.certificate.certified()));
        prop_assert!(outcome.fidelity.p95 < 0.03, "{:?}", outcome.fidelity);
        if !near {
            let centre = |p: &[DVec3]| p.iter().sum::<DVec3>() / p.len() as f64;
            let last = &outcome.frames.last().unwrap().positions;
            let (from, to) = (centre(&boundary.positions), centre(last));
            let off = boundary.positions.iter().zip(last).map(|(p, q)| (f64::from(s) * (*p - from) - (*q - to)).length()).fold(0.0, f64::max);
            prop_assert!(off < 0.2 * outcome.domain.cell_size, "{} cells off", off / outcome.domain.cell_size);
            prop_assert!((from - to).length() < 0.05 * outcome.domain.cell_size, "it drifts");
        }
    }
}
