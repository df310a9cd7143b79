#version 450
#pragma variants SHADOW=off,on

// Where the ray of each vertex of the refined water meets the receiver first (section 6.3), in the position map's texels.

layout(local_size_x = 64) in;

#include "caustics/hit.glsl"
#include "caustics/shadow-{SHADOW}.glsl"

layout(std430, set = 0, binding = 4) readonly buffer Rays {
    Ray list[];
} rays;

layout(std430, set = 0, binding = 5) buffer Landings {
    vec4 list[]; // place in texels, height, and 1 / cos theta_t e^(-K d) for the surface there; -1 for a miss, -2 without light
} landings;

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= plane.vertices) {
        return;
    }
    Ray ray = rays.list[index];
    // Of a ray that meets nothing, the place halfway down the box.
    vec4 landing = vec4(place_at(ray.origin, ray.slope, 0.0), 0.0, -2.0);
    if (ray.enters > 0.0 && ray.origin.y > plane.middle - plane.half_height) {
        vec4 hit = first_hit(ray.origin, ray.slope);
        landing.w = -1.0;
        if (hit.w > 0.0) {
            landing = vec4(hit.xyz, landed_weight(hit, ray.origin, ray.slope, ray.secant));
            vec2 place = (hit.xy - 0.5 * float(plane.map_size)) / plane.texels_per_m + plane.center;
            if (!reaches(vec3(place.x, hit.z + plane.middle, place.y), ray.origin)) {
                landing.w = -1.0;
            }
        }
    }
    landings.list[index] = landing;
}
