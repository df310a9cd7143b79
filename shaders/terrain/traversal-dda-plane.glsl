// The traversal of the variants `dda-compute` and `dda-fragment` over a plane, where a ray stays straight: one walk.

#include "terrain/walk.glsl"

// The first place where the ray is not above the map's surface, if before `limit_m`; `before` if not.
Hit trace(vec3 eye, vec3 direction, float limit_m, Hit before) {
    RaySegment ray = ray_segment(eye, direction, limit_m);
    if (!(ray.near_m < ray.far_m)) {
        return before;
    }
    int shift = finest_shift(ray.near_m);
    int surface = entry_surface(ray, height_at(shift, ray.from.xy));
    if (surface != 0) {
        return Hit(ray.near_m, ray.from.xy, surface_code(surface, shift, 1));
    }
    int steps = 0;
    Met met = walk(Line(ray.from, ray.whole, ray.near_m, ray.far_m), max(map.top - 2, 1), steps);
    Hit hit = met.is_certain ? before : UNFINISHED;
    if (met.t >= 0.0) {
        float depth_m = depth_at(ray, met.t);
        hit = Hit(depth_m, ray.from.xy + met.t * ray.whole.xy, surface_code(TERRAIN, finest_shift(depth_m), steps));
    }
    return hit;
}
