// A boundary between two states of its complex: B + Σ (α, β, γ, δ) of the nodes' displacements, blended.
//
// Vertices are pulled by index: mesh attributes hold the rest shape alone and never change.

#import bevy_pbr::{
    mesh_bindings::mesh,
    mesh_functions,
    view_transformations::position_world_to_clip,
}

// As `material::Shown`.
struct Shown {
    blend: f32,
    // 1 = deformed, 0 = the rest shape.
    grown: f32,
    // Of the picture's width; and which side is kept: 1 left, −1 right.
    wipe_at: f32,
    wipe_side: f32,
    opacity: f32,
    brushes: u32,
    dab_softness: f32,
    // 1 = the ring and its dab are drawn.
    dab_strength: f32,
    ring_colour: vec4<f32>,
    dab_colour: vec4<f32>,
    // Centre in rest view space, radius.
    brush: array<vec4<f32>, 8>,
}

// As `material::Base`.
struct Base {
    colour: vec4<f32>,
    emissive: vec4<f32>,
    roughness: f32,
    metallic: f32,
    alpha_cutoff: f32,
    // Where the part's vertices begin among the body's.
    first_row: u32,
}

struct Carrier {
    nodes: vec4<u32>,
    weights: vec4<f32>,
}

@group(#{MATERIAL_BIND_GROUP}) @binding(0) var<storage, read> shown: Shown;
@group(#{MATERIAL_BIND_GROUP}) @binding(1) var<storage, read> carriers: array<Carrier>;
@group(#{MATERIAL_BIND_GROUP}) @binding(2) var<storage, read> from_nodes: array<vec4<f32>>;
@group(#{MATERIAL_BIND_GROUP}) @binding(3) var<storage, read> to_nodes: array<vec4<f32>>;
@group(#{MATERIAL_BIND_GROUP}) @binding(4) var<storage, read> from_normals: array<u32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(5) var<storage, read> to_normals: array<u32>;
// Place on the colour map; 1 where a triangle is marked.
@group(#{MATERIAL_BIND_GROUP}) @binding(6) var<storage, read> field: array<vec2<f32>>;
@group(#{MATERIAL_BIND_GROUP}) @binding(7) var<storage, read> colour_map: array<vec4<f32>>;
@group(#{MATERIAL_BIND_GROUP}) @binding(8) var base_texture: texture_2d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(9) var base_sampler: sampler;
@group(#{MATERIAL_BIND_GROUP}) @binding(10) var<uniform> base: Base;

fn displacement(row: u32) -> vec3<f32> {
    let carrier = carriers[row];
    var sum = vec3(0.0);
    for (var k = 0; k < 4; k += 1) {
        let node = carrier.nodes[k];
        sum += carrier.weights[k] * mix(from_nodes[node].xyz, to_nodes[node].xyz, shown.blend);
    }
    return shown.grown * sum;
}

// Octahedral: Meyer et al. 2010.
fn unit_from_octahedron(packed: u32) -> vec3<f32> {
    let p = unpack2x16snorm(packed);
    let z = 1.0 - abs(p.x) - abs(p.y);
    let fold = saturate(-z);
    return normalize(vec3(p.x - sign(p.x) * fold, p.y - sign(p.y) * fold, z));
}

fn row_of(vertex_index: u32, instance_index: u32) -> u32 {
    return base.first_row + vertex_index - mesh[instance_index].first_vertex_index;
}

#ifdef PREPASS_PIPELINE

#import bevy_pbr::prepass_io::VertexOutput

struct Vertex {
    @builtin(vertex_index) index: u32,
    @builtin(instance_index) instance_index: u32,
    @location(0) position: vec3<f32>,
}

@vertex
fn vertex(vertex: Vertex) -> VertexOutput {
    var out: VertexOutput;
    let position = vertex.position + displacement(row_of(vertex.index, vertex.instance_index));
    let world_from_local = mesh_functions::get_world_from_local(vertex.instance_index);
    out.world_position = mesh_functions::mesh_position_local_to_world(world_from_local, vec4(position, 1.0));
    out.position = position_world_to_clip(out.world_position.xyz);
#ifdef UNCLIPPED_DEPTH_ORTHO_EMULATION
    out.unclipped_depth = out.position.z;
    out.position.z = min(out.position.z, 1.0);
#endif
    return out;
}

#else

#import bevy_pbr::mesh_view_bindings::view
#import homunculus::studio

struct Vertex {
    @builtin(vertex_index) index: u32,
    @builtin(instance_index) instance_index: u32,
    @location(0) position: vec3<f32>,
#ifdef VERTEX_NORMALS
    @location(1) normal: vec3<f32>,
#endif
#ifdef VERTEX_UVS_A
    @location(2) uv: vec2<f32>,
#endif
#ifdef VERTEX_UVS_B
    // How much of the room is seen.
    @location(3) openness: vec2<f32>,
#endif
#ifdef VERTEX_COLORS
    @location(5) colour: vec4<f32>,
#endif
}

struct VertexOutput {
    @builtin(position) position: vec4<f32>,
    @location(0) world: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) rest: vec3<f32>,
    @location(3) uv: vec2<f32>,
    @location(4) field: vec2<f32>,
    @location(5) openness: f32,
#ifdef VERTEX_COLORS
    @location(6) colour: vec4<f32>,
#endif
}

@vertex
fn vertex(vertex: Vertex) -> VertexOutput {
    var out: VertexOutput;
    let row = row_of(vertex.index, vertex.instance_index);
    let world_from_local = mesh_functions::get_world_from_local(vertex.instance_index);
    let position = vertex.position + displacement(row);
    out.world = mesh_functions::mesh_position_local_to_world(world_from_local, vec4(position, 1.0)).xyz;
    out.position = position_world_to_clip(out.world);
    out.rest = vertex.position;
#ifdef VERTEX_NORMALS
    let grown = mix(unit_from_octahedron(from_normals[row]), unit_from_octahedron(to_normals[row]), shown.blend);
    out.normal = mix(vertex.normal, grown, shown.grown);
#endif
#ifdef VERTEX_UVS_A
    out.uv = vertex.uv;
#endif
#ifdef HAS_FIELD
    out.field = field[row];
#endif
#ifdef VERTEX_UVS_B
    out.openness = vertex.openness.x;
#else
    out.openness = 1.0;
#endif
#ifdef VERTEX_COLORS
    out.colour = vertex.colour;
#endif
    return out;
}

fn mapped(place: f32) -> vec3<f32> {
    let last = f32(arrayLength(&colour_map) - 1u);
    let at = saturate(place) * last;
    let low = u32(at);
    return mix(colour_map[low].rgb, colour_map[min(low + 1u, u32(last))].rgb, fract(at));
}

// How much of the brush's ring and dab a place of the rest shape gets; `pixel` is the length of a pixel there.
fn brushed(rest: vec3<f32>, pixel: f32) -> vec2<f32> {
    var ring = 0.0;
    var dab = 0.0;
    for (var k = 0u; k < shown.brushes; k += 1u) {
        let brush = shown.brush[k];
        let away = distance(rest, brush.xyz);
        ring = max(ring, 1.0 - smoothstep(0.8, 1.8, abs(away - brush.w) / pixel));
        let soft = 1.0 - smoothstep(1.0 - shown.dab_softness, 1.0, away / brush.w);
        dab = max(dab, select(soft, 0.0, away > brush.w));
    }
    return vec2(ring, dab * shown.dab_strength);
}

@fragment
fn fragment(in: VertexOutput, @builtin(front_facing) is_front: bool) -> @location(0) vec4<f32> {
#ifdef WIPED
    let across = (in.position.x - view.viewport.x) / view.viewport.z;
    if (across - shown.wipe_at) * shown.wipe_side > 0.0 {
        discard;
    }
#endif
    let to_eye = studio::to_eye(in.world);
#ifdef FACETED
    var normal = normalize(cross(dpdx(in.world), dpdy(in.world)));
#else
    var normal = normalize(in.normal);
#endif
    normal = select(normal, -normal, dot(normal, to_eye) < 0.0 && !is_front);
#ifdef FACETED
    normal = select(normal, -normal, dot(normal, to_eye) < 0.0);
#endif

    var colour = base.colour;
#ifdef VERTEX_COLORS
    colour *= in.colour;
#endif
#ifdef TEXTURED
#ifdef FLAT
    // Between two mip levels the finer one has more say: letters stay readable where a picture is drawn a little smaller.
    colour *= textureSampleBias(base_texture, base_sampler, in.uv, -0.4);
#else
    colour *= textureSample(base_texture, base_sampler, in.uv);
#endif
#endif
#ifdef MASKED
    if colour.a < base.alpha_cutoff {
        discard;
    }
#endif

    let pixel = max(length(fwidth(in.rest)), 1.0e-6);
    let brush = brushed(in.rest, pixel);
#ifdef FLAT
    // A picture: light of its own, premultiplied by alpha, so that no colour of what is transparent shows at an edge.
    let luminance = dot(colour.rgb, vec3(0.2126, 0.7152, 0.0722));
#ifdef GHOST
    return vec4(vec3(luminance), colour.a) * shown.opacity;
#else
#ifdef MAPPED
    // The picture's brightness is to a map what light is to a body: the legend's colour where it is white.
    var lit = mapped(in.field.x) * colour.a;
#ifdef TEXTURED
    lit *= mix(0.4, 1.0, pow(saturate(luminance / max(colour.a, 1.0e-3)), 1.0 / 2.2));
#endif
#else
    var lit = colour.rgb;
#endif
#ifdef HAS_FIELD
    lit = mix(lit, vec3(0.73, 0.015, 0.012) * colour.a, smoothstep(0.95, 0.999, in.field.y));
#endif
#ifdef EDGED
    let side = min(in.uv, vec2(1.0) - in.uv) / fwidth(in.uv);
    let edge = 1.0 - smoothstep(0.4, 1.4, min(side.x, side.y));
    let block = 1.0 / max(fwidth(in.uv).x, fwidth(in.uv).y);
    lit *= 1.0 - 0.4 * edge * smoothstep(3.0, 9.0, block);
#endif
    lit = mix(lit, shown.dab_colour.rgb * colour.a, 0.75 * brush.y);
    lit = mix(lit, shown.ring_colour.rgb, brush.x);
    return vec4(lit, max(colour.a, brush.x)) * shown.opacity;
#endif
#else
#ifdef UNLIT
    var lit = colour.rgb;
    lit = mix(lit, shown.dab_colour.rgb, 0.75 * brush.y);
#ifdef HAS_FIELD
    lit = mix(lit, vec3(0.73, 0.015, 0.012), smoothstep(0.95, 0.999, in.field.y));
#endif
    lit = mix(lit, shown.ring_colour.rgb, brush.x);
    return vec4(lit, colour.a * shown.opacity);
#else

    var surface: studio::Surface;
    surface.position = in.world;
    surface.normal = normal;
    surface.to_eye = to_eye;
    surface.albedo = colour.rgb;
    surface.roughness = base.roughness;
    surface.metallic = base.metallic;
    surface.openness = in.openness;

#ifdef GHOST
    // A shell of glass: clear where it is looked through, denser towards its rim.
    let rim = pow(1.0 - saturate(dot(normal, to_eye)), 2.0);
    return vec4(vec3(0.42, 0.5, 0.6) * (0.55 + 0.45 * rim), shown.opacity * (0.35 + 1.4 * rim));
#else

    let facing = dot(normal, studio::to_key());
    var shadow = 0.0;
    if facing > 0.0 {
#ifdef WIPED
        // The body on the other side is not seen here; its shadow would be.
        shadow = 1.0;
#else
        shadow = studio::key_shadow(in.world, normal, 0.02, 0.01);
#endif
    }
#ifdef MAPPED
    // The colour is the legend's where the light is full, and never brighter.
    surface.albedo = vec3(1.0);
    let light = studio::diffuse_light(surface, shadow);
    let brightness = min(dot(light, vec3(0.2126, 0.7152, 0.0722)) / 0.95, 1.0);
    var map = mapped(in.field.x);
    map = mix(map, shown.dab_colour.rgb, brush.y);
    var lit = map * mix(0.25, 1.0, brightness);
#else
    surface.albedo = mix(surface.albedo, shown.dab_colour.rgb, brush.y);
    var lit = studio::shoulder(studio::shade(surface, shadow) + base.emissive.rgb);
#endif

#ifdef HAS_FIELD
    let mark = smoothstep(0.95, 0.999, in.field.y);
    lit = mix(lit, vec3(0.73, 0.015, 0.012) * (0.45 + 0.55 * shadow * saturate(facing)), mark);
#endif
#ifdef EDGED
    let side = min(in.uv, vec2(1.0) - in.uv) / fwidth(in.uv);
    let edge = 1.0 - smoothstep(0.4, 1.4, min(side.x, side.y));
    // Far away, where a block is a few pixels wide, lines would be all there is.
    let block = 1.0 / max(fwidth(in.uv).x, fwidth(in.uv).y);
    lit *= 1.0 - 0.5 * edge * smoothstep(3.0, 9.0, block);
#endif
    lit = mix(lit, shown.ring_colour.rgb, brush.x);
    return vec4(studio::dithered(lit, in.position.xy), colour.a * shown.opacity);
#endif
#endif
#endif
}
#endif
