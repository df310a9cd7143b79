// Section "Shadowing of the gas": the ray towards the light is traced through every volume, in increments of the
// volume's step, the last one scaled. Sampled in their middles: the jitter of the viewer's ray makes one value noisy,
// here it would make all of them so. Bricks without density are left at once (empty-*.glsl).

float optical_depth_to_light(vec3 point) {
    LightRay to_light = ray_to_light(point);
    float sum = 0.0;
    uint v = 0u;
    for (; v < volume_count; v++) {
        take_volume(v);
        vec2 segment = intersect(volume_segment(point, to_light.direction), vec2(0.0, to_light.distance_m));
        float length_m = segment.y - segment.x;
        float step_m = in_hand.step_m;
        float in_volume = 0.0;
        uint count = length_m > 0.0 ? uint(ceil(length_m / step_m)) : 0u;
        uint i = 0u;
        do {
            float from = float(i) * step_m;
            float increment = clamp(length_m - from, 0.0, step_m);
            vec3 center = point + to_light.direction * (segment.x + from + 0.5 * increment);
            float clear_m = empty_m(center, to_light.direction);
            if (clear_m > 0.0) {
                // On to the increment that the brick ends in.
                float end_m = min(from + 0.5 * increment + clear_m, length_m);
                i = max(i + 1u, min(uint(end_m / step_m), count)) - 1u;
            } else if (count > 0u) {
                in_volume += volume_density(center) * increment;
            }
            if (i < count) {
                i++;
            }
        } while (i < count);
        is_cut = is_cut || i < count;
        sum += in_hand.tau_per_m * in_volume;
    }
    is_cut = is_cut || v < volume_count;
    return sum;
}

// Of the light in hand.
float transmittance_to(uint l, vec3 point) {
    return exp(-optical_depth_to_light(point));
}
