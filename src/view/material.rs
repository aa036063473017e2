//! What the surface shader is given.

use bevy::{
    asset::{load_internal_asset, uuid_handle},
    mesh::MeshVertexBufferLayoutRef,
    pbr::{MaterialPipeline, MaterialPipelineKey},
    prelude::*,
    render::{
        Render, RenderSystems,
        erased_render_asset::prepare_erased_assets,
        render_asset::prepare_assets,
        render_resource::{AsBindGroup, Face, RenderPipelineDescriptor, ShaderType, SpecializedMeshPipelineError},
        storage::{GpuShaderBuffer, ShaderBuffer},
    },
    shader::{ShaderDefVal, ShaderRef},
};

use super::{Quality, drawn::Carrier, studio::ContactMaterial};

const STUDIO_SHADER: Handle<Shader> = uuid_handle!("0b6d7a5e-51f7-4f86-9d6e-6b1c2e0e7a01");
const SURFACE_SHADER: Handle<Shader> = uuid_handle!("0b6d7a5e-51f7-4f86-9d6e-6b1c2e0e7a02");
pub(super) const BACKDROP_SHADER: Handle<Shader> = uuid_handle!("0b6d7a5e-51f7-4f86-9d6e-6b1c2e0e7a03");
pub(super) const FLOOR_SHADER: Handle<Shader> = uuid_handle!("0b6d7a5e-51f7-4f86-9d6e-6b1c2e0e7a04");
pub(super) const CONTACT_SHADER: Handle<Shader> = uuid_handle!("0b6d7a5e-51f7-4f86-9d6e-6b1c2e0e7a05");

/// Most brushes shown at once: one and its mirror images.
pub(super) const MOST_BRUSHES: usize = 8;

/// Ships the shaders within the program: they are there before the first frame and need no file.
pub(super) fn load_shaders(app: &mut App) {
    load_internal_asset!(app, STUDIO_SHADER, "../../shaders/studio.wgsl", Shader::from_wgsl);
    load_internal_asset!(app, SURFACE_SHADER, "../../shaders/surface.wgsl", Shader::from_wgsl);
    load_internal_asset!(app, BACKDROP_SHADER, "../../shaders/backdrop.wgsl", Shader::from_wgsl);
    load_internal_asset!(app, FLOOR_SHADER, "../../shaders/floor.wgsl", Shader::from_wgsl);
    load_internal_asset!(app, CONTACT_SHADER, "../../shaders/contact.wgsl", Shader::from_wgsl);
}

/// Lets materials wait for the buffers they are bound to, so that both can be new in one frame.
pub(super) fn order(render: &mut SubApp) {
    // Orders through a system of our own: those of others cannot be configured.
    render.add_systems(
        Render,
        buffers_are_there
            .in_set(RenderSystems::PrepareAssets)
            .after(prepare_assets::<GpuShaderBuffer>)
            .before(prepare_erased_assets::<MeshMaterial3d<SurfaceMaterial>>)
            .before(prepare_erased_assets::<MeshMaterial3d<ContactMaterial>>),
    );
}

fn buffers_are_there() {}

/// What changes from frame to frame. `Shown` of the shader.
#[derive(ShaderType, Debug, Clone, PartialEq)]
pub(super) struct Shown {
    /// Between the two states, 0..=1.
    pub blend: f32,
    /// 1 = deformed, 0 = the rest shape.
    pub grown: f32,
    /// Of the picture's width.
    pub wipe_at: f32,
    /// 1 keeps what is left of the line, −1 what is right.
    pub wipe_side: f32,
    /// Times the material's own.
    pub opacity: f32,
    /// How many of `brush` count.
    pub brushes: u32,
    /// 0 = even up to the rim.
    pub dab_softness: f32,
    /// 0..=1.
    pub dab_strength: f32,
    /// Linear.
    pub ring_colour: Vec4,
    /// Linear.
    pub dab_colour: Vec4,
    /// Centre in view space at rest, radius.
    pub brush: [Vec4; MOST_BRUSHES],
}

impl Default for Shown {
    fn default() -> Self {
        Self {
            blend: 0.0,
            grown: 1.0,
            wipe_at: 0.5,
            wipe_side: 1.0,
            opacity: 1.0,
            brushes: 0,
            dab_softness: 1.0,
            dab_strength: 0.0,
            ring_colour: Vec4::ZERO,
            dab_colour: Vec4::ZERO,
            brush: [Vec4::ZERO; MOST_BRUSHES],
        }
    }
}

/// A part's own colours. `Base` of the shader.
#[derive(ShaderType, Debug, Clone, PartialEq)]
pub(super) struct Base {
    /// Linear, times texture and vertex colour.
    pub colour: Vec4,
    /// Linear.
    pub emissive: Vec4,
    /// 0..=1.
    pub roughness: f32,
    /// 0..=1.
    pub metallic: f32,
    /// Alpha below which nothing is drawn, where the material masks.
    pub alpha_cutoff: f32,
    /// Where the part's vertices begin among the body's rows.
    pub first_row: u32,
}

/// Which variant of the shader.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub(super) struct Variant {
    /// One of the shader's defines, or none of them.
    pub coat: Coat,
    /// A colour or a mark for each vertex is bound.
    pub has_field: bool,
    /// A texture is bound.
    pub is_textured: bool,
    /// Texels below the cut-off are holes.
    pub is_masked: bool,
    /// The colour is the file's, whatever the light.
    pub is_unlit: bool,
    /// A picture: it knows no light and no side, and its texture is premultiplied by alpha.
    pub is_flat: bool,
    /// Only one side of a line is drawn.
    pub is_wiped: bool,
    /// Flat faces with lines along the borders of the texture square: blocks.
    pub is_block: bool,
    /// Only what faces the viewer is drawn.
    pub is_one_sided: bool,
    /// Samples of the shadow map.
    pub shadow_taps: u32,
}

