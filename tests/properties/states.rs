//! States: whatever is asked for and however wild the step, the guard leaves an injective state; the certificate says
//! exactly what is wrong with any other.

use glam::{DVec3, IVec3, Mat3A, Quat, Vec3A};
use homunculus::{
    certificate::{CarriedState, Certificate, Surface, Surfaces, certify, certify_motion},
    collision::{Problem, contact_step, global_step, grow, guard, guard_step, local_step},
    edge::EdgeSolver,
    voxel::{Complex, blend},
};
use proptest::prelude::*;
use robust::{Coord3D, orient3d};

use super::{
    boxes_with_gaps, cases,
    common::{Random, lifted, mote},
    complex, rough, scattered,
};

/// Elements that are not positive, by exact arithmetic one at a time.
fn inverted(complex: &Complex, positions: &[Vec3A]) -> usize {
    let at = |i: u32| {
        let p = positions[i as usize].as_dvec3();
        Coord3D { x: p.x, y: p.y, z: p.z }
    };
    let is_positive = |[a, b, c, d]: [u32; 4]| orient3d(at(a), at(b), at(c), at(d)) < 0.0;
    (0..complex.elements()).filter(|&t| !is_positive(complex.element(t))).count()
}

/// Pairs of boundary faces that cross, by all pairs.
fn crossings(complex: &Complex, positions: &[Vec3A]) -> Vec<(u32, u32)> {
    let positions: Vec<DVec3> = positions.iter().map(|p| p.as_dvec3()).collect();
    Surface::new(complex.faces.clone(), &complex.rest).crossings_by_brute_force(&positions)
}

/// Pairs of bodies of which one has a node inside the other: elements and faces alone would not tell.
fn swallowed(complex: &Complex, positions: &[Vec3A]) -> Vec<(u32, u32)> {
    let inside = |p: DVec3, t: usize| {
        let [a, b, c, d] = complex.element(t).map(|i| positions[i as usize].as_dvec3());
        let volume = |a: DVec3, b: DVec3, c: DVec3, d: DVec3| (b - a).dot((c - a).cross(d - a));
        [volume(p, b, c, d), volume(a, p, c, d), volume(a, b, p, d), volume(a, b, c, p)].iter().all(|&v| v >= 0.0)
    };
    let mut pairs = Vec::new();
    for body in 0..complex.bodies {
        let Some(node) = complex.body.iter().position(|&b| b == body) else { continue };
        let p = positions[node].as_dvec3();
        let elements = (0..complex.elements()).filter(|&t| inside(p, t));
        pairs.extend(elements.map(|t| (body, complex.body[complex.element(t)[0] as usize])).filter(|&(a, b)| a != b));
    }
    pairs
}

fn fault(complex: &Complex, positions: &[Vec3A]) -> Result<(), String> {
    let (inverted, crossings, swallowed) =
        (inverted(complex, positions), crossings(complex, positions), swallowed(complex, positions));
    if inverted > 0 || !crossings.is_empty() || !swallowed.is_empty() {
        return Err(format!("{inverted} inverted, {} crossings, swallowed {swallowed:?}", crossings.len()));
    }
    Ok(())
}

/// One iteration of the collision optimization, its step shaken by up to `kick` cells.
#[derive(Debug)]
struct Iteration {
    lambda: f32,
    kick: f64,
}

fn iterations() -> impl Strategy<Value = Vec<Iteration>> {
    let one = (0.0_f32..=1.0, prop_oneof![Just(0.0), Just(0.0), Just(0.3), Just(3.0)]);
    prop::collection::vec(one.prop_map(|(lambda, kick)| Iteration { lambda, kick }), 2..8)
}

fn jitter(random: &mut Random) -> Vec3A {
    Vec3A::from_array(std::array::from_fn(|_| (2.0 * random.unit() - 1.0) as f32))
}

struct Run<'a> {
    complex: &'a Complex,
    problem: Problem,
    surfaces: Surfaces,
    positions: Vec<Vec3A>,
    rotations: Vec<Quat>,
    targets: Vec<Mat3A>,
    random: Random,
}

impl<'a> Run<'a> {
    fn new(complex: &'a Complex, seed: u64, fidelity: f32) -> Self {
        let mut random = Random(seed);
        let importance = rough(&mut random, complex.nodes(), 0.3, 5.0);
        Self {
            complex,
            problem: Problem::new(complex, &importance, fidelity),
            surfaces: Surfaces::skin_of(complex),
            positions: complex.rest.clone(),
            rotations: Vec::new(),
            targets: Vec::new(),
            random,
        }
    }

