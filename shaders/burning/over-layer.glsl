// The layer of fire and smoke over the light of a pixel: between the four pixels of the layer around it, of which those
// count less that were drawn before something at another distance (joint bilateral upsampling, Kopf et al. 2007).

#include "burning/billboards.glsl"

layout(set = 0, binding = 45) uniform texture2D mesh_depth;

layout(set = 0, binding = 55) uniform utexture2D fire_texels; // two halves of 16 bits each; the distance of the mesh

float distance_at(ivec2 pixel) {
    return eye_distance(texelFetch(mesh_depth, pixel, 0).x);
}

// Adds a texel by how near it lies and how far apart what was before it.
void add(inout vec4 sum, inout float weights, uvec4 texel, float near, float own) {
    float apart = abs(uintBitsToFloat(texel.z) - own) / billboards.particle_radius;
    float weight = near / (0.01 + apart);
    sum += weight * vec4(unpackHalf2x16(texel.x), unpackHalf2x16(texel.y));
    weights += weight;
}

// Premultiplied. One read a texel: reads are what it takes.
vec4 fire_at(ivec2 pixel) {
    int scale = int(billboards.layer_scale);
    vec2 at = vec2(pixel - scale / 2) / float(scale);
    vec2 t = at - floor(at);
    ivec2 last = ivec2(billboards.layer_size) - 1;
    ivec2 low = ivec2(floor(at));
    ivec2 high = min(low + 1, last);
    low = clamp(low, ivec2(0), last);
    float own = distance_at(pixel);
    vec4 sum = vec4(0.0);
    float weights = 0.0;
    add(sum, weights, texelFetch(fire_texels, low, 0), (1.0 - t.x) * (1.0 - t.y), own);
    add(sum, weights, texelFetch(fire_texels, ivec2(high.x, low.y), 0), t.x * (1.0 - t.y), own);
    add(sum, weights, texelFetch(fire_texels, ivec2(low.x, high.y), 0), (1.0 - t.x) * t.y, own);
    add(sum, weights, texelFetch(fire_texels, high, 0), t.x * t.y, own);
    return sum / max(weights, 1.0e-6);
}

vec3 with_fire(vec3 light, ivec2 pixel) {
    vec4 fire = fire_at(pixel);
    return light * (1.0 - fire.a) + fire.rgb;
}
