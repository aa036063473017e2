//! The systems that bring components to the screen, once a frame, before assets and transforms are looked at.

use bevy::{
    asset::AssetEventSystems, camera::visibility::VisibilitySystems, prelude::*, render::storage::ShaderBuffer,
};

use super::{
    Body, Cursor, Extent, Ghost, Looks, Placement, Pose, Quality, Unhurried, ViewSystems,
    canvas::{Canvas, Easel},
    material::{MOST_BRUSHES, Shown, SurfaceMaterial},
    studio::ContactMaterial,
};

/// Orders the systems of [`ViewSystems::Present`].
pub(super) fn add_systems(app: &mut App) {
    app.configure_sets(
        PostUpdate,
        ViewSystems::Present
            .before(TransformSystems::Propagate)
            .before(VisibilitySystems::VisibilityPropagate)
            .before(VisibilitySystems::CalculateBounds)
            .before(AssetEventSystems),
    )
    .add_systems(PostUpdate, (prepare, place, dress, pose, measure, haunt, write).chain().in_set(ViewSystems::Present));
}

/// Everything a canvas is painted with.
#[derive(bevy::ecs::system::SystemParam)]
pub(super) struct Easels<'w> {
    meshes: ResMut<'w, Assets<Mesh>>,
    materials: ResMut<'w, Assets<SurfaceMaterial>>,
    contacts: ResMut<'w, Assets<ContactMaterial>>,
    images: ResMut<'w, Assets<Image>>,
    buffers: ResMut<'w, Assets<ShaderBuffer>>,
    quality: Res<'w, Quality>,
    unhurried: Option<ResMut<'w, Unhurried>>,
}

impl Easels<'_> {
    fn easel(&mut self) -> Easel<'_> {
        Easel {
            meshes: &mut self.meshes,
            materials: &mut self.materials,
            contacts: &mut self.contacts,
            images: &mut self.images,
            buffers: &mut self.buffers,
            quality: *self.quality,
            is_unhurried: self.unhurried.is_some(),
        }
    }
}

/// Puts new and replaced bodies on the GPU.
fn prepare(mut commands: Commands, bodies: Query<(Entity, &Body, Option<&Canvas>), Changed<Body>>, mut easels: Easels) {
    for (entity, body, old) in &bodies {
        for part in old.into_iter().flat_map(Canvas::entities) {
            commands.entity(part).despawn();
        }
        let canvas = Canvas::new(&mut commands, entity, body, &mut easels.easel());
        let frame = canvas.frame;
        commands.entity(entity).insert((canvas, frame));
    }
}

type Replaced = (With<Body>, Changed<Placement>);

fn place(mut bodies: Query<(&Placement, &mut Transform), Replaced>) {
    for (placement, mut transform) in &mut bodies {
        transform.translation = placement.offset;
    }
}

fn dress(mut commands: Commands, mut bodies: Query<(Entity, Ref<Body>, Ref<Looks>, &mut Canvas)>, mut easels: Easels) {
    for (entity, body, looks, mut canvas) in &mut bodies {
        if looks.is_changed() || body.is_changed() {
            canvas.dress(&mut commands, entity, &body, &looks, &mut easels.easel());
        }
    }
}

fn pose(mut bodies: Query<(&Body, Option<&Pose>, &mut Canvas)>, mut easels: Easels) {
    for (body, pose, mut canvas) in &mut bodies {
        let rest = canvas.rest.clone();
        let pose = pose.cloned().unwrap_or_else(|| Pose::still(rest));
        // A state of another complex would be read out of bounds.
        let fits = |state: &[glam::Vec3A]| state.len() == body.complex.nodes();
        if fits(&pose.from) && fits(&pose.to) {
            canvas.bind(body, &pose, &mut easels.easel());
        }
    }
    let is_waiting = bodies.iter().any(|(_, _, canvas)| canvas.is_waiting());
    if let Some(unhurried) = &mut easels.unhurried {
        let shown = bodies.iter().map(|(_, _, canvas)| canvas.shown_unhurried).sum();
        unhurried.set_if_neq(Unhurried { is_waiting, shown });
    }
}

/// Tells how far each body reaches.
pub(super) fn measure(mut commands: Commands, bodies: Query<(Entity, &Placement, &Canvas, Option<&Extent>)>) {
    for (entity, placement, canvas, known) in &bodies {
        let extent = canvas.extent.moved(placement.offset);
        if known != Some(&extent) {
            commands.entity(entity).insert(extent);
        }
    }
}

fn haunt(mut commands: Commands, mut bodies: Query<(Entity, Ref<Body>, Has<Ghost>, &mut Canvas)>, mut easels: Easels) {
    for (entity, body, is_wanted, mut canvas) in &mut bodies {
        if is_wanted && (canvas.ghost.is_empty() || body.is_changed()) {
            canvas.haunt(&mut commands, entity, &mut easels.easel());
        } else if !is_wanted {
            for part in canvas.ghost.drain(..) {
                commands.entity(part).despawn();
            }
        }
    }
}

/// What is written each frame.
type Written<'a> = (&'a Looks, Option<&'a Cursor>, Option<&'a Ghost>, &'a mut Canvas);

fn write(mut bodies: Query<Written>, mut buffers: ResMut<Assets<ShaderBuffer>>) {
    for (looks, cursor, ghost, mut canvas) in &mut bodies {
        let mut shown = Shown { blend: canvas.blend(), ..default() };
        if let Some(wipe) = looks.wipe {
            shown.wipe_at = wipe.at;
            shown.wipe_side = if wipe.keeps_left { 1.0 } else { -1.0 };
        }
        if let Some(cursor) = cursor {
            brush(&mut shown, cursor, looks);
        }
        let ghost = Shown { grown: 0.0, opacity: ghost.map_or(0.0, |ghost| ghost.opacity), ..shown.clone() };
        canvas.write(shown, ghost, &mut buffers);
    }
}

/// The brush and its mirror images, as the shader wants them.
fn brush(shown: &mut Shown, cursor: &Cursor, looks: &Looks) {
    let Some(at) = cursor.at else { return };
    let centres = std::iter::once(at).chain(cursor.mirrored.iter().copied());
    for (slot, centre) in shown.brush.iter_mut().zip(centres) {
        *slot = centre.extend(cursor.radius.max(1.0e-6));
    }
    shown.brushes = (1 + cursor.mirrored.len()).min(MOST_BRUSHES) as u32;
    // Dark enough on every colour of the maps' middle, light enough on their ends: a warm black.
    shown.ring_colour = Vec4::new(0.012, 0.012, 0.014, 1.0);
    if let Some(dab) = cursor.dab {
        shown.dab_colour = looks.colour(dab.value).to_vec4();
        shown.dab_strength = dab.strength.clamp(0.0, 1.0);
        shown.dab_softness = dab.softness.clamp(0.0, 1.0);
    }
}
