// The pass `occlusion` of one pixel: whether a polygon object stands between what is seen and the sun.

#include "terrain/light.glsl"
#include "common/triangle-tree.glsl"

layout(set = 0, binding = 1) uniform texture2D depth;
layout(set = 0, binding = 2) uniform texture2D prior; // what the maps left of the light

// The light where a ray to the sun did not come to its end.
const float UNKNOWN_LIGHT = 2.0;
// Steps of a ray in the tree: fewer than lavapipe grants to the loops of a shader.
const uint MOST_STEPS = 60000u;
// Of what a place is made of, what its rounding may be.
const float ROUNDING = 2.0e-6;

float lit_at(ivec2 pixel) {
    vec4 hit = texelFetch(depth, pixel, 0);
    float before = texelFetch(prior, pixel, 0).x;
    bool is_seen = (int(hit.w) & 7) != 0;
    if (!is_seen || before == 0.0) {
        return before;
    }
    vec3 ray = view_direction(vec2(pixel));
    float distance_m = hit.x * length(ray);
    // As far before the surface as rounding may have put it behind.
    float away_m = ROUNDING * (distance_m + length(light.eye));
    vec3 from = light.eye + (distance_m - away_m) * normalize(ray);
    Hit met = first_hit(from, light.to_sun, tree_node_count(), MOST_STEPS);
    float lit = met.distance_m < 0.0 ? before : 0.0;
    return met.is_certain ? lit : UNKNOWN_LIGHT;
}
