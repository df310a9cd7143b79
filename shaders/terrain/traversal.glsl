// Section 3: a ray is a voxel between two points (eq. 8) that is halved (eq. 12), the near half first and then the far one,
// until it lies above everything that the altitude map has below it or is short enough to be intersected. No stack: the
// segment at a depth of d is number k of 2^d, and the next one after it is found by counting.
//
// The level follows the segment's projection: 1/2^(level + 1) < Lp <= 1/2^level, Lp being the larger of its sides as a share
// of the map. Printed is the impossible 1/2^level < Lp < 1/2^(level + 1). Where the segment still touches more than four
// texels of that level, a coarser one answers for all that it touches.
//
// Before this file stand one for the base, one for the interpolation and one for where subdivision ends.

// Halvings after which a segment is intersected whatever it touches.
const int DEEPEST = 23;
// How far a last segment may be from straight, in texels of the level that it is met at.
const float STRAIGHT = 2.5e-4;

// The smallest number of levels above the data whose texels are as large as the extent, in nodes.
int shift_for(float extent) {
    int exponent = ((floatBitsToInt(extent) + 0x7fffff) >> 23) - 127;
    return clamp(exponent, 0, land.size.z);
}

// A height above everything that interpolation reads between two places; far below all heights where no map is.
float highest_below(vec2 low, vec2 high, int shift) {
    vec2 end = vec2(land.size.xy - 1);
    bool is_outside = high.x < 0.0 || high.y < 0.0 || low.x > end.x || low.y > end.y;
    ivec4 nodes = clamp(nodes_between(max(low, vec2(-4.0)), min(high, end + 4.0)), ivec4(0), land.size.xyxy - 1);
    ivec2 touched = (nodes.zw >> shift) - (nodes.xy >> shift);
    int most = max(max(touched.x, touched.y), 1);
    int level = min(shift + findMSB(uint(2 * most - 1)), land.size.z);
    float highest = highest_of(level, nodes.xy >> level, nodes.zw >> level);
    return is_outside ? -NO_DEPTH : highest;
}

// The first place where the ray is not above the map's surface, if before `limit_m`; `before` if not.
Hit trace(vec3 eye, vec3 direction, float limit_m, Hit before) {
    Way way = way_of(eye, direction, limit_m);
    Hit hit = before;
    int steps = 0;
    bool done = !(way.near_m < way.far_m);
    if (!done) {
        Segment first = segment_of(way, 0.0, 0.0);
        int shift = finest_shift(way.near_m);
        int surface = entered(way, height_at(shift, first.near.xy));
        if (surface != 0) {
            hit = Hit(way.near_m, first.near.xy, surface_code(surface, shift, 1));
            done = true;
        }
    }
    uint k = 0u;
    int depth = first_depth(way);
    while (!done) {
        bool found = false;
        Segment segment = segment_of(way, 0.0, 0.0);
        float start = 0.0;
        float size = 1.0;
        while (!found && !done) {
            size = exp2(-float(depth));
            start = float(k) * size;
            segment = segment_of(way, start, size);
            vec3 slack = slack_of(way, segment, size);
            vec2 low = min(segment.near.xy, segment.far.xy) - slack.xy;
            vec2 high = max(segment.near.xy, segment.far.xy) + slack.xy;
            int shift = shift_for(max(high.x - low.x, high.y - low.y));
            int finest = finest_shift(segment.depth_m);
            float straight = STRAIGHT * exp2(float(finest));
            bool is_straight = max(slack.x, slack.y) <= straight && slack.z * land.bounds.w <= straight * land.margin.z;
            float lowest = min(segment.near.z, segment.far.z) - slack.z - land.margin.y;
            steps += 1;
            if (lowest > highest_below(low - land.margin.x, high + land.margin.x, shift)) {
                int up = findLSB(~k);
                k = (k >> up) + 1u;
                depth -= up;
                done = (k >> depth) != 0u;
            } else if ((shift <= finest && is_straight) || depth >= DEEPEST) {
                found = true;
            } else {
                k = 2u * k;
                depth += 1;
            }
        }
        if (found) {
            vec3 over = over_map(segment);
            vec3 near = mix(segment.near, segment.far, over.x);
            vec3 far = mix(segment.near, segment.far, over.y);
            int surface = int(over.z);
            float part = -1.0;
            if (over.x <= over.y) {
                part = intersect(near, far, segment.depth_m);
            }
            if (part >= 0.0) {
                float along = mix(over.x, over.y, part);
                float depth_m = depth_in(way, start + along * size);
                vec2 place = mix(segment.near.xy, segment.far.xy, along);
                hit = Hit(depth_m, place, surface_code(part > 0.0 ? TERRAIN : surface, finest_shift(depth_m), steps));
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
