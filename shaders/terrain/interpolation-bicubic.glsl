// `--interpolation bicubic`: Catmull-Rom, through the samples and smooth. The paper names bicubic interpolation and prints none.

// The sixteen values around a cell: rows from north to south, borders repeated.
mat4 values_around(int shift, ivec2 cell) {
    ivec2 last = last_texel(shift);
    mat4 values = mat4(0.0);
    for (int row = 0; row < 4; row++) {
        int y = clamp(cell.y + row - 1, 0, last.y);
        values[row] = vec4(highest_at(shift, ivec2(clamp(cell.x - 1, 0, last.x), y)), highest_at(shift, ivec2(cell.x, y)),
                           highest_at(shift, ivec2(min(cell.x + 1, last.x), y)),
                           highest_at(shift, ivec2(min(cell.x + 2, last.x), y)));
    }
    return values;
}

vec4 weights(float t) {
    return 0.5 * vec4(t * (-1.0 + t * (2.0 - t)), 2.0 + t * t * (3.0 * t - 5.0), t * (1.0 + t * (4.0 - 3.0 * t)),
                      t * t * (t - 1.0));
}

vec4 weight_slopes(float t) {
    return 0.5 * vec4(-1.0 + t * (4.0 - 3.0 * t), t * (9.0 * t - 10.0), 1.0 + t * (8.0 - 9.0 * t), t * (3.0 * t - 2.0));
}

float height_at(int shift, vec2 place) {
    vec4 cell = cell_at(shift, place);
    return dot(weights(cell.z) * values_around(shift, ivec2(cell.xy)), weights(cell.w));
}

// Change of the height over a texel of the level along u and v.
vec2 slope_at(int shift, vec2 place) {
    vec4 cell = cell_at(shift, place);
    mat4 values = values_around(shift, ivec2(cell.xy));
    return vec2(dot(weight_slopes(cell.z) * values, weights(cell.w)), dot(weights(cell.z) * values, weight_slopes(cell.w)));
}

// The nodes that interpolation between two places reads.
ivec4 nodes_between(vec2 low, vec2 high) {
    return ivec4(ivec2(floor(low)) - 1, ivec2(floor(high)) + 2);
}

float lowest_at(int shift, ivec2 texel) {
    return value_in(2, shift, texel);
}

// Catmull-Rom surfaces exceed their nodes by up to 9/32 of the nodes' range: the negative weights sum to -9/32.
float highest_of(int level, ivec2 a, ivec2 b) {
    ivec2 ab = ivec2(a.x, b.y);
    ivec2 ba = ivec2(b.x, a.y);
    float high = max(max(highest_at(level, a), highest_at(level, ba)), max(highest_at(level, ab), highest_at(level, b)));
    float low = min(min(lowest_at(level, a), lowest_at(level, ba)), min(lowest_at(level, ab), lowest_at(level, b)));
    return high + 9.0 / 32.0 * (high - low);
}

// The part from `s` to `e` of four curves at once, given and left as Bezier points.
mat4 restricted(mat4 p, float s, float e) {
    vec4 s0 = mix(p[0], p[1], s);
    vec4 s1 = mix(p[1], p[2], s);
    vec4 s2 = mix(p[2], p[3], s);
    vec4 e1 = mix(p[1], p[2], e);
    vec4 e0 = mix(p[0], p[1], e);
    vec4 e2 = mix(p[2], p[3], e);
    vec4 ss0 = mix(s0, s1, s);
    vec4 ss1 = mix(s1, s2, s);
    return mat4(mix(ss0, ss1, s), mix(ss0, ss1, e), mix(mix(s0, s1, e), mix(s1, s2, e), e),
                mix(mix(e0, e1, e), mix(e1, e2, e), e));
}

// Catmull-Rom values as Bezier points.
mat4 bezier(mat4 p) {
    return mat4(p[1], p[1] + (p[2] - p[0]) / 6.0, p[2] - (p[3] - p[1]) / 6.0, p[2]);
}

// Where a line that moves by `way` from `from` inside the cell first touches its surface, as a part of `way`; -1 where it does
// not. Along a line the surface is of the sixth degree. Its Bezier points bound it, so the line is free up to where their hull
// meets it; what is left is restricted and bounded anew. This approaches the first root from the near side and misses none. The hull's
// lower edge may start at any point above, not only at the first.
float touch(ivec2 cell, vec3 from, vec3 way) {
    mat4 values = values_around(0, cell);
    float reference = values[1].y;
    for (int row = 0; row < 4; row++) {
        values[row] -= vec4(reference);
    }
    mat4 patch_points = transpose(restricted(bezier(values), from.y, from.y + way.y));
    mat4 c = restricted(bezier(patch_points), from.x, from.x + way.x);
    float above = from.z - reference;
    float rise = way.z / 6.0;
    float g[7] = float[7](above - c[0].x, above + rise - 0.5 * (c[0].y + c[1].x),
                          above + 2.0 * rise - (c[0].z + 3.0 * c[1].y + c[2].x) / 5.0,
                          above + 3.0 * rise - (c[0].w + 9.0 * (c[1].z + c[2].y) + c[3].x) / 20.0,
                          above + 4.0 * rise - (c[1].w + 3.0 * c[2].z + c[3].y) / 5.0,
                          above + 5.0 * rise - 0.5 * (c[2].w + c[3].z), above + 6.0 * rise - c[3].w);
    float start = 0.0;
    bool is_done = g[0] <= 0.0;
    for (int step = 0; step < 40 && !is_done; step++) {
        float free = 2.0;
        for (int k = 1; k < 7; k++) {
            for (int i = 0; i < k; i++) {
                bool is_edge = g[i] > 0.0 && g[k] <= 0.0;
                float fall = is_edge ? g[i] - g[k] : 1.0;
                free = is_edge ? min(free, (float(i) + float(k - i) * g[i] / fall) / 6.0) : free;
            }
        }
        if (free > 1.0) {
            start = -1.0;
            is_done = true;
        } else {
            for (int j = 1; j < 7; j++) {
                for (int k = 0; k < 7 - j; k++) {
                    g[k] = mix(g[k], g[k + 1], free);
                }
            }
            start += free * (1.0 - start);
            is_done = g[0] <= terrain.height_tolerance;
        }
    }
    return start;
}
