//! The studio: key, fill and rim lights, a background without horizon, a floor that only catches shadows.

use bevy::{
    asset::RenderAssetUsages,
    camera::visibility::NoFrustumCulling,
    light::{CascadeShadowConfigBuilder, DirectionalLightShadowMap, NotShadowCaster, NotShadowReceiver},
    mesh::{MeshVertexBufferLayoutRef, PrimitiveTopology},
    pbr::{MaterialPipeline, MaterialPipelineKey},
    prelude::*,
    render::{
        render_resource::{AsBindGroup, RenderPipelineDescriptor, ShaderType, SpecializedMeshPipelineError},
        storage::ShaderBuffer,
    },
    shader::{ShaderDefVal, ShaderRef},
};

use super::{
    Body, Extent, Orbit, Quality, ViewSystems, contact,
    material::{BACKDROP_SHADER, CONTACT_SHADER, FLOOR_SHADER},
    present::measure,
};

/// What stands around the bodies. A resource; change it at any time.
#[derive(Resource, Debug, Clone, PartialEq)]
pub struct Studio {
    /// Behind everything.
    pub backdrop: Backdrop,
    /// Whether shadows fall on a floor at y = 0. Off for pictures.
    pub floor: bool,
}

/// Behind everything.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Backdrop {
    /// Very light grey, a little darker towards the rim.
    #[default]
    Studio,
    /// One sRGB colour.
    Plain([u8; 3]),
    /// Nothing: alpha 0 where no body is; shadows on the floor are translucent.
    Transparent,
}

impl Default for Studio {
    fn default() -> Self {
        Self { backdrop: Backdrop::Studio, floor: true }
    }
}

/// Where the key light stands, from the subject: to the left of the camera, above it, before the subject.
const TO_KEY: Vec3 = Vec3::new(-0.62, 0.78, 0.62);

/// Half the side of the floor, view units.
const FLOOR: f32 = 7.0;

/// Behind everything. `Backdrop` of the shader, sRGB.
#[derive(ShaderType, Debug, Clone, Copy)]
struct BackdropColours {
    centre: Vec4,
    rim: Vec4,
}

#[derive(Asset, TypePath, AsBindGroup, Debug, Clone)]
struct BackdropMaterial {
    #[uniform(0)]
    colours: BackdropColours,
}

impl Material for BackdropMaterial {
    fn vertex_shader() -> ShaderRef {
        BACKDROP_SHADER.into()
    }

    fn fragment_shader() -> ShaderRef {
        BACKDROP_SHADER.into()
    }

    fn enable_prepass() -> bool {
        false
    }

    fn enable_shadows() -> bool {
        false
    }

    fn specialize(
        _: &MaterialPipeline,
        descriptor: &mut RenderPipelineDescriptor,
        _: &MeshVertexBufferLayoutRef,
        _: MaterialPipelineKey<Self>,
    ) -> Result<(), SpecializedMeshPipelineError> {
        define(descriptor, "SHADOW_TAPS", 1);
        Ok(())
    }
}

/// Darkens what lies behind it where the key light does not reach the floor.
#[derive(Asset, TypePath, AsBindGroup, Debug, Clone)]
#[bind_group_data(FloorKey)]
struct FloorMaterial {
    shadow_taps: u32,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
struct FloorKey(u32);

impl From<&FloorMaterial> for FloorKey {
    fn from(material: &FloorMaterial) -> Self {
        Self(material.shadow_taps)
    }
}

impl Material for FloorMaterial {
    fn fragment_shader() -> ShaderRef {
        FLOOR_SHADER.into()
    }

    fn alpha_mode(&self) -> AlphaMode {
        AlphaMode::Blend
    }

    fn enable_prepass() -> bool {
        false
    }

    fn enable_shadows() -> bool {
        false
    }

    fn specialize(
        _: &MaterialPipeline,
        descriptor: &mut RenderPipelineDescriptor,
        _: &MeshVertexBufferLayoutRef,
        key: MaterialPipelineKey<Self>,
    ) -> Result<(), SpecializedMeshPipelineError> {
        define(descriptor, "SHADOW_TAPS", 2 * key.bind_group_data.0.max(1) as i32);
        Ok(())
    }
}

/// Darkens the floor below one body, blended between its two states.
#[derive(Asset, TypePath, AsBindGroup, Debug, Clone)]
pub(super) struct ContactMaterial {
    #[storage(0, read_only, visibility(fragment))]
    pub shown: Handle<ShaderBuffer>,
    #[storage(1, read_only, visibility(fragment))]
    pub from_shade: Handle<ShaderBuffer>,
    #[storage(2, read_only, visibility(fragment))]
    pub to_shade: Handle<ShaderBuffer>,
}

impl Material for ContactMaterial {
    fn fragment_shader() -> ShaderRef {
        CONTACT_SHADER.into()
    }

    fn alpha_mode(&self) -> AlphaMode {
        AlphaMode::Blend
    }

    fn enable_prepass() -> bool {
        false
    }

    fn enable_shadows() -> bool {
        false
    }

