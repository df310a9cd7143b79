// Section 3: a ray is a voxel between two points (eq. 8) that is halved (eq. 12), the near half first and then the far one,
// until it lies above everything that the altitude map has below it or is short enough to be intersected. No stack: the
// segment at a depth of d is number k of 2^d, and the next one after it is found by counting.
//
// The level follows the segment's projection: 1/2^(level + 1) < Lp <= 1/2^level, Lp being the larger of its sides as a share
// of the map. Printed is the impossible 1/2^level < Lp < 1/2^(level + 1). Where the segment still touches three texels in a
// row of that level, the next coarser one answers for all that it touches with four at most.
//
// One of the leaf files before this one says when subdivision ends and what is met then.

// Narrows `range` to where a coordinate lies between two bounds.
vec2 between(vec2 range, float eye, float direction, float low, float high) {
    float inverse = 1.0 / (abs(direction) < 1.0e-20 ? 1.0e-20 : direction);
    float a = (low - eye) * inverse;
    float b = (high - eye) * inverse;
    return vec2(max(range.x, min(a, b)), min(range.y, max(a, b)));
}

Span clip(vec3 direction, float limit_m) {
    vec2 all = vec2(0.0, limit_m);
    vec2 last = vec2(land.size.xy - 1);
    vec2 u = between(all, land.eye.x, direction.x, 0.0, last.x);
    vec2 v = between(all, land.eye.y, direction.y, 0.0, last.y);
    vec2 h = between(all, land.eye.z, direction.z, land.bounds.x - land.margin.y, land.bounds.y + land.margin.y);
    float near_m = max(max(u.x, v.x), h.x);
    int side = direction.x > 0.0 ? WALL_WEST : WALL_EAST;
    if (v.x > u.x) {
        side = direction.y > 0.0 ? WALL_NORTH : WALL_SOUTH;
    }
    if (h.x >= max(u.x, v.x)) {
        side = TERRAIN;
    }
    if (near_m <= 0.0) {
        side = INSIDE;
    }
    return Span(near_m, min(min(u.y, v.y), h.y), side);
}

// The smallest number of levels above the data whose texels are as large as the extent, in nodes.
int shift_for(float extent) {
    int exponent = ((floatBitsToInt(extent) + 0x7fffff) >> 23) - 127;
    return clamp(exponent, 0, land.size.z);
}

// The highest value of every texel that reaches into the segment's rectangle. Interpolation reads the node beyond.
float highest_below(Segment segment, int shift) {
    vec2 low = min(segment.near.xy, segment.far.xy) - land.margin.x;
    vec2 high = max(segment.near.xy, segment.far.xy) + land.margin.x;
    ivec2 first = clamp(ivec2(floor(low)), ivec2(0), land.size.xy - 1);
    ivec2 last = clamp(ivec2(floor(high)) + 1, ivec2(0), land.size.xy - 1);
    ivec2 touched = (last >> shift) - (first >> shift);
    int most = max(touched.x, touched.y);
    int level = min(shift + (most > 1 ? 1 : 0) + (most > 2 ? 1 : 0), land.size.z);
    first = first >> level;
    last = last >> level;
    float north = max(highest_at(level, first), highest_at(level, ivec2(last.x, first.y)));
    float south = max(highest_at(level, ivec2(first.x, last.y)), highest_at(level, last));
    return max(north, south);
}

// The first place where the ray is not above the surface; a miss beyond `limit_m`.
Hit trace(vec3 direction, float limit_m) {
    Span span = clip(direction, limit_m);
    vec3 origin = land.eye.xyz + span.near_m * direction;
    vec3 whole = (span.far_m - span.near_m) * direction;
    bool done = !(span.near_m < span.far_m);
    Hit hit = miss();
    if (!done) {
        // Terrain is solid below its height: a wall at the map's edge, or the inside of the mountain.
        int shift = finest_shift(span.near_m);
        if (origin.z <= surface_at(shift, origin.xy)) {
            hit = Hit(span.near_m, origin.xy, surface_code(span.side, shift));
            done = true;
        }
    }
    uint k = 0u;
    int depth = 0;
    while (!done) {
        bool found = false;
        Segment segment = Segment(origin, origin, span.near_m);
        float size = 1.0;
        while (!found && !done) {
            size = exp2(-float(depth));
            float start = float(k) * size;
            segment.near = origin + start * whole;
            segment.far = origin + (start + size) * whole;
            segment.depth_m = span.near_m + start * (span.far_m - span.near_m);
            vec2 extent = abs(segment.far.xy - segment.near.xy);
            int shift = shift_for(max(extent.x, extent.y));
            COUNT_STEP
            if (min(segment.near.z, segment.far.z) - land.margin.y > highest_below(segment, shift)) {
                int up = findLSB(~k);
                k = (k >> up) + 1u;
                depth -= up;
                done = (k >> depth) != 0u;
            } else if (is_leaf(segment, shift) || depth >= DEEPEST) {
                found = true;
            } else {
                k = 2u * k;
                depth += 1;
            }
        }
        if (found) {
            float part = intersect(segment);
            if (part >= 0.0) {
                vec3 place = mix(segment.near, segment.far, part);
                float depth_m = segment.depth_m + part * size * (span.far_m - span.near_m);
                hit = Hit(depth_m, place.xy, surface_code(TERRAIN, finest_shift(depth_m)));
                done = true;
            } else {
                int up = findLSB(~k);
                k = (k >> up) + 1u;
                depth -= up;
                done = (k >> depth) != 0u;
            }
        }
    }
    return hit;
}
