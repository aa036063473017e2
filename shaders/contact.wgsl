// Where a body takes the room's light from the floor: soft, darkest under its soles. Computed for each state, blended here.

#import bevy_pbr::forward_io::VertexOutput

struct Blend {
    blend: f32,
    grown: f32,
}

@group(#{MATERIAL_BIND_GROUP}) @binding(0) var<storage, read> shown: Blend;
@group(#{MATERIAL_BIND_GROUP}) @binding(1) var<storage, read> from_shade: array<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(2) var<storage, read> to_shade: array<f32>;

fn shade(x: i32, y: i32) -> f32 {
    let side = #{CONTACT_SIDE};
    let k = clamp(y, 0, side - 1) * side + clamp(x, 0, side - 1);
    return mix(from_shade[k], to_shade[k], shown.blend);
}

@fragment
fn fragment(in: VertexOutput) -> @location(0) vec4<f32> {
    let at = in.uv * f32(#{CONTACT_SIDE}) - vec2(0.5);
    let corner = vec2<i32>(floor(at));
    let t = smoothstep(vec2(0.0), vec2(1.0), fract(at));
    let low = mix(shade(corner.x, corner.y), shade(corner.x + 1, corner.y), t.x);
    let high = mix(shade(corner.x, corner.y + 1), shade(corner.x + 1, corner.y + 1), t.x);
    let fade = 1.0 - smoothstep(0.7, 1.0, length(in.uv - vec2(0.5)) * 2.0);
    return vec4(0.10, 0.105, 0.12, min(1.6 * fade * mix(low, high, t.y), 0.75));
}
