// Section "Shadowing of the gas": the ray towards the light is traced through every volume, in increments of the volume's step, the last
// one scaled. Sampled in their middles: the jitter of the viewer's ray makes one value noisy, here it would make all of them so.

float optical_depth_to(uint l, vec3 point) {
    vec4 way = towards_light(l, point);
    float sum = 0.0;
    for (uint v = 0u; v < frame.counts.w; v++) {
        vec2 span = meet(volume_span(v, point, way.xyz), vec2(0.0, way.w));
        float length_m = span.y - span.x;
        if (length_m <= 0.0) {
            continue;
        }
        float step_m = volumes[v].profile.w;
        float in_volume = 0.0;
        for (float from = 0.0; from < length_m; from += step_m) {
            float increment = min(step_m, length_m - from);
            in_volume += volume_density(v, point + way.xyz * (span.x + from + 0.5 * increment)) * increment;
        }
        sum += volumes[v].optics.x * in_volume;
    }
    return sum;
}
