// The fraction of a light that reaches a surface, the mean of as many ways as an increment has samples. Their numbers follow
// from pixel, triangle and light, not from the fragment's slot, which differs from run to run.

float passed_to_surface(uint l, vec3 point, uint pixel_index, uint triangle) {
    float sum = 0.0;
    uint way = 0u;
    for (; way < sample_count && !is_cut; way++) {
        begin_way(pixel_index, scramble(triangle * MAX_LIGHTS + l + 0x51ed270bu) + way);
        sum += transmittance_to(l, point);
    }
    is_cut = is_cut || way < sample_count;
    return sum / float(sample_count);
}
