#version 450
#pragma variants TREE=whole,pieces

// The plain underwater view: the cast as it is, but for pixels at an edge, which take each of their samples from its own surface.

#include "caustics/view.glsl"

layout(location = 0) out vec4 color; // alpha 0 where a ray did not end

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec3 sum = vec3(0.0);
    float certain = 1.0;
    for (uint i = 0u; i < view.samples; i++) {
        vec3 ray = ray_through(sample_place(gl_FragCoord.xy, i));
        Hit hit = first_hit(view.eye, ray, view.node_count, view.most_steps);
        certain = hit.is_certain ? certain : 0.0;
        vec3 light = DEEP_WATER;
        if (hit.distance_m > 0.0) {
            vec3 point = view.eye + ray * hit.distance_m;
            light = shows(pixel, point, hit.normal, SAME_PLACE) ? color_of(pixel) : light_from(point, hit.normal);
        }
        sum += min(light, vec3(1.0));
    }
    color = vec4(sum / float(view.samples), certain);
}
