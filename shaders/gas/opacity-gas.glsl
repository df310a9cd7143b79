// Surface-defined gases: the solid texture is the surface's transparency, integrated over the pixel's footprint.

#include "gas/volumes-several.glsl"
#include "gas/density-functions.glsl"
#include "gas/solid-texture.glsl"

const uint CHUNKS_A_CALL = 4u; // of a tile's triangles in a dispatch, so that no driver ends the loops, see loops.glsl

float gas_opacity(Facet facet, vec2 at, float depth, vec3 normal, float opacity) {
    int texture_index = objects[facet.object].solid_texture;
    if (texture_index < 0) {
        return opacity;
    }
    vec3 ray = ray_direction(at);
    vec3 point = facet.eye + ray * depth;
    take_volume(uint(texture_index));
    float seen = opacity * mean_density(point + facet.offset, facet.facing, ray, depth);
    vec2 ends_m = objects[facet.object].ends_m;
    float fade_m = objects[facet.object].fade_m;
    if (ends_m.x > 0.0) {
        vec2 t = clamp((ends_m - abs(point.xz)) / max(fade_m, 1.0e-3), 0.0, 1.0);
        seen *= t.x * t.x * (3.0 - 2.0 * t.x) * t.y * t.y * (3.0 - 2.0 * t.y);
    }
    float rim = objects[facet.object].rim;
    if (rim > 0.0) {
        float t = clamp(abs(dot(normalize(normal), normalize(ray))) / rim, 0.0, 1.0);
        seen *= t * t * (3.0 - 2.0 * t);
    }
    // What fades before the opaque surface behind it must not be one.
    return fade_m > 0.0 ? min(seen, 0.9999) : seen;
}