    fn propose(&mut self, iteration: &Iteration) -> (homunculus::collision::Asked, Vec<Vec3A>) {
        let (complex, problem) = (self.complex, &self.problem);
        let asked = grow(complex, problem, iteration.lambda);
        local_step(complex, problem, &asked, &self.positions, &mut self.rotations, &mut self.targets);
        let contacts = contact_step(complex, problem, &asked, &self.positions);
        let (mut proposed, _) = global_step(complex, problem, &self.positions, &self.targets, &contacts);
        for p in &mut proposed {
            *p += iteration.kick as f32 * jitter(&mut self.random);
        }
        (asked, proposed)
    }

    fn iterate(&mut self, iteration: &Iteration) {
        let (asked, proposed) = self.propose(iteration);
        guard_step(self.complex, &asked, &self.surfaces, &mut self.positions, proposed, &mut Vec::new());
    }
}

fn stays_valid(complex: &Complex, seed: u64, fidelity: f32, iterations: &[Iteration]) -> Result<(), TestCaseError> {
    let mut run = Run::new(complex, seed, fidelity);
    prop_assert_eq!(fault(complex, &run.positions), Ok(()), "at rest");
    for (k, iteration) in iterations.iter().enumerate() {
        run.iterate(iteration);
        prop_assert_eq!(fault(complex, &run.positions), Ok(()), "after iteration {}", k);
        prop_assert!(certify(complex, &run.surfaces, &run.positions).certified());
    }
    Ok(())
}

/// That the certificate counts what brute force counts.
fn is_told(complex: &Complex, positions: &[Vec3A]) -> Result<Certificate, TestCaseError> {
    let certificate = certify(complex, &Surfaces::skin_of(complex), positions);
    prop_assert_eq!(certificate.inverted(), inverted(complex, positions));
    prop_assert_eq!(certificate.crossings(), crossings(complex, positions).len());
    Ok(certificate)
}

proptest! {
    #![proptest_config(cases(24))]

    #[test]
    fn boxes_with_gaps_stay_valid(complex in boxes_with_gaps(7), seed in any::<u64>(), mu in 0.0_f32..=1.0, iterations in iterations()) {
        stays_valid(&complex, seed, mu, &iterations)?;
    }

    #[test]
    fn scattered_cells_stay_valid(complex in scattered(5), seed in any::<u64>(), mu in 0.0_f32..=1.0, iterations in iterations()) {
        stays_valid(&complex, seed, mu, &iterations)?;
    }

    #[test]
    fn any_state_is_told_exactly(complex in scattered(5), seed in any::<u64>(), strength in 0.0_f32..1.5) {
        let mut random = Random(seed);
        let positions: Vec<Vec3A> = complex.rest.iter().map(|p| *p + strength * jitter(&mut random)).collect();
        is_told(&complex, &positions)?;
        // On a coarse lattice much touches and is flat, which only exact signs tell.
        let snapped: Vec<Vec3A> = positions.iter().map(|p| (*p * 2.0).round() * 0.5).collect();
        is_told(&complex, &snapped)?;
    }

    #[test]
    fn a_motion_that_is_said_to_be_proven_is_valid(complex in scattered(4), seed in any::<u64>(), strength in 0.0_f32..0.6, turn in 0.0_f32..1.0) {
        let mut random = Random(seed);
        let turn = Mat3A::from_axis_angle(jitter(&mut random).normalize().into(), turn);
        let to: Vec<Vec3A> = complex.rest.iter().map(|p| turn * (*p + strength * jitter(&mut random))).collect();
        let surfaces = Surfaces::skin_of(&complex);
        let (certificate, proven) = motion(&complex, &surfaces, &complex.rest, &to);
        prop_assert_eq!(&certificate, &certify(&complex, &surfaces, &to));
        prop_assert!(strength > 0.02 || proven);
        for _ in 0..8 {
            let between = blend(&complex.rest, &to, random.unit() as f32);
            prop_assert!(!proven || fault(&complex, &between).is_ok(), "{:?}", fault(&complex, &between));
        }
    }

    #[test]
    fn sabotage_one_flipped_element_is_counted(complex in scattered(4), at in any::<prop::sample::Index>()) {
        let t = at.index(complex.elements());
        let [a, b, c, d] = complex.element(t);
        let at = |i: u32| complex.rest[i as usize];
        let mut positions = complex.rest.clone();
        // The last corner goes to the other side of the opposite face.
        let normal = (at(b) - at(a)).cross(at(c) - at(a)).normalize();
        positions[d as usize] -= 1.5 * normal * normal.dot(at(d) - at(a));
        let certificate = is_told(&complex, &positions)?;
        prop_assert!(certificate.inverted() > 0 && !certificate.certified() && certificate.min_volume_ratio() < 0.0);
    }

    #[test]
    fn sabotage_a_node_moved_through_a_face_is_told_with_its_place(x in 0..3_i32, y in 0..3_i32) {
        let (complex, mut positions) = two_bars();
        let node = complex.rest.iter().position(|p| *p == IVec3::new(x, y, 2).as_vec3a()).unwrap();
        positions[node].z += 1.5;
        let certificate = is_told(&complex, &positions)?;
        prop_assert!(certificate.crossings() > 0 && !certificate.certified());
        // The middle of a triangle that crosses: the one drawn out to the node is not longer than three cells.
        let place = certificate.worst().unwrap();
        prop_assert!((place - positions[node].as_dvec3()).length() < 2.0, "{place} is not near {}", positions[node]);
    }
}

