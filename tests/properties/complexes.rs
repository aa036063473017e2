//! Complexes of any cells conform.

use std::collections::HashSet;

use homunculus::voxel::Complex;
use proptest::prelude::*;

use super::{cases, scattered};

/// Whether the elements fit face to face and `faces` are what is left over, seen from outside.
fn fits(complex: &Complex) -> Result<(), String> {
    let turned = |[a, b, c]: [u32; 3]| match [a, b, c].iter().min() {
        Some(&least) if least == b => [b, c, a],
        Some(&least) if least == c => [c, a, b],
        _ => [a, b, c],
    };
    let mut open = HashSet::new();
    for t in 0..complex.elements() {
        let [a, b, c, d] = complex.element(t);
        for face in [[a, c, b], [a, b, d], [a, d, c], [b, c, d]] {
            let [x, y, z] = face;
            if !open.remove(&turned([z, y, x])) && !open.insert(turned(face)) {
                return Err(format!("face {face:?} belongs to two elements on the same side"));
            }
        }
    }
    let skin: HashSet<_> = complex.faces.iter().map(|&f| turned(f)).collect();
    if skin.len() != complex.faces.len() || skin != open {
        return Err(format!("{} faces, {} without an element behind", complex.faces.len(), open.len()));
    }
    Ok(())
}

proptest! {
    #![proptest_config(cases(64))]

    #[test]
    fn any_cells_make_a_conforming_complex(complex in scattered(10)) {
        prop_assert_eq!(complex.is_conforming(), Ok(()));
        prop_assert_eq!(fits(&complex), Ok(()));
        let flags = complex.on_boundary.iter().filter(|&&b| b).count();
        let used: HashSet<_> = complex.faces.iter().flatten().collect();
        prop_assert_eq!(flags, used.len());
        prop_assert!(complex.body.iter().all(|&b| b < complex.bodies));
    }

    #[test]
    fn sabotage_a_face_or_a_neighbour_amiss_is_seen(complex in scattered(6), at in any::<prop::sample::Index>(), slot in 0..14_usize) {
        let mut broken = complex.clone();
        broken.faces.remove(at.index(complex.faces.len()));
        prop_assert!(broken.is_conforming().is_err());
        prop_assert!(fits(&broken).is_err());

        let mut broken = complex.clone();
        let i = at.index(complex.nodes());
        broken.neighbours[i][slot] = (broken.neighbours[i][slot] + 1) % complex.nodes() as u32;
        prop_assert!(broken.is_conforming().is_err());

        let mut broken = complex.clone();
        broken.corners[at.index(complex.cells.len())].swap(0, 7);
        prop_assert!(fits(&broken).is_err());
    }
}
