//! Numbers at the edge of what single and double precision can say, of which something was proven that is not so. All
//! were found when the bounds of rounding were derived and attacked, and mended on 28 November 2026; the attacks in
//! `src/certificate` hold many more of each kind.

use glam::{IVec3, Vec3A};
use homunculus::{
    certificate::{CarriedState, Surface, Surfaces, certify, certify_motion, orientation},
    voxel::{Complex, KUHN},
};

use super::complex;

/// The complex of one cell, and places of its corners, given bit by bit, in the order of its nodes.
fn cell<const N: usize>(states: [[[u32; 3]; 8]; N]) -> (Complex, [Vec<Vec3A>; N]) {
    let complex = complex(IVec3::ONE, |_| true);
    let states = states.map(|corners| {
        let mut places = complex.rest.clone();
        for (node, at) in complex.corners[0].iter().zip(corners) {
            places[*node as usize] = Vec3A::from_array(at.map(f32::from_bits));
        }
        places
    });
    (complex, states)
}

/// Elements that are not positive, in double precision, one at a time.
fn inverted(complex: &Complex, places: &[Vec3A]) -> usize {
    let at = |element: [usize; 4]| element.map(|k| places[complex.corners[0][k] as usize].as_dvec3());
    KUHN.into_iter().map(at).filter(|&[a, b, c, d]| orientation(a, b, c, d) <= 0).count()
}

/// A cell of 10⁻¹⁴ cells, some of its elements inverted, was certified to have none: its volumes are below the range of
/// single precision, and so was the bound of their rounding.
#[test]
fn a_cell_below_the_range_of_single_precision() {
    let (complex, [places]) = cell([BELOW]);
    let inverted = inverted(&complex, &places);
    assert!(inverted > 0);
    assert_eq!(certify(&complex, &Surfaces::skin_of(&complex), &places).inverted(), inverted);
}

/// A cell whose edges are nearly one line, some of its elements inverted half-way, was proven to keep them all
/// positive: what was taken for the inverse of its mean edges was rounding and nothing else.
#[test]
fn a_cell_drawn_out_to_a_line() {
    let (complex, [from, to]) = cell(LINE);
    let half: Vec<Vec3A> = from.iter().zip(&to).map(|(a, b)| 0.5 * (*a + *b)).collect();
    assert!(inverted(&complex, &half) > 0 && inverted(&complex, &to) == 0);
    let surfaces = Surfaces::skin_of(&complex);
    let [from, to] = [from, to].map(|nodes| CarriedState::new(&surfaces, nodes));
    assert!(!certify_motion(&complex, &surfaces, &from, &to).1);
}

/// Two triangles that cross, of 10¹⁹ cells, were proven to lie apart: their gap was infinite.
#[test]
fn triangles_beyond_the_range_of_single_precision() {
    let mut state = 1_u64;
    let mut number = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 40) as f32 / (1 << 23) as f32 - 1.0) * 63.5_f32.exp2()
    };
    let mut crossing = 0;
    for _ in 0..4000 {
        let places: Vec<Vec3A> = (0..6).map(|_| Vec3A::new(number(), number(), number())).collect();
        let surface = Surface::new(vec![[0, 1, 2], [3, 4, 5]], &places);
        let exact: Vec<_> = places.iter().map(|p| p.as_dvec3()).collect();
        let expected = surface.crossings_by_brute_force(&exact);
        crossing += expected.len();
        assert_eq!(surface.crossings(&places), expected);
    }
    assert!(crossing > 0);
}

/// Two segments of the plane, one beginning on the middle of the other at every instant, were proven to stay apart: the
/// instants that their motion was cut at were taken for exact, though one end is 10²⁰ times as far away as the other.
#[test]
fn segments_that_come_from_afar() {
    let at = |x: f32, y: f32| Vec3A::new(x, y, 0.0);
    let mut wrong = 0;
    for k in 1..200_u8 {
        let k = f32::from(k);
        let (a, b) = ([3.0 * k + 1.0, k], [7.0 - k, 5.0 * k + 3.0]);
        let middle = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
        let points = [a, b, middle, [k * k, 11.0 - k]];
        let from = points.map(|[x, y]| at(x * (-60.0_f32).exp2(), y * (-40.0_f32).exp2())).to_vec();
        let to = points.map(|[_, y]| at(997.0 + k, y * (-40.0_f32).exp2())).to_vec();
        let surface = Surface::flat(vec![[0, 1, 1], [2, 3, 3]], &from);
        wrong += usize::from(surface.unproven_pairs(&from, &to).is_empty());
    }
    assert_eq!(wrong, 0);
}

const BELOW: [[u32; 3]; 8] = [
    [0xA653_CF12, 0x26B3_CB86, 0xA6F0_0DE1],
    [0x27E8_D044, 0x24F5_23CB, 0xA835_9977],
    [0xA79C_FB33, 0x27FC_16B8, 0xA70B_CC20],
    [0x274C_9DF0, 0x27D2_F86B, 0xA83A_8AC4],
    [0xA7FD_EDDB, 0x2800_7972, 0x26D2_7FAE],
    [0x252B_8940, 0x27D7_D494, 0xA7FA_8F8B],
    [0xA840_3795, 0x2868_0B5F, 0x26AA_F549],
    [0xA77A_4A04, 0x2853_7C37, 0xA802_3913],
];

const LINE: [[[u32; 3]; 8]; 2] = [
    [
        [0x3512_BF18, 0xB51E_8B49, 0x35A4_285C],
        [0x41ED_62F9, 0x4157_2376, 0x4196_27CD],
        [0x41ED_62FF, 0x4157_237A, 0x4196_27D4],
        [0x426D_62FC, 0x41D7_2379, 0x4216_27D0],
        [0x41ED_62FA, 0x4157_237C, 0x4196_27BD],
        [0x426D_62FB, 0x41D7_237B, 0x4216_27C5],
        [0x426D_62FD, 0x41D7_237B, 0x4216_27C9],
        [0x42B2_0A3D, 0x4221_5A9B, 0x4261_3BAF],
    ],
    [
        [0xB51B_AAF3, 0xB588_48B1, 0xB4F1_68F5],
        [0x41ED_62FA, 0x4157_2377, 0x4196_27CC],
        [0x41ED_62FF, 0x4157_237A, 0x4196_27D4],
        [0x426D_62FC, 0x41D7_2379, 0x4216_27D0],
        [0x41ED_62FB, 0x4157_237E, 0x4196_27BD],
        [0x426D_62FA, 0x41D7_237A, 0x4216_27C5],
        [0x426D_62FD, 0x41D7_237A, 0x4216_27C9],
        [0x42B2_0A3D, 0x4221_5A9B, 0x4261_3BAE],
    ],
];
