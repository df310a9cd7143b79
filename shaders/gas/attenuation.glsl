// The fragment structure's "light attenuation values for each light": the fraction of the light that the gas takes, 1 -
// exp(-tau sum), for each visible fragment. Surfaces cast no shadows; a surface that faces away from a light has no use
// for the value.

layout(local_size_x = 8, local_size_y = 8) in;

#include "gas/nodes.glsl"

layout(set = 0, binding = 9, std430) readonly buffer Surfaces {
    uvec4 surfaces[]; // each a Surface
};

layout(set = 0, binding = 10, std430) readonly buffer Colors {
    uvec2 colors[]; // each a Color
};

layout(set = 0, binding = 14, std430) buffer Attenuations {
    float attenuations[]; // of each fragment, for each light
};

void main() {
    read_counts();
    read_volumes();
    read_lights();
    uvec2 pixel = pixel_of(gl_GlobalInvocationID.xy);
    if (!is_in_band(pixel)) {
        return;
    }
    uint list = list_of(pixel);
    uint pixel_index = pixel.y * frame.size.x + pixel.x;
    if (!is_due(LIGHT_ATTENUATION, list)) {
        return;
    }
    vec3 ray = ray_direction(vec2(pixel) + 0.5);
    uint f = NONE;
    uint covered = 0u;
    bool is_shown_through = false; // by the fragment before, which it intersects
    uint l = 0u; // the fragment's next light
    State before = NO_STATE;
    if (is_carried(LIGHT_ATTENUATION)) {
        before = state_of(list);
        f = before.a.x;
        covered = before.a.y;
        is_shown_through = before.a.z != 0u;
        l = before.a.w;
        take_up(before.b, before.c);
    } else {
        f = fragment_at(heads[list]);
    }
    bool is_done = f == NONE;
    bool is_stopped = is_done;
    do {
        Link link = Link(NONE, 0u, 0.0, 0.0);
        uvec4 surface = uvec4(0u);
        if (!is_done) {
            link = link_at(f);
            link.next = fragment_at(link.next);
            surface = surfaces[f];
        }
        bool is_seen = (link.mask & ~covered) != 0u || is_shown_through;
        if (!is_done && is_seen) {
            vec3 point = frame.eye + ray * mean_depth(link);
            vec3 normal = unpack_normal(surface.x);
            normal = dot(normal, ray) > 0.0 ? -normal : normal;
            do {
                take_light(l);
                float passed = 1.0;
                if (dot(normal, ray_to_light(point).direction) > 0.0) {
                    passed = passed_to_surface(l, point, pixel_index, surface.z);
                }
                if (!is_cut) {
                    attenuations[f * light_count + l] = 1.0 - passed;
                    l++;
                }
            } while (all(bvec2(l < light_count, !is_cut)));
        }
        is_stopped = is_done || is_cut || (is_seen && l < light_count);
        if (!is_stopped) {
            if (is_seen) {
                is_shown_through = false;
                if (link.next != NONE) {
                    Link next = link_at(link.next);
                    is_shown_through = surfaces[link.next].y != surface.y && (link.mask & next.mask) != 0u
                        && fraction_behind(link, next) > 0.0;
                }
            }
            if (opacity_of(Color(0u, colors[f].y)) >= 1.0) {
                covered |= link.mask;
            }
            f = link.next;
            l = 0u;
            is_done = f == NONE || (covered == 0xffffffffu && !is_shown_through);
            made++;
            is_stopped = made >= MOST_MADE;
        }
    } while (all(bvec2(!is_done, !is_stopped)));
    uvec4 state = uvec4(f, covered, uint(is_shown_through), l);
    leave(LIGHT_ATTENUATION, list, is_done, before, State(state, first_left(), second_left()));
}
