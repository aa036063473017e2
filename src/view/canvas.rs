//! A body on the GPU: its parts, their materials, and the states computed so far.

use std::sync::Arc;

use bevy::{camera::visibility::NoFrustumCulling, light::NotShadowCaster, prelude::*, render::storage::ShaderBuffer};
use glam::Vec3A;

use super::{
    Body, Extent, Looks, Mode, Pose, Quality, ViewFrame,
    awaited::Awaited,
    colours::ENTRIES,
    contact::REACH,
    drawn::{Part, Rows},
    file_materials::FileMaterial,
    material::{Coat, Shown, SurfaceMaterial, Variant},
    state::{Computed, Sheet, State},
    studio::{ContactMaterial, FloorPlane},
};
use crate::voxel::Dimension;

/// What the view keeps of a body, beside its [`Body`].
#[derive(Component)]
pub(super) struct Canvas {
    pub frame: ViewFrame,
    /// What the body shows now; written where it changes.
    pub written: Shown,
    shown: Handle<ShaderBuffer>,
    /// The same for its ghost.
    pub ghost_written: Shown,
    ghost_shown: Handle<ShaderBuffer>,
    surface: Layer,
    blocks: Option<Layer>,
    pub ghost: Vec<Entity>,
    contact: Option<(Entity, Handle<ContactMaterial>)>,
    states: Vec<State>,
    /// The state at rest, for a body without pose.
    pub rest: Arc<Vec<Vec3A>>,
    /// What is shown.
    bound: Pose,
    /// Whether what is shown was asked for: at first it is the rest shape.
    was_posed: bool,
    /// What will be, as soon as it is computed.
    awaited: Option<Awaited>,
    /// How many were.
    pub shown_unhurried: u64,
    nothing: Handle<ShaderBuffer>,
    colour_map: Handle<ShaderBuffer>,
    /// Box around what is drawn, without the placement.
    pub extent: Extent,
}

/// Rows with their buffers, and the parts drawn from them.
struct Layer {
    rows: Arc<Rows>,
    parts: Vec<DrawnPart>,
}

struct DrawnPart {
    entity: Entity,
    mesh: Handle<Mesh>,
    material: Handle<SurfaceMaterial>,
    /// As the file has it.
    own: Variant,
    own_alpha: AlphaMode,
    /// Whether its alpha counts whatever is shown on it: a picture's outline is its own.
    keeps_alpha: bool,
}

/// The assets a canvas is made of.
pub(super) struct Easel<'a> {
    pub meshes: &'a mut Assets<Mesh>,
    pub materials: &'a mut Assets<SurfaceMaterial>,
    pub contacts: &'a mut Assets<ContactMaterial>,
    pub images: &'a mut Assets<Image>,
    pub buffers: &'a mut Assets<ShaderBuffer>,
    pub quality: Quality,
    /// Whether new states are computed beside the frames.
    pub is_unhurried: bool,
}

impl Canvas {
    /// Puts a body on the GPU, at rest, and spawns its parts below its entity.
    pub fn new(commands: &mut Commands, entity: Entity, body: &Body, easel: &mut Easel) -> Self {
        let frame = ViewFrame::of(&body.boundary);
        let (rows, parts) = Rows::of_surface(body, &frame);
        let rest = Arc::new(body.complex.rest.clone());
        let state = State::new(&rest, Computed::new(body, &frame, &rows, &rest), easel.buffers);
        let nothing = easel.buffers.add(ShaderBuffer::from(vec![Vec4::ZERO]));
        let mut canvas = Self {
            frame,
            written: Shown::default(),
            shown: easel.buffers.add(ShaderBuffer::from(Shown::default())),
            ghost_written: Shown::default(),
            ghost_shown: easel.buffers.add(ShaderBuffer::from(Shown { grown: 0.0, ..default() })),
            surface: Layer { rows: Arc::new(rows), parts: Vec::new() },
            blocks: None,
            ghost: Vec::new(),
            contact: None,
            extent: state.extent,
            states: vec![state],
            bound: Pose::still(rest.clone()),
            was_posed: false,
            awaited: None,
            shown_unhurried: 0,
            rest,
            colour_map: nothing.clone(),
            nothing,
        };
        let carriers = easel.buffers.add(ShaderBuffer::from(canvas.surface.rows.carriers.clone()));
        let sheet = canvas.states[0].surface.clone();
        let has_colours = body.boundary.base_colours().is_some();
        for part in parts {
            let file = FileMaterial::new(body, part.material, has_colours, easel.images);
            let drawn = canvas.spawn(commands, entity, part, file, &carriers, &sheet, easel);
            canvas.surface.parts.push(drawn);
        }
        if !frame.is_flat {
            canvas.spawn_contact(commands, entity, easel);
        }
        canvas
    }

