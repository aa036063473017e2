//! One state on the GPU: computed once, kept as long as the `Arc` that holds the state.

use std::sync::{Arc, Weak};

use bevy::{prelude::*, render::storage::ShaderBuffer};
use glam::Vec3A;
use rayon::prelude::*;

use super::{Body, Extent, ViewFrame, contact, drawn::Rows, normals};

/// Vertices per parallel task.
const VERTICES_PER_TASK: usize = 4096;

/// Buffers of one state.
pub(super) struct State {
    /// Whose. The memory of a weak pointer is not given to another, so its address is its name.
    state: Weak<Vec<Vec3A>>,
    /// Displacements and normals of the surface's rows.
    pub surface: Sheet,
    /// The same for the blocks, once they are shown.
    pub blocks: Option<Sheet>,
    /// What the body takes of the room's light from the floor.
    pub shade: Handle<ShaderBuffer>,
    /// Box around the surface, without the placement.
    pub extent: Extent,
    /// Added to y so that the body stands on the floor.
    lift: f32,
}

/// What is drawn of a state, not on the GPU yet.
pub(super) struct Computed {
    nodes: ShaderBuffer,
    normals: ShaderBuffer,
    shade: ShaderBuffer,
    extent: Extent,
    lift: f32,
}

/// What the shader pulls from.
#[derive(Clone)]
pub(super) struct Sheet {
    pub nodes: Handle<ShaderBuffer>,
    pub normals: Handle<ShaderBuffer>,
}

/// Where a body's surface is in one state.
pub(super) struct Placed {
    /// `[vertices]`, view space, lifted.
    pub positions: Vec<Vec3A>,
    /// What y was lifted by.
    pub lift: f32,
}

/// `[vertices]` of a body in a state, view space, standing on the floor.
pub(super) fn placed(body: &Body, frame: &ViewFrame, state: &[Vec3A]) -> Placed {
    placed_by(body, frame, &body.binding.displacements(state))
}

/// The same from displacements of the halved lattice's nodes.
fn placed_by(body: &Body, frame: &ViewFrame, displacements: &[Vec3A]) -> Placed {
    let to_view = frame.world_length(body.complex.grid.cell_size);
    let rest = &body.boundary.positions;
    let mut positions: Vec<Vec3A> = (0..rest.len())
        .into_par_iter()
        .with_min_len(VERTICES_PER_TASK)
        .map(|v| {
            let carried = body.binding.nodes[v].iter().zip(&body.binding.weights[v]);
            let moved: Vec3A = carried.map(|(&i, &w)| w * displacements[i as usize]).sum();
            Vec3A::from(frame.world_from_source(rest[v])) + to_view * moved
        })
        .collect();
    let lift = if frame.is_flat { 0.0 } else { -lowest(body, &positions) };
    positions.iter_mut().for_each(|p| p.y += lift);
    Placed { positions, lift }
}

/// The box around a body in some states, view space, without a placement: what a camera frames to see a whole film.
///
/// States of another complex than the body's are left out; of no states at all it is a box of side 2.
pub fn extent<'a>(body: &Body, states: impl IntoIterator<Item = &'a [Vec3A]>) -> Extent {
    let frame = ViewFrame::of(&body.boundary);
    let fitting = states.into_iter().filter(|state| state.len() == body.complex.nodes());
    let boxes = fitting.map(|state| extent_of(body, &placed(body, &frame, state).positions));
    boxes.reduce(Extent::union).unwrap_or(Extent { low: Vec3::NEG_ONE, high: Vec3::ONE })
}

fn extent_of(body: &Body, positions: &[Vec3A]) -> Extent {
    let used = body.boundary.triangles.iter().flatten().map(|&v| positions[v as usize]);
    let (low, high) = used.fold((Vec3A::INFINITY, Vec3A::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    Extent { low: low.into(), high: high.into() }
}

/// The lowest y of what triangles use.
fn lowest(body: &Body, positions: &[Vec3A]) -> f32 {
    let lowest =
        body.boundary.triangles.iter().flatten().map(|&v| positions[v as usize].y).fold(f32::INFINITY, f32::min);
    if lowest.is_finite() { lowest } else { 0.0 }
}

impl Computed {
    /// Computes what the shaders need to draw a state.
    pub fn new(body: &Body, frame: &ViewFrame, rows: &Rows, state: &[Vec3A]) -> Self {
        let displacements = body.binding.displacements(state);
        let Placed { positions, lift } = placed_by(body, frame, &displacements);
        let gradients = normals::gradients(&body.complex, state);
        Self {
            nodes: view_displacements(body, frame, &displacements, &rows.used, lift),
            normals: ShaderBuffer::from(rows.normals_in(body, &gradients)),
            shade: ShaderBuffer::from(contact::shade(&body.boundary.triangles, &positions)),
            extent: extent_of(body, &positions),
            lift,
        }
    }
}

impl State {
    /// Whether this is the state of an `Arc`.
    pub fn is_of(&self, state: &Arc<Vec<Vec3A>>) -> bool {
        std::ptr::eq(self.state.as_ptr(), Arc::as_ptr(state))
    }

    /// Whether anyone still holds the state.
    pub fn is_alive(&self) -> bool {
        self.state.strong_count() > 0
    }

    /// Gives what was computed of a state to the GPU.
    pub fn new(state: &Arc<Vec<Vec3A>>, computed: Computed, buffers: &mut Assets<ShaderBuffer>) -> Self {
        let Computed { nodes, normals, shade, extent, lift } = computed;
        Self {
            state: Arc::downgrade(state),
            surface: Sheet { nodes: buffers.add(nodes), normals: buffers.add(normals) },
            blocks: None,
            shade: buffers.add(shade),
            extent,
            lift,
        }
    }

    /// Adds what the blocks need, if it is not there yet. `normals` is never read.
    pub fn add_blocks(
        &mut self,
        body: &Body,
        frame: &ViewFrame,
        rows: &Rows,
        state: &[Vec3A],
        normals: &Handle<ShaderBuffer>,
        buffers: &mut Assets<ShaderBuffer>,
    ) {
        if self.blocks.is_some() {
            return;
        }
        let displacements: Vec<Vec3A> = state.iter().zip(&body.complex.rest).map(|(p, rest)| *p - *rest).collect();
        let nodes = buffers.add(view_displacements(body, frame, &displacements, &rows.used, self.lift));
        self.blocks = Some(Sheet { nodes, normals: normals.clone() });
    }
}

/// `[used]` displacements in view space, lifted, padded to four numbers.
fn view_displacements(body: &Body, frame: &ViewFrame, cells: &[Vec3A], used: &[u32], lift: f32) -> ShaderBuffer {
    let to_view = frame.world_length(body.complex.grid.cell_size);
    let displacement = |&node: &u32| (to_view * cells[node as usize] + lift * Vec3A::Y).extend(0.0);
    let all: Vec<Vec4> = used.iter().map(displacement).collect();
    ShaderBuffer::from(if all.is_empty() { vec![Vec4::ZERO] } else { all })
}
