// The traversal of the variants `dda-compute` and `dda-fragment` over a cylinder or an ellipsoid, where a ray is bent in the
// map's frame: it is halved as section 3 has it until it lies above everything below it or is straight, and then walked. Straight
// pieces are many cells long where cells are small beside the base.

#include "terrain/cells-between.glsl"
#include "terrain/halves.glsl"
#include "terrain/walk.glsl"

// The first place where the ray is not above the map's surface, if before `limit_m`; `before` if not.
Hit trace(vec3 eye, vec3 direction, float limit_m, Hit before) {
    RaySegment ray = ray_segment(eye, direction, limit_m);
    if (!(ray.near_m < ray.far_m)) {
        return before;
    }
    Subsegment subsegment;
    vec3 near = first_point(ray);
    int shift = finest_shift(ray.near_m);
    int surface = entry_surface(ray, near, height_at(shift, near.xy));
    if (surface != 0) {
        return Hit(ray.near_m, near.xy, surface_code(surface, shift, 1));
    }
    Met met = Met(-1.0, true);
    Clip clip = Clip(0.0, 1.0, TERRAIN);
    int steps = 0;
    int at = 0;
    int units = first_units(ray, WHOLE);
    bool done = false;
    while (true) {
        bool is_last = false;
        int level = 0;
        while (true) {
            subsegment = subsegment_of(ray, near, float(at) / float(WHOLE), float(units) / float(WHOLE));
            vec3 slack = slack_of(subsegment);
            vec2 low = min(subsegment.near.xy, subsegment.far.xy) - slack.xy;
            vec2 high = max(subsegment.near.xy, subsegment.far.xy) + slack.xy;
            level = shift_for(max(high.x - low.x, high.y - low.y));
            float lowest = min(subsegment.near.z, subsegment.far.z) - slack.z - terrain.rounding_height;
            float rounding = terrain.rounding_nodes;
            steps += 1;
            if (lowest > highest_between(low - rounding, high + rounding, level)) {
                at += units;
                units = at & -at;
                near = next_point(ray, subsegment, float(at) / float(WHOLE));
                done = at >= WHOLE;
            } else {
                is_last = is_straight(slack, finest_shift(subsegment.depth_m)) || units == 1;
                units = is_last ? units : units >> 1;
            }
            if (is_last || done) {
                break;
            }
        }
        if (is_last) {
            clip = clip_to_map(subsegment);
            if (clip.near <= clip.far) {
                vec3 from = point_on(subsegment, clip.near);
                float far_m = depth_at(ray, float(at + units) / float(WHOLE));
                vec2 depths_m = mix(vec2(subsegment.depth_m), vec2(far_m), vec2(clip.near, clip.far));
                Line line = Line(from, point_on(subsegment, clip.far) - from, depths_m.x, depths_m.y);
                met = walk(line, 0.0, clamp(level, 1, max(map.top, 1)), steps);
            }
            done = met.t >= 0.0 || !met.is_certain;
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
    Hit hit = met.is_certain && (met.t >= 0.0 || at >= WHOLE) ? before : UNFINISHED;
    if (met.t >= 0.0) {
        float fraction = mix(clip.near, clip.far, met.t);
        float depth_m = depth_at(ray, (float(at) + fraction * float(units)) / float(WHOLE));
        surface = met.t > 0.0 ? TERRAIN : clip.surface;
        hit = Hit(depth_m, point_on(subsegment, fraction).xy, surface_code(surface, finest_shift(depth_m), steps));
    }
    return hit;
}
