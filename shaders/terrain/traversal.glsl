// Section 3: a ray is a voxel between two points (eq. 8) that is halved (eq. 12), the near half first and then the far one,
// until it lies above everything that the altitude map has below it or is short enough to be intersected. No stack: the ray
// is WHOLE units long, and after a subsegment comes the longest that halving can make begin where it ends.
//
// The level follows the subsegment's projection: 1/2^(level + 1) < Lp <= 1/2^level, Lp being the larger of its sides as a fraction
// of the map. Printed is the impossible 1/2^level < Lp < 1/2^(level + 1). Where the subsegment still touches more than four
// texels of that level, a coarser one answers for all that it touches.
//
// Before this file stand one for the base, one for the interpolation and one for where subdivision ends.

#include "terrain/crossing.glsl"
#include "terrain/halves.glsl"

// A height above everything that interpolation reads between two places; far below all heights where no map is.
float highest_below(vec2 low, vec2 high, int shift) {
    vec2 end = vec2(map.last);
    bool is_outside = high.x < 0.0 || high.y < 0.0 || low.x > end.x || low.y > end.y;
    ivec4 nodes = nodes_between(clamp(low, vec2(0.0), end), clamp(high, vec2(0.0), end));
    nodes = ivec4(max(nodes.xy, ivec2(0)), min(nodes.zw, map.last));
    ivec2 touched = (nodes.zw >> shift) - (nodes.xy >> shift);
    int level = min(shift + shift_for(float(max(touched.x, touched.y))), map.top);
    float highest = highest_of(level, nodes.xy >> level, nodes.zw >> level);
    return is_outside ? -NO_DEPTH : highest;
}

// The first place where the ray is not above the map's surface, if before `limit_m`; `before` if not.
Hit trace(vec3 eye, vec3 direction, float limit_m, Hit before) {
    RaySegment ray = ray_segment(eye, direction, limit_m);
    Subsegment subsegment;
    Hit hit = before;
    vec3 near = vec3(0.0);
    bool done = !(ray.near_m < ray.far_m);
    if (!done) {
        int shift = finest_shift(ray.near_m);
        near = first_point(ray);
        int surface = entry_surface(ray, near, height_at(shift, near.xy));
        if (surface != 0) {
            hit = Hit(ray.near_m, near.xy, surface_code(surface, shift, 1));
            done = true;
        }
    }
    if (done) {
        return hit;
    }
    float rounding_nodes = terrain.rounding_nodes;
    float rounding_height = terrain.rounding_height;
    float t = -1.0; // along what of the last subsegment is over the map
    int steps = 0;
    int at = 0;
    int units = first_units(ray, WHOLE);
    // Ends are asked for after a step: where they are asked for before, processors run one more step for all rays, to no end.
    while (true) {
        bool is_last = false;
        while (true) {
            subsegment = subsegment_of(ray, near, float(at) / float(WHOLE), float(units) / float(WHOLE));
            vec3 slack = slack_of(subsegment);
            vec2 low = min(subsegment.near.xy, subsegment.far.xy) - slack.xy;
            vec2 high = max(subsegment.near.xy, subsegment.far.xy) + slack.xy;
            int shift = shift_for(max(high.x - low.x, high.y - low.y));
            int finest = finest_shift(subsegment.depth_m);
            float lowest = min(subsegment.near.z, subsegment.far.z) - slack.z - rounding_height;
            steps += 1;
            if (lowest > highest_below(low - rounding_nodes, high + rounding_nodes, shift)) {
                at += units;
                units = at & -at;
                near = next_point(ray, subsegment, float(at) / float(WHOLE));
                done = at >= WHOLE;
            } else if ((shift <= finest && is_straight(slack, finest)) || units == 1) {
                is_last = true;
            } else {
                units >>= 1;
            }
            if (is_last || done) {
                break;
            }
        }
        if (is_last) {
            Clip clip = clip_to_map(subsegment);
            if (clip.near <= clip.far) {
                t = crossing_of(finest_shift(subsegment.depth_m), point_on(subsegment, clip.near),
                                point_on(subsegment, clip.far));
            }
            done = t >= 0.0;
            if (!done) {
                at += units;
                units = at & -at;
                near = next_point(ray, subsegment, float(at) / float(WHOLE));
                done = at >= WHOLE;
            }
        }
        if (done) {
            break;
        }
    }
    // Not `!done`: compilers know that the loop ends with it.
    if (t < 0.0 && at < WHOLE) {
        hit = UNFINISHED;
    }
    if (t >= 0.0) {
        Clip clip = clip_to_map(subsegment);
        float fraction = mix(clip.near, clip.far, t);
        float depth_m = depth_at(ray, (float(at) + fraction * float(units)) / float(WHOLE));
        int surface = t > 0.0 ? TERRAIN : clip.surface;
        hit = Hit(depth_m, point_on(subsegment, fraction).xy, surface_code(surface, finest_shift(depth_m), steps));
    }
    return hit;
}