    #[expect(clippy::too_many_arguments, reason = "the pieces of one draw call")]
    fn spawn(
        &self,
        commands: &mut Commands,
        body: Entity,
        part: Part,
        file: FileMaterial,
        carriers: &Handle<ShaderBuffer>,
        sheet: &Sheet,
        easel: &mut Easel,
    ) -> DrawnPart {
        let has_uvs = part.mesh.contains_attribute(Mesh::ATTRIBUTE_UV_0);
        let own = Variant {
            is_textured: file.texture.is_some() && has_uvs,
            is_masked: matches!(file.alpha_mode, AlphaMode::Mask(_)),
            is_unlit: file.is_unlit || self.frame.is_flat,
            is_flat: file.is_picture,
            shadow_taps: easel.quality.shadow_taps(),
            ..default()
        };
        let material = easel.materials.add(SurfaceMaterial {
            shown: self.shown.clone(),
            carriers: carriers.clone(),
            from_nodes: sheet.nodes.clone(),
            to_nodes: sheet.nodes.clone(),
            from_normals: sheet.normals.clone(),
            to_normals: sheet.normals.clone(),
            field: self.nothing.clone(),
            colour_map: self.nothing.clone(),
            texture: file.texture,
            base: super::material::Base { first_row: part.first_row, ..file.base },
            alpha_mode: file.alpha_mode,
            variant: own,
        });
        let mesh = easel.meshes.add(part.mesh);
        let drawn = (Mesh3d(mesh.clone()), MeshMaterial3d(material.clone()), NoFrustumCulling, ChildOf(body));
        let entity = commands.spawn(drawn).id();
        if file.is_picture {
            commands.entity(entity).insert(NotShadowCaster);
        }
        DrawnPart { entity, mesh, material, own, own_alpha: file.alpha_mode, keeps_alpha: file.is_picture }
    }

    fn spawn_contact(&mut self, commands: &mut Commands, body: Entity, easel: &mut Easel) {
        let shade = self.states[0].shade.clone();
        let material = easel.contacts.add(ContactMaterial {
            shown: self.shown.clone(),
            from_shade: shade.clone(),
            to_shade: shade,
        });
        let mesh = easel.meshes.add(Plane3d::new(Vec3::Y, Vec2::splat(REACH)).mesh());
        let drawn = (
            Mesh3d(mesh),
            MeshMaterial3d(material.clone()),
            FloorPlane,
            Transform::from_xyz(0.0, -1.0e-3, 0.0),
            NotShadowCaster,
            NoFrustumCulling,
            ChildOf(body),
        );
        self.contact = Some((commands.spawn(drawn).id(), material));
    }

