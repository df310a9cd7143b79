// The surface between the samples: `--interpolation bilinear` is eq. 7, `bicubic` is Catmull-Rom, through the samples and
// smooth. The paper names bicubic interpolation and prints none.

#ifdef INTERPOLATION_BICUBIC
// Nodes that a cell's surface reads before and after the one at its corner.
const ivec2 REACH = ivec2(1, 2);

// The sixteen values around a cell: rows from north to south, borders repeated.
mat4 values_around(int shift, ivec2 cell) {
    ivec2 last = last_texel(shift);
    mat4 values = mat4(0.0);
    for (int row = 0; row < 4; row++) {
        int y = clamp(cell.y + row - 1, 0, last.y);
        for (int column = 0; column < 4; column++) {
            values[row][column] = highest_at(shift, ivec2(clamp(cell.x + column - 1, 0, last.x), y));
        }
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

float surface_height(mat4 values, vec2 uv) {
    return dot(weights(uv.x) * values, weights(uv.y));
}

vec2 surface_slope(mat4 values, vec2 uv) {
    return vec2(dot(weight_slopes(uv.x) * values, weights(uv.y)), dot(weights(uv.x) * values, weight_slopes(uv.y)));
}

// The curves from `s` to `e` of four at once, given and left as Bezier points.
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

// The ray parameter, 0 to 1, at which a line from `from` along `direction` inside the cell first touches its surface; -1
// where it does not. Along a line the surface is of the sixth degree. Its Bezier points bound it, so the line is free up
// to where their hull meets it; what is left is restricted and bounded anew. This approaches the first root from the near
// side and misses none. The hull's lower edge may start at any point above, not only at the first.
float touch(int shift, ivec2 cell, vec3 from, vec3 direction) {
    mat4 values = values_around(shift, cell);
    float reference = values[1].y;
    for (int row = 0; row < 4; row++) {
        values[row] -= vec4(reference);
    }
    mat4 patch_points = transpose(restricted(bezier(values), from.y, from.y + direction.y));
    mat4 c = restricted(bezier(patch_points), from.x, from.x + direction.x);
    float above = from.z - reference;
    float rise = direction.z / 6.0;
    float g[7] = float[7](above - c[0].x, above + rise - 0.5 * (c[0].y + c[1].x),
                          above + 2.0 * rise - (c[0].z + 3.0 * c[1].y + c[2].x) / 5.0,
                          above + 3.0 * rise - (c[0].w + 9.0 * (c[1].z + c[2].y) + c[3].x) / 20.0,
                          above + 4.0 * rise - (c[1].w + 3.0 * c[2].z + c[3].y) / 5.0,
                          above + 5.0 * rise - 0.5 * (c[2].w + c[3].z), above + 6.0 * rise - c[3].w);
    float start = 0.0;
    float tolerance = terrain.height_tolerance * exp2(float(shift));
    bool is_done = g[0] <= 0.0;
    int step = 0;
    for (; step < 40 && !is_done; step++) {
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
            is_done = g[0] <= tolerance;
        }
    }
    // Ended before its time: see UNFINISHED. What follows must not take the place for the surface.
    return is_done || step == 40 ? start : -1.0;
}
#else
const ivec2 REACH = ivec2(0, 1);

// The values at a cell's corners: north-west, north-east, south-west, south-east.
vec4 values_around(int shift, ivec2 a) {
#ifdef IS_PACKED
    return corners_of(shift, a);
#else
    ivec2 b = min(a + 1, last_texel(shift));
    return vec4(highest_at(shift, a), highest_at(shift, ivec2(b.x, a.y)), highest_at(shift, ivec2(a.x, b.y)),
                highest_at(shift, b));
#endif
}

float surface_height(vec4 values, vec2 uv) {
    vec2 ends = mix(values.xz, values.yw, uv.x);
    return mix(ends.x, ends.y, uv.y);
}

vec2 surface_slope(vec4 c, vec2 uv) {
    return vec2(mix(c.y - c.x, c.w - c.z, uv.y), mix(c.z - c.x, c.w - c.y, uv.x));
}

// The ray parameter, 0 to 1, at which a line from `from` along `direction` inside the cell first touches its surface; -1
// where it does not. Along a line the surface is a quadratic.
float touch(int shift, ivec2 cell, vec3 from, vec3 direction) {
    vec4 corners = values_around(shift, cell);
    float a = corners.x;
    float b = corners.y - a;
    float c = corners.z - a;
    float e = corners.w - corners.y - c;
    float qa = -e * direction.x * direction.y;
    float qb = direction.z - b * direction.x - c * direction.y - e * (from.x * direction.y + from.y * direction.x);
    float qc = from.z - (a + b * from.x + c * from.y + e * from.x * from.y);
    float discriminant = qb * qb - 4.0 * qa * qc;
    float root = sqrt(max(discriminant, 0.0));
    // The smaller positive root of a function that begins above zero, without cancellation.
    float denominator = qb < 0.0 ? root - qb : -2.0 * qa;
    float numerator = qb < 0.0 ? 2.0 * qc : qb + root;
    float t = numerator / (denominator > 0.0 ? denominator : 1.0);
    bool is_met = discriminant >= 0.0 && denominator > 0.0 && t <= 1.0;
    t = is_met ? t : (qa + qb + qc <= 0.0 ? 1.0 : -1.0);
    return qc <= 0.0 ? 0.0 : t;
}
#endif

float height_at(int shift, vec2 place) {
    vec4 cell = cell_at(shift, place);
    return surface_height(values_around(shift, ivec2(cell.xy)), cell.zw);
}

// The change of the height over a texel of the level along u and v.
vec2 slope_at(int shift, vec2 place) {
    vec4 cell = cell_at(shift, place);
    return surface_slope(values_around(shift, ivec2(cell.xy)), cell.zw);
}

// The nodes that interpolation between two places reads.
ivec4 nodes_between(vec2 low, vec2 high) {
    return ivec4(ivec2(floor(low)) - REACH.x, ivec2(floor(high)) + REACH.y);
}

// A height that no interpolated one exceeds where nothing but these four texels of a level and those between is read.
float highest_of(int level, ivec2 a, ivec2 b) {
    ivec2 ab = ivec2(a.x, b.y);
    ivec2 ba = ivec2(b.x, a.y);
    float highest = max(max(highest_at(level, a), highest_at(level, ba)), max(highest_at(level, ab), highest_at(level, b)));
#ifdef INTERPOLATION_BICUBIC
    float lowest = min(min(lowest_at(level, a), lowest_at(level, ba)), min(lowest_at(level, ab), lowest_at(level, b)));
    // Catmull-Rom surfaces exceed their nodes by up to 9/32 of the nodes' range: the negative weights sum to -9/32.
    highest += 9.0 / 32.0 * (highest - lowest);
#endif
    return highest;
}