/// What the surface wears.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub(super) enum Coat {
    /// Its own colours.
    #[default]
    Own,
    /// The colours of a field.
    Mapped,
    /// Glass.
    Ghost,
}

/// The material of everything that is deformed.
#[derive(Asset, TypePath, AsBindGroup, Debug, Clone)]
#[bind_group_data(Variant)]
pub(super) struct SurfaceMaterial {
    /// One [`Shown`], shared by all parts of a body.
    #[storage(0, read_only)]
    pub shown: Handle<ShaderBuffer>,
    /// `[rows]` four nodes and weights.
    #[storage(1, read_only, visibility(vertex))]
    pub carriers: Handle<ShaderBuffer>,
    /// `[nodes used]` displacement in view space, padded to four.
    #[storage(2, read_only, visibility(vertex))]
    pub from_nodes: Handle<ShaderBuffer>,
    /// As above.
    #[storage(3, read_only, visibility(vertex))]
    pub to_nodes: Handle<ShaderBuffer>,
    /// `[rows]` octahedral.
    #[storage(4, read_only, visibility(vertex))]
    pub from_normals: Handle<ShaderBuffer>,
    /// As above.
    #[storage(5, read_only, visibility(vertex))]
    pub to_normals: Handle<ShaderBuffer>,
    /// `[rows]` place on the colour map, mark.
    #[storage(6, read_only, visibility(vertex))]
    pub field: Handle<ShaderBuffer>,
    /// Linear colours, evenly spaced.
    #[storage(7, read_only, visibility(fragment))]
    pub colour_map: Handle<ShaderBuffer>,
    /// Base colour.
    #[texture(8)]
    #[sampler(9)]
    pub texture: Option<Handle<Image>>,
    /// Constants of the part.
    #[uniform(10)]
    pub base: Base,
    /// How alpha is used.
    pub alpha_mode: AlphaMode,
    /// Which shader.
    pub variant: Variant,
}

impl From<&SurfaceMaterial> for Variant {
    fn from(material: &SurfaceMaterial) -> Self {
        material.variant
    }
}

impl Material for SurfaceMaterial {
    fn vertex_shader() -> ShaderRef {
        SURFACE_SHADER.into()
    }

    fn prepass_vertex_shader() -> ShaderRef {
        SURFACE_SHADER.into()
    }

    fn fragment_shader() -> ShaderRef {
        SURFACE_SHADER.into()
    }

    fn alpha_mode(&self) -> AlphaMode {
        self.alpha_mode
    }

    fn specialize(
        _: &MaterialPipeline,
        descriptor: &mut RenderPipelineDescriptor,
        _: &MeshVertexBufferLayoutRef,
        key: MaterialPipelineKey<Self>,
    ) -> Result<(), SpecializedMeshPipelineError> {
        let variant = key.bind_group_data;
        // Fold-overs and open surfaces have two sides to see.
        descriptor.primitive.cull_mode = variant.is_one_sided.then_some(Face::Back);
        let defines = [
            ("MAPPED", variant.coat == Coat::Mapped),
            ("GHOST", variant.coat == Coat::Ghost),
            ("HAS_FIELD", variant.has_field),
            ("TEXTURED", variant.is_textured),
            ("MASKED", variant.is_masked),
            ("UNLIT", variant.is_unlit),
            ("FLAT", variant.is_flat),
            ("WIPED", variant.is_wiped),
            ("FACETED", variant.is_block),
            ("EDGED", variant.is_block),
        ];
        let defines: Vec<ShaderDefVal> =
            defines.into_iter().filter(|(_, is_on)| *is_on).map(|(name, _)| name.into()).collect();
        let taps = ShaderDefVal::Int("SHADOW_TAPS".into(), variant.shadow_taps.max(1) as i32);
        descriptor.vertex.shader_defs.extend(defines.iter().cloned());
        descriptor.vertex.shader_defs.push(taps.clone());
        if let Some(fragment) = &mut descriptor.fragment {
            fragment.shader_defs.extend(defines);
            fragment.shader_defs.push(taps);
        }
        Ok(())
    }
}

/// A material for what is never deformed: one node that stays where it is carries every vertex.
pub(super) fn still(buffers: &mut Assets<ShaderBuffer>, quality: Quality) -> SurfaceMaterial {
    let nothing = buffers.add(ShaderBuffer::from(vec![Vec4::ZERO]));
    SurfaceMaterial {
        shown: buffers.add(ShaderBuffer::from(Shown { grown: 0.0, ..default() })),
        carriers: buffers.add(ShaderBuffer::from(vec![Carrier { nodes: UVec4::ZERO, weights: Vec4::ZERO }])),
        from_nodes: nothing.clone(),
        to_nodes: nothing.clone(),
        from_normals: nothing.clone(),
        to_normals: nothing.clone(),
        field: nothing.clone(),
        colour_map: nothing,
        texture: None,
        base: Base {
            colour: Vec4::new(0.30, 0.34, 0.40, 1.0),
            emissive: Vec4::ZERO,
            roughness: 0.6,
            metallic: 0.0,
            alpha_cutoff: 0.0,
            first_row: 0,
        },
        alpha_mode: AlphaMode::Opaque,
        variant: Variant { shadow_taps: quality.shadow_taps(), ..default() },
    }
}
