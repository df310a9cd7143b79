// Section "Shadowing of the gas": the ray towards the light is traced through every volume, in increments of the
// volume's step, the last one scaled. Sampled in their middles: the jitter of the viewer's ray makes one value noisy,
// here it would make all of them so.

float optical_depth_to(uint l, vec3 point) {
    LightRay to_light = ray_to_light(l, point);
    float sum = 0.0;
    for (uint v = 0u; v < counts.volumes; v++) {
        vec2 segment = intersect(volume_segment(v, point, to_light.direction), vec2(0.0, to_light.distance_m));
        float length_m = segment.y - segment.x;
        if (length_m <= 0.0) {
            continue;
        }
        float step_m = volumes[v].step_m;
        float in_volume = 0.0;
        for (float from = 0.0; from < length_m; from += step_m) {
            float increment = min(step_m, length_m - from);
            vec3 center = point + to_light.direction * (segment.x + from + 0.5 * increment);
            in_volume += volume_density(v, center) * increment;
        }
        sum += volumes[v].tau_per_m * in_volume;
    }
    return sum;
}
