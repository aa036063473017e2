//! What lies under the pointer.

use std::sync::{Arc, Weak};

use bevy::prelude::*;
use glam::Vec3A;
use rayon::prelude::*;

use super::{Body, Placement, Pose, ViewFrame, state::placed};
use crate::boundary::Boundary;
use crate::certificate::{Bounds, Posed, Tree};

/// Vertices per parallel task.
const VERTICES_PER_TASK: usize = 8192;

/// Which shape a ray looks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Target {
    /// The surface as it is drawn.
    #[default]
    Surface,
    /// The rest shape: the ghost.
    Rest,
}

/// Where a ray first meets a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Index into the boundary's triangles.
    pub triangle: u32,
    /// Weights of its corners, each in 0..=1, summing to 1.
    pub barycentric: [f32; 3],
    /// The same place of the rest shape, view space **without** the placement's offset: what [`Cursor`](super::Cursor) wants;
    /// [`ViewFrame::source_from_world`] of it is where a brush stroke goes.
    pub rest_position: Vec3,
    /// Where the ray met the surface it looked for, view space.
    pub position: Vec3,
    /// Unit normal of the triangle there, towards the outside.
    pub normal: Vec3,
    /// Along the ray, view units.
    pub distance: f32,
}

/// Finds what a ray meets; keeps its trees and the present state between calls. Every [`Body`] has one.
#[derive(Component, Default)]
pub struct Picker {
    /// Whose shapes are kept.
    boundary: Weak<Boundary>,
    rest: Option<Arc<RestShape>>,
    posed: Option<Shape>,
    /// `[vertices]` of states seen lately.
    states: Vec<(Weak<Vec<Vec3A>>, Vec<Vec3A>)>,
    /// What `posed` holds.
    pose: Option<Held>,
}

/// A pose, without holding its states: from, to, blend.
type Held = (Weak<Vec<Vec3A>>, Weak<Vec<Vec3A>>, f32);

/// A boundary at rest with the boxes around its triangles: some fifty milliseconds for 150,000 triangles, so whoever reads
/// a file makes it there, and nobody waits for it at the first click.
pub struct RestShape(Shape);

impl RestShape {
    /// Of a boundary, which is to be picked in the [`ViewFrame`] of the same.
    pub fn new(boundary: &Boundary) -> Self {
        let frame = ViewFrame::of(boundary);
        let at = |p: &glam::DVec3| Vec3A::from(frame.world_from_source(*p));
        Self(Shape::new(&boundary.triangles, boundary.positions.par_iter().map(at).collect()))
    }
}

/// A surface and the boxes around its triangles.
struct Shape {
    positions: Vec<Vec3A>,
    tree: Tree,
    boxes: Posed,
}

/// States whose vertices are kept: the two of a pose and the two before.
const MOST_STATES: usize = 4;

impl Picker {
    /// One that need not look at the boundary any more.
    pub fn prepared(boundary: &Arc<Boundary>, rest: Arc<RestShape>) -> Self {
        Self { boundary: Arc::downgrade(boundary), rest: Some(rest), ..Self::default() }
    }

    /// The nearest triangle along a ray in view space, seen from either side. The first call for a new state costs a few
    /// milliseconds for 100,000 triangles, further ones microseconds.
    pub fn pick(
        &mut self,
        body: &Body,
        pose: Option<&Pose>,
        placement: &Placement,
        ray: Ray3d,
        target: Target,
    ) -> Option<Hit> {
        let origin = Vec3A::from(ray.origin - placement.offset);
        let direction = Vec3A::from(ray.direction.as_vec3());
        let frame = ViewFrame::of(&body.boundary);
        let triangles = &body.boundary.triangles;
        if !std::ptr::eq(self.boundary.as_ptr(), Arc::as_ptr(&body.boundary)) {
            *self = Self { boundary: Arc::downgrade(&body.boundary), ..Self::default() };
        }
        let rest = self.rest.get_or_insert_with(|| Arc::new(RestShape::new(&body.boundary))).clone();
        let rest = &rest.0;
        let posed = pose.filter(|_| target == Target::Surface).and_then(|pose| self.follow(body, &frame, rest, pose));
        let shape = posed.unwrap_or(rest);
        let corners = |t: u32, positions: &[Vec3A]| triangles[t as usize].map(|v| positions[v as usize]);
        let (triangle, distance) = shape.tree.first_along(&shape.boxes, origin, direction, |t| {
            meet(origin, direction, corners(t, &shape.positions)).map(|(distance, _)| distance)
        })?;
        let [a, b, c] = corners(triangle, &shape.positions);
        let (_, barycentric) = meet(origin, direction, [a, b, c])?;
        let at_rest = corners(triangle, &rest.positions);
        let rest_position: Vec3A = barycentric.iter().zip(at_rest).map(|(&w, p)| w * p).sum();
        Some(Hit {
            triangle,
            barycentric,
            rest_position: rest_position.into(),
            position: Vec3::from(origin + distance * direction) + placement.offset,
            normal: (b - a).cross(c - a).normalize_or_zero().into(),
            distance,
        })
    }

