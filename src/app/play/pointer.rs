//! The pointer: turns, moves and zooms the view, paints.

use bevy::input::mouse::{MouseScrollUnit, MouseWheel};
use bevy::prelude::*;
use bevy::window::{CursorMoved, FileDragAndDrop};

use super::document::Document;
use super::present::Shown;
use super::sandbox::Sandbox;
use crate::paint::{Dab, Fill};
use crate::panel::{Tool, Wish};
use crate::view::{self, Body, Cursor, Hit, Orbit, Picker, Placement, Pose, Target, ViewFrame};

/// The part of the window that the view has, logical pixels.
#[derive(Resource, Debug, Clone, Copy, PartialEq)]
pub struct Viewport {
    /// Upper left corner.
    pub min: Vec2,
    /// Width and height.
    pub size: Vec2,
}

impl Default for Viewport {
    fn default() -> Self {
        Self { min: Vec2::ZERO, size: Vec2::new(1280.0, 720.0) }
    }
}

impl Viewport {
    /// A place of the window, from the middle of the view in its heights, y down.
    fn off_middle(&self, at: Vec2) -> Vec2 {
        (at - self.min - 0.5 * self.size) / self.size.y.max(1.0)
    }
}

/// Whether the pointer is on a panel, or a panel has it: then the view does not react.
#[derive(Resource, Debug, Clone, Copy, Default, PartialEq)]
pub struct PointerOnPanel(pub bool);

/// What a drag does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Drag {
    Orbit,
    Pan,
    Paint,
}

/// The pointer between frames.
#[derive(Default)]
pub(super) struct Pointer {
    at: Option<Vec2>,
    drag: Option<Drag>,
}

/// Radians for a drag across the height of the view.
const TURN: f32 = 3.6;

/// Between two dabs of a stroke, in radii: nearer ones differ too little to be worth their time.
const DAB_DISTANCE: f64 = 0.2;

type Painted<'a> = (Entity, &'a Body, Option<&'a Pose>, &'a Placement, &'a mut Picker, Option<&'a Cursor>);

#[expect(clippy::too_many_arguments, reason = "one for each thing a pointer meets")]
pub(super) fn handle(
    mut commands: Commands,
    mut pointer: Local<Pointer>,
    mut moves: MessageReader<CursorMoved>,
    mut wheels: MessageReader<MouseWheel>,
    buttons: Res<ButtonInput<MouseButton>>,
    keys: Res<ButtonInput<KeyCode>>,
    (viewport, on_panel): (Res<Viewport>, Res<PointerOnPanel>),
    mut sandbox: ResMut<Sandbox>,
    mut orbits: Query<&mut Orbit>,
    mut bodies: Query<Painted, With<Shown>>,
) {
    let Ok(mut orbit) = orbits.single_mut() else { return };
    let before = pointer.at;
    pointer.at = moves.read().last().map(|moved| moved.position).or(before);
    let Some(at) = pointer.at else { return };
    let moved = (at - before.unwrap_or(at)) / viewport.size.y.max(1.0);
    let place = viewport.off_middle(at);

    let turned: f32 =
        wheels.read().map(|wheel| if wheel.unit == MouseScrollUnit::Line { wheel.y } else { wheel.y / 40.0 }).sum();
    if turned != 0.0 && !on_panel.0 {
        orbit.zoom_to(1.15_f32.powf(turned), place);
    }

    let tool = sandbox.choice.tool;
    if !on_panel.0 && pointer.drag.is_none() {
        let is_shifted = keys.any_pressed([KeyCode::ShiftLeft, KeyCode::ShiftRight]);
        pointer.drag =
            if buttons.just_pressed(MouseButton::Middle) || (buttons.just_pressed(MouseButton::Left) && is_shifted) {
                Some(Drag::Pan)
            } else if buttons.just_pressed(MouseButton::Right)
                || (buttons.just_pressed(MouseButton::Left) && tool == Tool::Orbit)
            {
                Some(Drag::Orbit)
            } else if buttons.just_pressed(MouseButton::Left) {
                Some(Drag::Paint)
            } else {
                None
            };
    }
    let is_flat = sandbox.open.as_ref().is_some_and(Document::is_flat);
    if is_flat && pointer.drag == Some(Drag::Orbit) {
        pointer.drag = Some(Drag::Pan);
    }
    match pointer.drag {
        Some(Drag::Orbit) if moved != Vec2::ZERO => orbit.orbit(-TURN * moved.x, TURN * moved.y),
        Some(Drag::Pan) if moved != Vec2::ZERO => orbit.pan(moved),
        _ => {}
    }

    for (entity, body, pose, placement, mut picker, cursor) in &mut bodies {
        let is_over = tool != Tool::Orbit && !on_panel.0 && !matches!(pointer.drag, Some(Drag::Orbit | Drag::Pan));
        let hit =
            is_over.then(|| pick(&mut picker, body, pose, placement, orbit.ray(place), sandbox.choice.ghost)).flatten();
        if pointer.drag == Some(Drag::Paint) {
            let began = buttons.just_pressed(MouseButton::Left);
            touch(&mut sandbox, body, hit, began);
            if began && hit.is_none() {
                // Beside the surface there is nothing to paint: the drag turns the view.
                pointer.drag = Some(Drag::Orbit);
            }
        }
        show_brush(&mut commands, entity, cursor, &sandbox, body, hit.filter(|_| tool == Tool::Paint));
    }
    if !buttons.any_pressed([MouseButton::Left, MouseButton::Middle, MouseButton::Right])
        && pointer.drag.take().is_some()
        && let Some(open) = sandbox.open.as_mut().filter(|open| open.painting.is_painting())
    {
        open.painting.end();
    }
}