    fn specialize(
        _: &MaterialPipeline,
        descriptor: &mut RenderPipelineDescriptor,
        _: &MeshVertexBufferLayoutRef,
        _: MaterialPipelineKey<Self>,
    ) -> Result<(), SpecializedMeshPipelineError> {
        define(descriptor, "CONTACT_SIDE", contact::SIDE as i32);
        Ok(())
    }
}

fn define(descriptor: &mut RenderPipelineDescriptor, name: &str, value: i32) {
    let define = ShaderDefVal::Int(name.into(), value);
    descriptor.vertex.shader_defs.push(define.clone());
    if let Some(fragment) = &mut descriptor.fragment {
        fragment.shader_defs.push(define);
    }
}

/// Marks the key light.
#[derive(Component)]
struct Key;

/// Marks what only is there with a floor.
#[derive(Component)]
pub(super) struct FloorPlane;

/// Adds the studio's materials and keeps it as [`Studio`] says.
pub(super) fn build(app: &mut App) {
    app.add_plugins((
        MaterialPlugin::<BackdropMaterial>::default(),
        MaterialPlugin::<FloorMaterial>::default(),
        MaterialPlugin::<ContactMaterial>::default(),
    ))
    .init_resource::<Studio>()
    .add_systems(Startup, set_up)
    .add_systems(PostUpdate, (furnish, aim.after(measure)).chain().in_set(ViewSystems::Present));
}

fn set_up(
    mut commands: Commands,
    quality: Res<Quality>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut backdrops: ResMut<Assets<BackdropMaterial>>,
    mut floors: ResMut<Assets<FloorMaterial>>,
) {
    commands.insert_resource(DirectionalLightShadowMap { size: quality.shadow_map });
    commands.spawn((
        Key,
        DirectionalLight { shadow_maps_enabled: true, shadow_depth_bias: 0.0, shadow_normal_bias: 0.0, ..default() },
        Transform::default(),
    ));
    let triangle = Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::RENDER_WORLD).with_inserted_attribute(
        Mesh::ATTRIBUTE_POSITION,
        vec![Vec3::new(-1.0, -1.0, 0.0), Vec3::new(3.0, -1.0, 0.0), Vec3::new(-1.0, 3.0, 0.0)],
    );
    let colours = BackdropColours { centre: Vec4::ONE, rim: Vec4::ONE };
    commands.spawn((
        Mesh3d(meshes.add(triangle)),
        MeshMaterial3d(backdrops.add(BackdropMaterial { colours })),
        NoFrustumCulling,
        NotShadowCaster,
        NotShadowReceiver,
    ));
    commands.spawn((
        FloorPlane,
        Mesh3d(meshes.add(Plane3d::new(Vec3::Y, Vec2::splat(FLOOR)).mesh())),
        MeshMaterial3d(floors.add(FloorMaterial { shadow_taps: quality.shadow_taps() })),
        NoFrustumCulling,
        NotShadowCaster,
    ));
}

/// Shows what [`Studio`] says.
fn furnish(
    studio: Res<Studio>,
    mut backdrops: ResMut<Assets<BackdropMaterial>>,
    mut backdrop: Query<(&MeshMaterial3d<BackdropMaterial>, &mut Visibility), Without<FloorPlane>>,
    mut floors: Query<&mut Visibility, With<FloorPlane>>,
) {
    let shown = |is_shown: bool| if is_shown { Visibility::Inherited } else { Visibility::Hidden };
    for mut visibility in &mut floors {
        visibility.set_if_neq(shown(studio.floor));
    }
    if !studio.is_changed() {
        return;
    }
    let srgb = |[r, g, b]: [u8; 3]| Vec4::new(f32::from(r), f32::from(g), f32::from(b), 255.0) / 255.0;
    let (centre, rim) = match studio.backdrop {
        Backdrop::Studio => ([247, 247, 248], [214, 216, 220]),
        Backdrop::Plain(colour) => (colour, colour),
        Backdrop::Transparent => ([0; 3], [0; 3]),
    };
    for (material, mut visibility) in &mut backdrop {
        visibility.set_if_neq(shown(studio.backdrop != Backdrop::Transparent));
        if let Some(mut material) = backdrops.get_mut(material) {
            material.colours = BackdropColours { centre: srgb(centre), rim: srgb(rim) };
        }
    }
}

/// Turns the lamps with the first camera, and fits the shadow map to the scene: what is between its nearest and its furthest
/// point from the camera.
fn aim(
    cameras: Query<&Orbit, With<Camera3d>>,
    bodies: Query<&Extent, With<Body>>,
    mut keys: Query<(&mut Transform, &mut bevy::light::CascadeShadowConfig), With<Key>>,
) {
    let Some(orbit) = cameras.iter().next() else { return };
    let yaw = Quat::from_rotation_y(orbit.yaw);
    let Some(Extent { low, high }) = bodies.iter().copied().reduce(Extent::union) else { return };
    let (centre, radius) = (0.5 * (low + high), 0.5 * (high - low).length());
    let along = (centre - orbit.eye()).dot(orbit.rotation() * Vec3::NEG_Z);
    for (mut transform, mut cascades) in &mut keys {
        let looking = Transform::from_translation(yaw * TO_KEY).looking_at(Vec3::ZERO, Vec3::Y);
        transform.set_if_neq(looking);
        // The floor's shadow reaches further than the body.
        let (near, far) = ((along - 1.2 * radius).max(0.0), (along + 1.6 * radius).max(0.5));
        *cascades = CascadeShadowConfigBuilder {
            num_cascades: 1,
            minimum_distance: near,
            maximum_distance: far,
            first_cascade_far_bound: far,
            overlap_proportion: 0.0,
        }
        .build();
    }
}
