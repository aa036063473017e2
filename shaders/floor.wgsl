// A floor that is seen only where it is darker: the key light's shadow.

#import bevy_pbr::forward_io::VertexOutput
#import homunculus::studio

@fragment
fn fragment(in: VertexOutput) -> @location(0) vec4<f32> {
    let shadow = 1.0 - studio::key_shadow(in.world_position.xyz, vec3(0.0, 1.0, 0.0), 0.055, 0.0);
    let fade = 1.0 - smoothstep(0.4, 1.0, length(in.uv - vec2(0.5)) * 2.0);
    return vec4(0.11, 0.12, 0.14, 0.34 * fade * shadow);
}
