//! States and motions of small complexes that once were passed.

use glam::{IVec3, Vec3A};
use homunculus::{
    certificate::{CarriedState, Certificate, Surfaces, certify, certify_motion},
    collision::{Problem, grow, guard_step},
    voxel::{Complex, blend},
};

use super::{
    common::{lifted, mote},
    complex,
};

/// The certificate of a state, and whether the motion to it is proven.
fn motion(complex: &Complex, from: &[Vec3A], to: &[Vec3A]) -> (Certificate, bool) {
    let surfaces = Surfaces::skin_of(complex);
    let [from, to] = [from, to].map(|nodes| CarriedState::new(&surfaces, nodes.to_vec()));
    certify_motion(complex, &surfaces, &from, &to)
}

/// Two cells two apart, and where the second goes so that its edge is beside the other's from `enters` of the motion on
/// and above it from `leaves` on.
fn passing(enters: f32, leaves: f32) -> (Complex, Vec<Vec3A>) {
    let complex = complex(IVec3::new(3, 1, 1), |c| c.x != 1);
    let by = Vec3A::new(-1.0 / enters, 1.0 / leaves, 0.0);
    let moved = |(p, &body): (&Vec3A, &u32)| if body == complex.body[0] { *p } else { *p + by };
    let to = complex.rest.iter().zip(&complex.body).map(moved).collect();
    (complex, to)
}

/// One edge cuts another from 0.918 to 0.92 of the motion, while none of the eighths of it, which alone were looked at,
/// is at fault; mended on 22 November 2026, when motions in space came to be proven.
#[test]
fn the_edge_that_cuts_another_between_two_eighths() {
    let (complex, to) = passing(0.918, 0.92);
    let surfaces = Surfaces::skin_of(&complex);
    for eighths in 0..=8_u8 {
        let between = blend(&complex.rest, &to, f32::from(eighths) / 8.0);
        assert!(certify(&complex, &surfaces, &between).certified());
    }
    assert!(!certify(&complex, &surfaces, &blend(&complex.rest, &to, 0.919)).certified());
    let (certificate, proven) = motion(&complex, &complex.rest, &to);
    assert!(certificate.certified() && !proven);
}

/// Its sibling: a little later, and the edge passes the other.
#[test]
fn the_edge_that_does_not() {
    let (complex, to) = passing(0.92, 0.918);
    let (certificate, proven) = motion(&complex, &complex.rest, &to);
    assert!(certificate.certified() && proven);
}

/// A mote in front of a box was inside it after one step, no face crossing another before or after, and the guard let
/// it pass; mended on 22 November 2026, when bodies within bodies came to be seen.
#[test]
fn the_mote_that_was_swallowed() {
    let (complex, mut positions) = mote();
    let surfaces = Surfaces::skin_of(&complex);
    assert!(certify(&complex, &surfaces, &positions).certified());
    let proposed = lifted(&complex, &positions, 0.45);
    // Sabotage: that is where the step leads.
    assert!(!certify(&complex, &surfaces, &proposed).certified());
    let asked = grow(&complex, &Problem::new(&complex, &vec![1.0; complex.nodes()], 0.5), 1.0);
    guard_step(&complex, &asked, &surfaces, &mut positions, proposed, &mut Vec::new());
    assert!(certify(&complex, &surfaces, &positions).certified());
}