    /// The parts' entities, to be despawned with them.
    pub fn entities(&self) -> impl Iterator<Item = Entity> + '_ {
        let layers = std::iter::once(&self.surface).chain(&self.blocks);
        let parts = layers.flat_map(|layer| layer.parts.iter().map(|part| part.entity));
        parts.chain(self.ghost.iter().copied()).chain(self.contact.iter().map(|c| c.0))
    }

    /// The blocks, made when they are first asked for.
    fn blocks(&mut self, commands: &mut Commands, entity: Entity, body: &Body, easel: &mut Easel) {
        if self.blocks.is_some() {
            return;
        }
        let (rows, part) = match body.complex.dimension {
            Dimension::Two => Rows::of_squares(&body.complex, &self.frame),
            Dimension::Three => Rows::of_blocks(&body.complex, &self.frame),
        };
        let carriers = easel.buffers.add(ShaderBuffer::from(rows.carriers.clone()));
        let mut file = FileMaterial::new(body, part.material, false, easel.images);
        file.base.roughness = 0.8;
        let sheet = Sheet { nodes: self.nothing.clone(), normals: self.nothing.clone() };
        let mut drawn = self.spawn(commands, entity, part, file, &carriers, &sheet, easel);
        drawn.own.is_block = true;
        drawn.own.is_unlit = false;
        self.blocks = Some(Layer { rows: Arc::new(rows), parts: vec![drawn] });
    }

    /// Shows a pose: finds or computes what the shaders need of it, and binds it. Unhurried, it is shown when that is
    /// computed, and what was shown stays until then; a body that comes grown is shown so at once, never at rest before.
    pub fn bind(&mut self, body: &Body, wanted: &Pose, easel: &mut Easel) {
        self.states.retain(State::is_alive);
        if let Some(finished) = self.awaited.as_mut().and_then(Awaited::finished) {
            for (state, computed) in finished {
                self.states.push(State::new(&state, computed, easel.buffers));
            }
            if let Some(awaited) = self.awaited.take() {
                self.shown_unhurried += 1;
                self.bound = awaited.pose;
            }
        }
        if self.awaited.is_none() {
            let is_known = |state: &Arc<Vec<Vec3A>>| self.states.iter().any(|s| s.is_of(state));
            let is_hurried = !easel.is_unhurried || !std::mem::replace(&mut self.was_posed, true);
            if is_hurried || (is_known(&wanted.from) && is_known(&wanted.to)) {
                self.bound = wanted.clone();
            } else {
                self.awaited = Some(Awaited::begin(body, self.frame, &self.surface.rows, wanted, is_known));
            }
        }
        if Arc::ptr_eq(&self.bound.from, &wanted.from) && Arc::ptr_eq(&self.bound.to, &wanted.to) {
            self.bound.blend = wanted.blend;
        }
        self.attach(body, easel);
    }

    /// Between which states the shown one lies, 0..=1.
    pub fn blend(&self) -> f32 {
        self.bound.blend.clamp(0.0, 1.0)
    }

    /// Whether something else is to be shown than what is.
    pub fn is_waiting(&self) -> bool {
        self.awaited.is_some()
    }

    /// Binds what is to be shown.
    fn attach(&mut self, body: &Body, easel: &mut Easel) {
        let Pose { from, to, .. } = self.bound.clone();
        let pair = [&from, &to].map(|state| self.state(body, state, easel));
        let [from, to] = pair.map(|k| &self.states[k]);
        self.extent = from.extent.union(to.extent);
        let layers = std::iter::once((&self.surface, false)).chain(self.blocks.as_ref().map(|layer| (layer, true)));
        for (layer, is_blocks) in layers {
            let sheet = |state: &State| if is_blocks { state.blocks.clone() } else { Some(state.surface.clone()) };
            let (Some(from), Some(to)) = (sheet(from), sheet(to)) else { continue };
            for part in &layer.parts {
                let is_bound = easel
                    .materials
                    .get(&part.material)
                    .is_some_and(|material| material.from_nodes == from.nodes && material.to_nodes == to.nodes);
                if is_bound {
                    continue;
                }
                if let Some(mut material) = easel.materials.get_mut(&part.material) {
                    material.from_nodes = from.nodes.clone();
                    material.to_nodes = to.nodes.clone();
                    material.from_normals = from.normals.clone();
                    material.to_normals = to.normals.clone();
                }
            }
        }
        let Some((_, contact)) = &self.contact else { return };
        let is_bound = easel
            .contacts
            .get(contact)
            .is_some_and(|material| material.from_shade == from.shade && material.to_shade == to.shade);
        if !is_bound && let Some(mut material) = easel.contacts.get_mut(contact) {
            material.from_shade = from.shade.clone();
            material.to_shade = to.shade.clone();
        }
    }

    /// Index of a state, computed if it is new.
    fn state(&mut self, body: &Body, state: &Arc<Vec<Vec3A>>, easel: &mut Easel) -> usize {
        let known = self.states.iter().position(|s| s.is_of(state));
        let k = known.unwrap_or_else(|| {
            let computed = Computed::new(body, &self.frame, &self.surface.rows, state);
            self.states.push(State::new(state, computed, easel.buffers));
            self.states.len() - 1
        });
        if let Some(layer) = &self.blocks {
            self.states[k].add_blocks(body, &self.frame, &layer.rows, state, &self.nothing, easel.buffers);
        }
        k
    }

    /// Dresses the parts: field, colour map, marks, wipe.
    pub fn dress(&mut self, commands: &mut Commands, entity: Entity, body: &Body, looks: &Looks, easel: &mut Easel) {
        let has_blocks = matches!(looks.mode, Mode::Voxels(_));
        if has_blocks {
            self.blocks(commands, entity, body, easel);
        }
        let mapped = looks.mapped();
        if let Some((_, _, map)) = mapped {
            let entries: Vec<Vec4> = map.iter().map(|colour| colour.to_vec4()).collect();
            debug_assert_eq!(entries.len(), ENTRIES);
            self.colour_map = easel.buffers.add(ShaderBuffer::from(entries));
        }
        let shown = if has_blocks { self.blocks.as_ref() } else { Some(&self.surface) };
        let field = shown.and_then(|layer| field(&layer.rows, body, looks, has_blocks));
        let buffer = field.map(|field| easel.buffers.add(ShaderBuffer::from(field)));
        let layers = std::iter::once((&self.surface, false)).chain(self.blocks.as_ref().map(|layer| (layer, true)));
        for (layer, is_blocks) in layers {
            let is_shown = is_blocks == has_blocks;
            for part in &layer.parts {
                commands.entity(part.entity).insert(if is_shown { Visibility::Inherited } else { Visibility::Hidden });
                // Of two bodies in one place one casts the shadow on the floor; pictures cast none.
                if part.keeps_alpha || looks.wipe.is_some_and(|wipe| wipe.keeps_left) {
                    commands.entity(part.entity).insert(NotShadowCaster);
                } else {
                    commands.entity(part.entity).remove::<NotShadowCaster>();
                }
                let Some(mut material) = easel.materials.get_mut(&part.material).filter(|_| is_shown) else { continue };
                material.variant = Variant {
                    coat: if mapped.is_some() { Coat::Mapped } else { Coat::Own },
                    has_field: buffer.is_some(),
                    is_wiped: looks.wipe.is_some(),
                    is_unlit: part.own.is_unlit && mapped.is_none(),
                    ..part.own
                };
                // A field is shown on all of the surface, however transparent the file has it.
                let is_opaque = mapped.is_some() && !part.keeps_alpha;
                material.alpha_mode = if is_opaque { AlphaMode::Opaque } else { part.own_alpha };
                material.field = buffer.clone().unwrap_or_else(|| self.nothing.clone());
                material.colour_map = self.colour_map.clone();
            }
        }
    }

    /// Spawns the ghost: the surface again, at rest, of glass.
    pub fn haunt(&mut self, commands: &mut Commands, body: Entity, easel: &mut Easel) {
        for part in &self.surface.parts {
            let Some(mut material) = easel.materials.get(&part.material).cloned() else { continue };
            material.shown = self.ghost_shown.clone();
            let coat = Coat::Ghost;
            // A picture's ghost is the picture, before it: behind what has grown nothing of it would be seen.
            let (alpha_mode, variant, before) = if part.own.is_flat {
                (AlphaMode::Premultiplied, Variant { coat, ..part.own }, 0.01)
            } else {
                let shadow_taps = part.own.shadow_taps;
                (AlphaMode::Blend, Variant { coat, is_one_sided: true, shadow_taps, ..default() }, 0.0)
            };
            (material.alpha_mode, material.variant) = (alpha_mode, variant);
            let drawn = (
                Transform::from_xyz(0.0, 0.0, before),
                Mesh3d(part.mesh.clone()),
                MeshMaterial3d(easel.materials.add(material)),
                NoFrustumCulling,
                NotShadowCaster,
                ChildOf(body),
            );
            self.ghost.push(commands.spawn(drawn).id());
        }
    }

    /// Writes what is shown, if it is not what was written last.
    pub fn write(&mut self, shown: Shown, ghost: Shown, buffers: &mut Assets<ShaderBuffer>) {
        if shown != self.written
            && let Some(mut buffer) = buffers.get_mut(&self.shown)
        {
            buffer.set_data(shown.clone());
            self.written = shown;
        }
        if ghost != self.ghost_written
            && let Some(mut buffer) = buffers.get_mut(&self.ghost_shown)
        {
            buffer.set_data(ghost.clone());
            self.ghost_written = ghost;
        }
    }
}

