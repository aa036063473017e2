// The studio's light: what every surface shader shades with.
//
// Key, fill and rim light turn with the camera, as lamps do around a turntable; only the key casts a shadow. It is the scene's
// first directional light, the others are formulas.

#define_import_path homunculus::studio

#import bevy_pbr::mesh_view_bindings::{
    view, lights, directional_shadow_textures, directional_shadow_textures_comparison_sampler,
}

const TAPS: i32 = #{SHADOW_TAPS};

struct Surface {
    position: vec3<f32>,
    // Unit, towards the viewer.
    normal: vec3<f32>,
    // Unit, to the viewer.
    to_eye: vec3<f32>,
    // Linear.
    albedo: vec3<f32>,
    roughness: f32,
    metallic: f32,
    // What is open to the surroundings: 1 = all of it.
    openness: f32,
}

fn to_key() -> vec3<f32> {
    return lights.directional_lights[0].direction_to_light;
}

// Level direction from the subject to the camera.
fn to_camera() -> vec3<f32> {
    return normalize(cross(view.world_from_view[0].xyz, vec3(0.0, 1.0, 0.0)));
}

fn to_eye(position: vec3<f32>) -> vec3<f32> {
    let is_orthographic = view.clip_from_view[3].w == 1.0;
    return select(normalize(view.world_position - position), view.world_from_view[2].xyz, is_orthographic);
}

// Share of the key light that arrives, blurred over a disc of `spread` world units: taps on a golden-angle spiral, each filtered
// by the sampler, so that neighbouring taps overlap and no bands show. What casts shadows itself must be lifted off itself: a
// disc on a slanted surface reaches below it.
fn key_shadow(position: vec3<f32>, normal: vec3<f32>, spread: f32, lift: f32) -> f32 {
    if lights.n_directional_lights == 0u {
        return 1.0;
    }
    let light = &lights.directional_lights[0];
    let cascade = &(*light).cascades[0];
    let texel = (*cascade).texel_size;
    let lifted = position + normal * (1.5 * texel + lift) + (*light).direction_to_light * texel;
    let clip = (*cascade).clip_from_world * vec4(lifted, 1.0);
    let ndc = clip.xyz / clip.w;
    if any(abs(ndc.xy) > vec2(1.0)) || ndc.z < 0.0 || ndc.z > 1.0 {
        return 1.0;
    }
    let uv = ndc.xy * vec2(0.5, -0.5) + vec2(0.5);
    let radius = spread / (texel * f32(textureDimensions(directional_shadow_textures).x));
    let layer = i32((*light).depth_texture_base_index);
    var sum = 0.0;
    for (var k = 0; k < TAPS; k += 1) {
        let angle = 2.399963 * f32(k);
        let offset = radius * sqrt((f32(k) + 0.5) / f32(TAPS)) * vec2(cos(angle), sin(angle));
        sum += textureSampleCompareLevel(
            directional_shadow_textures, directional_shadow_textures_comparison_sampler, uv + offset, layer, ndc.z,
        );
    }
    return sum / f32(TAPS);
}

fn specular(normal: vec3<f32>, to_light: vec3<f32>, to_eye: vec3<f32>, roughness: f32) -> f32 {
    // GGX with the visibility of Karis; a lobe, not a mirror.
    let half_way = normalize(to_light + to_eye);
    let a = roughness * roughness;
    let nh = saturate(dot(normal, half_way));
    let nl = saturate(dot(normal, to_light));
    let nv = saturate(dot(normal, to_eye)) + 1.0e-4;
    let d = nh * nh * (a * a - 1.0) + 1.0;
    let k = 0.5 * a;
    return a * a / (3.14159 * d * d) * nl / (4.0 * (nl * (1.0 - k) + k) * (nv * (1.0 - k) + k));
}

// Diffuse light that arrives, by lamp: 1 where a white surface faces the key.
fn diffuse_light(surface: Surface, shadow: f32) -> vec3<f32> {
    let right = view.world_from_view[0].xyz;
    let back = to_camera();
    let n = surface.normal;
    let key = saturate(dot(n, to_key())) * shadow;
    let fill = saturate(0.5 + 0.5 * dot(n, normalize(0.9 * right + 0.1 * vec3(0.0, 1.0, 0.0) + 0.6 * back)));
    let rim = saturate(dot(n, normalize(0.75 * right + 0.55 * vec3(0.0, 1.0, 0.0) - back)));
    let sky = 0.5 + 0.5 * n.y;
    var light = 1.08 * key * vec3(1.0, 0.975, 0.94);
    light += surface.openness * 0.13 * fill * fill * vec3(0.93, 0.97, 1.0);
    light += surface.openness * 0.34 * rim * vec3(0.96, 0.98, 1.0);
    // The white room, its floor a little darker and warmer than its ceiling.
    light += surface.openness * mix(vec3(0.10, 0.092, 0.085), vec3(0.225, 0.23, 0.24), sky);
    return light;
}

// Light to the eye, linear, before the shoulder.
fn shade(surface: Surface, shadow: f32) -> vec3<f32> {
    let dielectric = (1.0 - surface.metallic) * surface.albedo;
    let f0 = mix(vec3(0.04), surface.albedo, surface.metallic);
    let grazing = pow(1.0 - saturate(dot(surface.normal, surface.to_eye)), 5.0);
    let right = view.world_from_view[0].xyz;
    let rim = normalize(0.75 * right + 0.55 * vec3(0.0, 1.0, 0.0) - to_camera());
    let glint = 2.2 * shadow * specular(surface.normal, to_key(), surface.to_eye, surface.roughness)
        + 0.8 * surface.openness * specular(surface.normal, rim, surface.to_eye, surface.roughness);
    // The room in the surface: brighter above; a metal shows little else.
    let mirrored = reflect(-surface.to_eye, surface.normal);
    let room = mix(0.25, 0.75, smoothstep(-0.6, 0.8, mirrored.y)) * surface.openness;
    let reflected = (f0 + (1.0 - f0) * grazing * (1.0 - surface.roughness)) * room;
    return dielectric * diffuse_light(surface, shadow) + (f0 + grazing * 0.3) * glint + reflected;
}

// A film's shoulder: what is below 0.75 stays, what is above bends towards 1.
fn shoulder(colour: vec3<f32>) -> vec3<f32> {
    let over = max(colour - vec3(0.75), vec3(0.0));
    return min(colour, vec3(0.75)) + 0.25 * over / (over + vec3(0.25));
}

fn srgb_from_linear(colour: vec3<f32>) -> vec3<f32> {
    return select(1.055 * pow(colour, vec3(1.0 / 2.4)) - 0.055, 12.92 * colour, colour <= vec3(0.0031308));
}

fn linear_from_srgb(colour: vec3<f32>) -> vec3<f32> {
    return select(pow((colour + 0.055) / 1.055, vec3(2.4)), colour / 12.92, colour <= vec3(0.04045));
}

// Half a level of noise, always the same (Jimenez 2014), so that soft gradients have no steps.
fn dithered(colour: vec3<f32>, pixel: vec2<f32>) -> vec3<f32> {
    let noise = fract(52.982918 * fract(dot(pixel, vec2(0.06711056, 0.00583715)))) - 0.5;
    return max(linear_from_srgb(srgb_from_linear(max(colour, vec3(0.0))) + noise / 255.0), vec3(0.0));
}
