// Behind everything: one triangle at the far end of the depth range.

#import bevy_pbr::mesh_view_bindings::view
#import homunculus::studio

struct Backdrop {
    centre: vec4<f32>,
    rim: vec4<f32>,
}

@group(#{MATERIAL_BIND_GROUP}) @binding(0) var<uniform> backdrop: Backdrop;

struct VertexOutput {
    @builtin(position) position: vec4<f32>,
    @location(0) at: vec2<f32>,
}

@vertex
fn vertex(@location(0) corner: vec3<f32>) -> VertexOutput {
    var out: VertexOutput;
    // Depth is reversed: 0 is infinitely far.
    out.position = vec4(corner.xy, 0.0, 1.0);
    out.at = corner.xy;
    return out;
}

@fragment
fn fragment(in: VertexOutput) -> @location(0) vec4<f32> {
    // Colours are mixed as the eye sees them: in sRGB.
    let reach = length((in.at - vec2(0.0, 0.08)) * vec2(0.8, 0.75));
    let colour = mix(backdrop.centre.rgb, backdrop.rim.rgb, smoothstep(0.0, 1.15, reach));
    return vec4(studio::dithered(studio::linear_from_srgb(colour), in.position.xy), 1.0);
}