/// Two bars of 2 × 2 × 2 with a gap of one between them, at rest.
fn two_bars() -> (Complex, Vec<Vec3A>) {
    let complex = complex(IVec3::new(2, 2, 5), |c| c.z != 2);
    let rest = complex.rest.clone();
    (complex, rest)
}

/// Grows both bars fourfold in `steps`, with or without the guard.
fn bars_after_growth(guarded: bool) -> Result<(), String> {
    let (complex, _) = two_bars();
    let mut run = Run::new(&complex, 1, 0.5);
    run.problem.set_importance(&complex, &vec![4.0; complex.nodes()]);
    let mut linear = complex.rest.clone();
    EdgeSolver::new(&complex).solve(&complex, &vec![4.0; complex.nodes()], &mut linear);
    for k in 1..=8_u8 {
        let (asked, _) = run.propose(&Iteration { lambda: f32::from(k) / 8.0, kick: 0.0 });
        // Straight for Eq. 1, in which the bars know nothing of each other.
        let step = 1.0 / f32::from(9 - k);
        let mut proposed: Vec<Vec3A> = run.positions.iter().zip(&linear).map(|(x, v)| *x + step * (*v - *x)).collect();
        if guarded {
            guard::guard(
                &complex,
                &run.surfaces,
                &asked.size,
                &run.positions,
                &mut proposed,
                guard::Extent::End,
                &mut Vec::new(),
            );
        }
        run.positions = proposed;
        fault(&complex, &run.positions)?;
    }
    Ok(())
}

#[test]
fn guarded_bars_do_not_cross() {
    assert_eq!(bars_after_growth(true), Ok(()));
}

#[test]
fn sabotage_unguarded_bars_cross() {
    assert!(bars_after_growth(false).unwrap_err().contains("crossings"));
}

/// The certificate of a state, and whether the motion to it is proven.
fn motion(complex: &Complex, surfaces: &Surfaces, from: &[Vec3A], to: &[Vec3A]) -> (Certificate, bool) {
    let [from, to] = [from, to].map(|nodes| CarriedState::new(surfaces, nodes.to_vec()));
    certify_motion(complex, surfaces, &from, &to)
}

#[test]
fn sabotage_bodies_that_change_places_have_no_proven_motion() {
    let (complex, rest) = two_bars();
    let up = |body: u32| if body == complex.body[0] { 3.0 * Vec3A::Z } else { -3.0 * Vec3A::Z };
    let swapped: Vec<Vec3A> = rest.iter().zip(&complex.body).map(|(p, &body)| *p + up(body)).collect();
    let (certificate, proven) = motion(&complex, &Surfaces::skin_of(&complex), &rest, &swapped);
    assert!(certificate.certified() && !proven);
    // A half-turn is a valid state too, but the straight motion there goes through a line.
    let turned: Vec<Vec3A> = rest.iter().map(|p| *p * Vec3A::new(-1.0, -1.0, 1.0)).collect();
    let (certificate, proven) = motion(&complex, &Surfaces::skin_of(&complex), &rest, &turned);
    assert!(certificate.certified() && !proven);
}

#[test]
fn the_certificate_tells_a_swallowed_body() {
    let (complex, positions) = mote();
    assert!(certify(&complex, &Surfaces::skin_of(&complex), &positions).certified());
    let deep = lifted(&complex, &positions, 1.0);
    assert!(!certify(&complex, &Surfaces::skin_of(&complex), &deep).certified());
}

#[test]
fn sabotage_a_swallowed_body_is_found() {
    let (complex, positions) = mote();
    assert_eq!(fault(&complex, &positions), Ok(()));
    assert!(fault(&complex, &lifted(&complex, &positions, 1.0)).unwrap_err().contains("swallowed [(0, 1)"));
}
