// Where a last subsegment, as short as a texel of the level it is met at, first crosses the interpolated surface of that level:
// -1 where it does not. It crosses at most three cells, and meets the surface in one of them; a comparison of its two ends
// alone would pass through crests.

// The fraction of a line at which a coordinate crosses a border between cells; 1 where it crosses none.
float border_between(float from, float to) {
    float border = max(floor(from), floor(to));
    bool crosses = floor(from) != floor(to) && from != to;
    return crosses ? clamp((border - from) / (to - from), 0.0, 1.0) : 1.0;
}

float crossing_of(int shift, vec3 near_nodes, vec3 far_nodes) {
    // A coarser level's texel stands in the middle of the nodes that it covers.
    float size = exp2(-float(shift));
    vec3 near = vec3(near_nodes.xy * size + (0.5 * size - 0.5), near_nodes.z);
    vec3 far = vec3(far_nodes.xy * size + (0.5 * size - 0.5), far_nodes.z);
    vec3 whole = far - near;
    float u = border_between(near.x, far.x);
    float v = border_between(near.y, far.y);
    float ends[4] = float[4](0.0, min(u, v), max(u, v), 1.0);
    vec2 last_cell = vec2(max(last_texel(shift) - 1, 0));
    float result = -1.0;
    for (int i = 0; i < 3; i++) {
        float length_ = ends[i + 1] - ends[i];
        if (result < 0.0 && length_ > 0.0) {
            vec3 from = near + ends[i] * whole;
            vec2 middle = from.xy + 0.5 * length_ * whole.xy;
            vec2 cell = clamp(floor(middle), vec2(0.0), last_cell);
            // Beyond the outermost texels' middles the surface stays as it is there.
            vec2 first = clamp(from.xy - cell, vec2(0.0), vec2(1.0));
            vec2 last = clamp(from.xy + length_ * whole.xy - cell, vec2(0.0), vec2(1.0));
            float t = touch(shift, ivec2(cell), vec3(first, from.z), vec3(last - first, length_ * whole.z));
            result = t >= 0.0 ? ends[i] + t * length_ : -1.0;
        }
    }
    return result;
}