/// Files dropped on the window.
pub(super) fn drop_files(mut files: MessageReader<FileDragAndDrop>, mut sandbox: ResMut<Sandbox>) {
    for file in files.read() {
        if let FileDragAndDrop::DroppedFile { path_buf, .. } = file {
            sandbox.wishes.push(Wish::OpenPath(path_buf.clone()));
        }
    }
}

/// What lies under the pointer: the surface, or the ghost around it.
fn pick(
    picker: &mut Picker,
    body: &Body,
    pose: Option<&Pose>,
    placement: &Placement,
    ray: Ray3d,
    ghost: bool,
) -> Option<Hit> {
    let on_surface = picker.pick(body, pose, placement, ray, Target::Surface);
    on_surface.or_else(|| ghost.then(|| picker.pick(body, pose, placement, ray, Target::Rest)).flatten())
}

/// Radius of the brush, source units.
fn radius(sandbox: &Sandbox, body: &Body) -> f64 {
    let (low, high) = body.boundary.bounds().unwrap_or_default();
    f64::from(sandbox.choice.brush_size) * (high - low).max_element()
}

/// The left button is down while painting or filling.
fn touch(sandbox: &mut Sandbox, body: &Body, hit: Option<Hit>, began: bool) {
    let (Some(hit), radius) = (hit, radius(sandbox, body)) else { return };
    let (tool, brush, value) = (sandbox.choice.tool, sandbox.choice.brush, sandbox.choice.fill_value);
    if tool == Tool::Fill {
        if began {
            let place = ViewFrame::of(&body.boundary).source_from_world(hit.rest_position);
            let nearest = sandbox.open.as_ref().and_then(|open| open.painting.under().subject.vertex_at(place));
            let vertex = nearest.unwrap_or_else(|| body.boundary.triangles[hit.triangle as usize][0]);
            sandbox.wishes.push(Wish::Fill(Fill::Connected { vertex, value }));
        }
        return;
    }
    let Some(open) = &mut sandbox.open else { return };
    let centre = ViewFrame::of(&body.boundary).source_from_world(hit.rest_position);
    if began {
        open.painting.begin(brush);
    }
    if !open.painting.is_painting() {
        return;
    }
    let far = |last: Dab| (glam::DVec3::from_array(last.centre) - centre).length() > DAB_DISTANCE * last.radius;
    if open.painting.last_dab().is_none_or(far) {
        open.painting.dab(Dab { centre: centre.to_array(), radius });
    }
}

fn show_brush(
    commands: &mut Commands,
    entity: Entity,
    now: Option<&Cursor>,
    sandbox: &Sandbox,
    body: &Body,
    hit: Option<Hit>,
) {
    let Some((hit, open)) = hit.zip(sandbox.open.as_ref()) else {
        if now.is_some() {
            commands.entity(entity).remove::<Cursor>();
        }
        return;
    };
    let (frame, brush) = (ViewFrame::of(&body.boundary), sandbox.choice.brush);
    let centre = frame.source_from_world(hit.rest_position);
    let images = open.painting.canvas().images(centre, brush.mirror);
    let wanted = Cursor {
        at: Some(hit.rest_position),
        normal: hit.normal,
        radius: frame.world_length(radius(sandbox, body)),
        mirrored: images.iter().skip(1).map(|p| frame.world_from_source(*p)).collect(),
        dab: Some(view::Dab { value: brush.value, strength: brush.strength, softness: 1.0 }),
    };
    if now != Some(&wanted) {
        commands.entity(entity).insert(wanted);
    }
}
