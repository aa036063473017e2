//! What is filmed: a solved domain, its states and what was proven of each.

use std::collections::HashMap;
use std::sync::Arc;

use glam::{Vec3, Vec3A};

use super::Mix;
use crate::boundary::Boundary;
use crate::certificate::Surfaces;
use crate::certificate::{Certificate, Places, certify};
use crate::run::Solved;
use crate::transfer::Binding;
use crate::view::{Body, Pose, ViewFrame};
use crate::voxel::blend;
use crate::voxel::{Complex, Dimension};

/// A solved domain before the camera.
pub struct Actor {
    boundary: Arc<Boundary>,
    complex: Arc<Complex>,
    binding: Arc<Binding>,
    surfaces: Surfaces,
    /// λ, node state and what was proven of it, by rising λ.
    keyframes: Vec<(f32, State, Certificate)>,
    rest: State,
    linear: State,
    importance: Arc<Vec<f32>>,
    node_importance: Arc<Vec<f32>>,
    proven: HashMap<Shot, Certificate>,
    /// Made when Eq. 1 alone is first shown.
    places: Option<Places>,
    /// What of Eq. 1 alone is faulty, by the bits of λ.
    faulty: HashMap<u32, Arc<Vec<u32>>>,
}

/// `[nodes]` in cells.
type State = Arc<Vec<Vec3A>>;

/// A state that is shown, exactly.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Shot {
    /// A blend of two keyframes and its bits.
    Certified(usize, usize, u32),
    /// Eq. 1 alone at the bits of λ.
    Classic(u32),
}

/// Vertices of a state that the camera is fitted to, about: enough that none sticks out by more than the margin.
const FITTED: usize = 4000;

impl Actor {
    /// Takes a solved domain; `boundary` is what is drawn of it.
    pub fn new(boundary: Arc<Boundary>, solved: Solved) -> Self {
        let Solved { complex, binding, surfaces, film, linear, importance, outcome, .. } = solved;
        let keyframe = |k: &crate::film::Keyframe| (k.lambda, Arc::new(k.positions.clone()), k.certificate.clone());
        Self {
            boundary,
            rest: Arc::new(complex.rest.clone()),
            complex,
            binding,
            surfaces,
            keyframes: film.keyframes().iter().map(keyframe).collect(),
            linear: Arc::new(linear),
            importance: Arc::new(outcome.importance),
            node_importance: Arc::new(importance),
            proven: HashMap::new(),
            places: None,
            faulty: HashMap::new(),
        }
    }

    /// `[keyframes]` λ, rising.
    pub fn lambdas(&self) -> Vec<f32> {
        self.keyframes.iter().map(|(lambda, ..)| *lambda).collect()
    }

    /// What is drawn.
    pub(crate) fn body(&self) -> Body {
        Body { boundary: self.boundary.clone(), complex: self.complex.clone(), binding: self.binding.clone() }
    }

    /// `[vertices]` importance.
    pub(crate) fn importance(&self) -> &Arc<Vec<f32>> {
        &self.importance
    }

    /// `[nodes]` importance.
    pub(super) fn node_importance(&self) -> &Arc<Vec<f32>> {
        &self.node_importance
    }

    /// The certified growth at a mix of keyframes.
    pub(crate) fn pose(&self, mix: Mix) -> Pose {
        let state = |k: usize| self.keyframes[k].1.clone();
        Pose { from: state(mix.from), to: state(mix.to), blend: mix.t }
    }

    /// Eq. 1 alone at λ.
    pub(crate) fn classic_pose(&self, lambda: f32) -> Pose {
        Pose { from: self.rest.clone(), to: self.linear.clone(), blend: lambda }
    }

    /// What is proven of the growth at a mix; checked once.
    pub(super) fn certificate(&mut self, mix: Mix) -> Certificate {
        if mix.t == 0.0 {
            return self.keyframes[mix.from].2.clone();
        }
        let pose = self.pose(mix);
        self.prove(Shot::Certified(mix.from, mix.to, mix.t.to_bits()), &pose)
    }

    /// What is proven of Eq. 1 alone at λ; checked once.
    pub(super) fn classic_certificate(&mut self, lambda: f32) -> Certificate {
        let pose = self.classic_pose(lambda);
        self.prove(Shot::Classic(lambda.to_bits()), &pose)
    }

    /// Triangles of the boundary that are faulty in Eq. 1 alone at λ, rising; found once. As
    /// many as it takes to be seen.
    pub(crate) fn classic_faults(&mut self, lambda: f32) -> Arc<Vec<u32>> {
        let pose = self.classic_pose(lambda);
        let state = blend(&pose.from, &pose.to, pose.blend);
        let places = self.places.get_or_insert_with(|| Places::new(&self.boundary, &self.complex));
        let (complex, surfaces) = (&self.complex, &self.surfaces);
        let find = || Arc::new(places.to_be_seen(complex, surfaces, &state));
        self.faulty.entry(lambda.to_bits()).or_insert_with(find).clone()
    }

    fn prove(&mut self, shot: Shot, pose: &Pose) -> Certificate {
        let (complex, surfaces) = (&self.complex, &self.surfaces);
        let check = || certify(complex, surfaces, &blend(&pose.from, &pose.to, pose.blend));
        self.proven.entry(shot).or_insert_with(check).clone()
    }

    /// Whether it is a picture.
    pub(super) fn is_picture(&self) -> bool {
        self.complex.dimension == Dimension::Two
    }

    /// Points of the surface in view space, standing on the floor, over all of the certified growth, and of Eq. 1 alone.
    pub(crate) fn reach(&self) -> [Vec<Vec3>; 2] {
        let points = |state: &State| self.surface(state);
        let certified = self.keyframes.iter().flat_map(|(_, state, _)| points(state)).collect();
        let classic = points(&self.rest).into_iter().chain(points(&self.linear)).collect();
        [certified, classic]
    }

    /// Some points of the surface in one state.
    fn surface(&self, state: &State) -> Vec<Vec3> {
        let frame = ViewFrame::of(&self.boundary);
        let mut points: Vec<Vec3> = self.binding.apply(state).into_iter().map(|p| frame.world_from_source(p)).collect();
        if !frame.is_flat {
            let lowest = points.iter().map(|p| p.y).fold(f32::INFINITY, f32::min);
            points.iter_mut().for_each(|p| p.y -= lowest);
        }
        if self.is_picture() {
            // Looked at straight on, it reaches as far as the box around it.
            let low = points.iter().copied().reduce(Vec3::min);
            return low.into_iter().chain(points.into_iter().reduce(Vec3::max)).collect();
        }
        let every = points.len().div_ceil(FITTED).max(1);
        points.into_iter().step_by(every).filter(|p| p.is_finite()).collect()
    }
}
