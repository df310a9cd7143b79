// The fraction of a light that reaches a surface, the mean of as many ways as an increment has samples. Their numbers follow
// from pixel, triangle and light, not from the fragment's slot, which differs from run to run. A dispatch goes on with the
// way that the one before has left.

uint surface_way = 0u; // of the light in hand
float surface_sum = 0.0; // of the ways before it
uint surface_draws = 0u; // of its numbers

void take_up(uvec4 first, uvec3 second) {
    surface_way = first.x;
    surface_sum = uintBitsToFloat(first.y);
    surface_draws = first.z;
    uint counts_of_parts = second.y;
    light_way = LightWay(uintBitsToFloat(first.w), uintBitsToFloat(second.x), counts_of_parts >> 17u, counts_of_parts & 0x1ffffu);
}

uvec4 first_left() {
    return uvec4(surface_way, floatBitsToUint(surface_sum), surface_draws, floatBitsToUint(light_way.passed));
}

uvec3 second_left() {
    return uvec3(floatBitsToUint(light_way.at_m), light_way.volume << 17u | light_way.parts, 0u);
}

float passed_to_surface(uint l, vec3 point, uint pixel_index, uint triangle) {
    do {
        begin_way(pixel_index, scramble(triangle * MAX_LIGHTS + l + 0x51ed270bu) + surface_way, surface_draws);
        float passed = transmittance_to(l, point);
        if (is_cut) {
            surface_draws = way_draws;
        } else {
            surface_sum += passed;
            surface_way++;
            surface_draws = 0u;
        }
    } while (all(bvec2(surface_way < sample_count, !is_cut)));
    is_cut = is_cut || surface_way < sample_count;
    float mean = surface_sum / float(sample_count);
    if (!is_cut) {
        surface_way = 0u;
        surface_sum = 0.0;
    }
    return mean;
}
