// The traversal of the variants `dda-compute` and `dda-fragment` over a plane, where a ray stays straight: one walk.

#include "terrain/walk.glsl"

// The first place where the ray is not above the map's surface, if before `limit_m`; `before` if not.
Hit trace(vec3 eye, vec3 direction, float limit_m, Hit before) {
    RaySegment ray = ray_segment(eye, direction, limit_m);
    if (!(ray.near_m < ray.far_m)) {
        return before;
    }
    int steps = 0;
    float free = clamp((known.free_m - ray.near_m) / (ray.far_m - ray.near_m), 0.0, 1.0);
    Met met = walk(Line(ray.from, ray.whole, ray.near_m, ray.far_m), free, known.level, steps);
    Hit hit = met.is_certain ? before : UNFINISHED;
    if (met.t >= 0.0) {
        float depth_m = depth_at(ray, met.t);
        // A ray that begins below the surface meets a wall, or is inside the mountain.
        int surface = met.t > 0.0 ? TERRAIN : ray.side;
        hit = Hit(depth_m, ray.from.xy + met.t * ray.whole.xy, surface_code(surface, finest_shift(depth_m), steps));
    }
    return hit;
}
