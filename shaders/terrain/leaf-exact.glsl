// `--lod exact`: the last subsegment crosses at most three cells of the data, and meets the surface in one of them.

int finest_shift(float depth_m) {
    return 0;
}

// The fraction of a line at which a coordinate crosses a border between cells; 1 where it crosses none.
float border_between(float from, float to) {
    float border = max(floor(from), floor(to));
    bool crosses = floor(from) != floor(to) && from != to;
    return crosses ? clamp((border - from) / (to - from), 0.0, 1.0) : 1.0;
}

Crossing crossing_of(vec3 near, vec3 far, float depth_m) {
    vec3 whole = far - near;
    float u = border_between(near.x, far.x);
    float v = border_between(near.y, far.y);
    float ends[4] = float[4](0.0, min(u, v), max(u, v), 1.0);
    float result = -1.0;
    for (int i = 0; i < 3; i++) {
        float size = ends[i + 1] - ends[i];
        if (result < 0.0 && size > 0.0) {
            vec3 from = near + ends[i] * whole;
            vec2 cell = cell_at(0, from.xy + 0.5 * size * whole.xy).xy;
            float t = touch(ivec2(cell), vec3(from.xy - cell, from.z), size * whole);
            result = t >= 0.0 ? ends[i] + t * size : -1.0;
        }
    }
    return Crossing(result, 0.0);
}

float refined(Crossing crossing, vec3 near, vec3 far, float depth_m) {
    return crossing.t;
}