/// `[rows]` place on the colour map and mark; `None` where nothing needs it.
fn field(rows: &Rows, body: &Body, looks: &Looks, is_blocks: bool) -> Option<Vec<Vec2>> {
    let mapped = looks.mapped();
    let marked = looks.marked.as_ref().filter(|marked| !marked.is_empty() && !is_blocks);
    if mapped.is_none() && marked.is_none() {
        return None;
    }
    let mut marks = vec![0.0; if marked.is_some() { body.boundary.positions.len() } else { 0 }];
    let triangles = marked.into_iter().flat_map(|marked| marked.iter());
    for vertex in triangles.filter_map(|&t| body.boundary.triangles.get(t as usize)).flatten() {
        marks[*vertex as usize] = 1.0;
    }
    let value = |origin: u32| {
        let place = mapped
            .map_or(0.5, |(values, scale, _)| values.get(origin as usize).map_or(0.5, |&value| scale.place(value)));
        Vec2::new(place, marks.get(origin as usize).copied().unwrap_or(0.0))
    };
    let mut field: Vec<Vec2> = rows.origin.iter().map(|&origin| value(origin)).collect();
    if is_blocks {
        // A block has one colour on each of its faces.
        for face in field.chunks_mut(4) {
            let mean = face.iter().sum::<Vec2>() / face.len() as f32;
            face.fill(mean);
        }
    }
    Some(field)
}