    /// The shape in a pose; `None` for states of another complex.
    fn follow(&mut self, body: &Body, frame: &ViewFrame, rest: &Shape, pose: &Pose) -> Option<&Shape> {
        let is = |weak: &Weak<Vec<Vec3A>>, state: &Arc<Vec<Vec3A>>| std::ptr::eq(weak.as_ptr(), Arc::as_ptr(state));
        let same = |(from, to, blend): &Held| is(from, &pose.from) && is(to, &pose.to) && *blend == pose.blend;
        if self.pose.as_ref().is_some_and(same) {
            return self.posed.as_ref();
        }
        if pose.from.len() != body.complex.nodes() || pose.to.len() != body.complex.nodes() {
            return None;
        }
        for state in [&pose.from, &pose.to] {
            if !self.states.iter().any(|(weak, _)| is(weak, state)) {
                self.states.retain(|(weak, _)| weak.strong_count() > 0);
                if self.states.len() >= MOST_STATES {
                    self.states.remove(0);
                }
                self.states.push((Arc::downgrade(state), placed(body, frame, state).positions));
            }
        }
        let find = |state| self.states.iter().find(|(weak, _)| is(weak, state)).map(|(_, positions)| positions);
        let (from, to) = (find(&pose.from)?, find(&pose.to)?);
        let blend = pose.blend.clamp(0.0, 1.0);
        let blended = from.par_iter().zip(to).with_min_len(VERTICES_PER_TASK).map(|(a, b)| a.lerp(*b, blend));
        match &mut self.posed {
            Some(shape) => {
                blended.collect_into_vec(&mut shape.positions);
                shape.refit(&body.boundary.triangles);
            }
            None => {
                // The order of the rest shape is as good: neighbours stay neighbours.
                let mut shape =
                    Shape { positions: blended.collect(), tree: rest.tree.clone(), boxes: Posed::default() };
                shape.refit(&body.boundary.triangles);
                self.posed = Some(shape);
            }
        }
        self.pose = Some((Arc::downgrade(&pose.from), Arc::downgrade(&pose.to), pose.blend));
        self.posed.as_ref()
    }
}

impl Shape {
    fn new(triangles: &[[u32; 3]], positions: Vec<Vec3A>) -> Self {
        let centre = |t: &[u32; 3]| t.map(|v| positions[v as usize]).into_iter().sum::<Vec3A>() / 3.0;
        let centres: Vec<Vec3A> = triangles.par_iter().map(centre).collect();
        let tree = Tree::new(&centres);
        let mut shape = Self { positions, tree, boxes: Posed::default() };
        shape.refit(triangles);
        shape
    }

    fn refit(&mut self, triangles: &[[u32; 3]]) {
        let positions = &self.positions;
        self.boxes = self.tree.posed(|t| Bounds::of(triangles[t as usize].map(|v| positions[v as usize])));
    }
}

/// Where a ray meets a triangle and with which weights (Möller and Trumbore 1997), from either side.
fn meet(origin: Vec3A, direction: Vec3A, [a, b, c]: [Vec3A; 3]) -> Option<(f32, [f32; 3])> {
    let (ab, ac) = (b - a, c - a);
    let across = direction.cross(ac);
    let determinant = ab.dot(across);
    if determinant == 0.0 {
        return None;
    }
    let from = (origin - a) / determinant;
    let u = from.dot(across);
    let normal = from.cross(ab);
    let v = direction.dot(normal);
    let distance = ac.dot(normal);
    // Not a number fails each of these.
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance >= 0.0).then_some((distance, [1.0 - u - v, u, v]))
}
