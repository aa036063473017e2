//! Numbers at the edge of what single and double precision can say, of which something was proven that is not so. All
//! were found when the bounds of rounding were derived and attacked, and mended on 28 November 2026; the attacks in
//! `src/certificate` hold many more of each kind.

use glam::{IVec3, Vec3A};
use homunculus::{
    certificate::{Surface, Surfaces, certify, orientation},
    voxel::{Complex, KUHN},
};

use super::complex;

/// The complex of one cell, and places of its corners, given bit by bit.
fn cell(corners: [[u32; 3]; 8]) -> (Complex, Vec<Vec3A>) {
    let complex = complex(IVec3::ONE, |_| true);
    let mut places = complex.rest.clone();
    for (node, at) in complex.corners[0].iter().zip(corners) {
        places[*node as usize] = Vec3A::from_array(at.map(f32::from_bits));
    }
    (complex, places)
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
    let (complex, places) = cell(BELOW);
    let inverted = inverted(&complex, &places);
    assert!(inverted > 0);
    assert_eq!(certify(&complex, &Surfaces::skin_of(&complex), &places).inverted(), inverted);
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
