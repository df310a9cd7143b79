// The fragment structure's "light attenuation values for each light": the fraction of the light that the gas takes, 1 -
// exp(-tau sum), for each visible fragment. Surfaces cast no shadows; a surface that faces away from a light has no use
// for the value.

layout(local_size_x = 8, local_size_y = 8) in;

#include "gas/nodes.glsl"

layout(set = 0, binding = 9, std430) readonly buffer Surfaces {
    Surface surfaces[];
};

layout(set = 0, binding = 10, std430) readonly buffer Colors {
    Color colors[];
};

layout(set = 0, binding = 14, std430) buffer Attenuations {
    float attenuations[]; // of each fragment, for each light
};

void main() {
    uvec2 pixel = pixel_of(gl_GlobalInvocationID.xy);
    if (!is_in_band(pixel)) {
        return;
    }
    vec3 ray = ray_direction(vec2(pixel) + 0.5);
    uint covered = 0u;
    bool is_shown_through = false; // by the fragment before, which it intersects
    uint f = fragment_at(heads[list_of(pixel)]);
    while (f != NONE) {
        Link link = link_at(f);
        link.next = fragment_at(link.next);
        Surface surface = surfaces[f];
        if ((link.mask & ~covered) != 0u || is_shown_through) {
            vec3 point = frame.eye + ray * mean_depth(link);
            vec3 normal = unpack_normal(surface.normal);
            normal = dot(normal, ray) > 0.0 ? -normal : normal;
            for (uint l = 0u; l < counts.lights; l++) {
                float depth = 0.0;
                if (dot(normal, ray_to_light(l, point).direction) > 0.0) {
                    depth = optical_depth_to(l, point);
                }
                attenuations[f * counts.lights + l] = 1.0 - exp(-depth);
            }
            is_shown_through = false;
            if (link.next != NONE) {
                Link next = link_at(link.next);
                is_shown_through = surfaces[link.next].object != surface.object && (link.mask & next.mask) != 0u
                    && fraction_behind(link, next) > 0.0;
            }
        }
        if (opacity_of(colors[f]) >= 1.0) {
            covered |= link.mask;
        }
        if (covered == 0xffffffffu && !is_shown_through) {
            break;
        }
        f = link.next;
    }
}
