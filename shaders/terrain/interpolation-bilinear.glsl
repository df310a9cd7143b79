// `--interpolation bilinear`: eq. 7.

// Four corner values: north-west, north-east, south-west, south-east.
vec4 corners_at(int shift, ivec2 a) {
    ivec2 b = min(a + 1, last_texel(shift));
    return vec4(highest_at(shift, a), highest_at(shift, ivec2(b.x, a.y)), highest_at(shift, ivec2(a.x, b.y)),
                highest_at(shift, b));
}

float height_at(int shift, vec2 place) {
    vec4 cell = cell_at(shift, place);
    vec4 corners = corners_at(shift, ivec2(cell.xy));
    vec2 ends = mix(corners.xz, corners.yw, cell.z);
    return mix(ends.x, ends.y, cell.w);
}

// Change of the height over a texel of the level along u and v.
vec2 slope_at(int shift, vec2 place) {
    vec4 cell = cell_at(shift, place);
    vec4 c = corners_at(shift, ivec2(cell.xy));
    return vec2(mix(c.y - c.x, c.w - c.z, cell.w), mix(c.z - c.x, c.w - c.y, cell.z));
}

// The nodes that interpolation between two places reads.
ivec4 nodes_between(vec2 low, vec2 high) {
    return ivec4(ivec2(floor(low)), ivec2(floor(high)) + 1);
}

// No interpolated height is above the highest node.
float highest_of(int level, ivec2 a, ivec2 b) {
    float north = max(highest_at(level, a), highest_at(level, ivec2(b.x, a.y)));
    float south = max(highest_at(level, ivec2(a.x, b.y)), highest_at(level, b));
    return max(north, south);
}

// Where a line that moves by `way` from `from` inside the cell first touches its surface, as a part of `way`; -1 where it does
// not. Along a line the surface is a quadratic.
float touch(ivec2 cell, vec3 from, vec3 way) {
    vec4 corners = corners_at(0, cell);
    float a = corners.x;
    float b = corners.y - a;
    float c = corners.z - a;
    float e = corners.w - corners.y - c;
    float qa = -e * way.x * way.y;
    float qb = way.z - b * way.x - c * way.y - e * (from.x * way.y + from.y * way.x);
    float qc = from.z - (a + b * from.x + c * from.y + e * from.x * from.y);
    float discriminant = qb * qb - 4.0 * qa * qc;
    float root = sqrt(max(discriminant, 0.0));
    // The smaller positive root of a function that begins above zero, without cancellation.
    float denominator = qb < 0.0 ? root - qb : -2.0 * qa;
    float numerator = qb < 0.0 ? 2.0 * qc : qb + root;
    float part = numerator / (denominator > 0.0 ? denominator : 1.0);
    bool is_met = discriminant >= 0.0 && denominator > 0.0 && part <= 1.0;
    if (qc <= 0.0) {
        part = 0.0;
    }
    if (qc > 0.0 && !is_met) {
        part = qa + qb + qc <= 0.0 ? 1.0 : -1.0;
    }
    return part;
}
