// The layer of fire and smoke over the light of a pixel: between the four pixels of the layer around it, of which those
// count less that were drawn before something at another distance (joint bilateral upsampling, Kopf et al. 2007).

#include "burning/billboards.glsl"

layout(set = 0, binding = 45) uniform texture2D mesh_depth;

layout(set = 0, binding = 55) uniform texture2D fire_layer;

float distance_at(ivec2 pixel) {
    return eye_distance(texelFetch(mesh_depth, pixel, 0).x);
}

// Premultiplied.
vec4 fire_at(ivec2 pixel) {
    int scale = int(billboards.layer_scale);
    vec2 at = vec2(pixel - scale / 2) / float(scale);
    ivec2 first = ivec2(floor(at));
    vec2 t = at - vec2(first);
    ivec2 last = ivec2(billboards.last_pixel) / scale;
    vec4 brightest = vec4(0.0);
    for (int i = 0; i < 4; i++) {
        ivec2 texel = clamp(first + ivec2(i & 1, i >> 1), ivec2(0), last);
        brightest = max(brightest, texelFetch(fire_layer, texel, 0));
    }
    // Where there is neither fire nor smoke, as in most of the picture, distances need not be told.
    bool is_clear = brightest == vec4(0.0);
    float own = distance_at(pixel);
    vec4 sum = vec4(0.0);
    float weights = 0.0;
    for (int i = 0; i < 4 && !is_clear; i++) {
        ivec2 corner = ivec2(i & 1, i >> 1);
        ivec2 texel = clamp(first + corner, ivec2(0), last);
        vec2 near = mix(1.0 - t, t, vec2(corner));
        float apart = abs(distance_at(layer_pixel(texel)) - own) / billboards.particle_radius;
        float weight = near.x * near.y / (0.01 + apart);
        sum += weight * texelFetch(fire_layer, texel, 0);
        weights += weight;
    }
    return sum / max(weights, 1.0e-6);
}

vec3 with_fire(vec3 light, ivec2 pixel) {
    vec4 fire = fire_at(pixel);
    return light * (1.0 - fire.a) + fire.rgb;
}
