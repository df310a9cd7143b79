// The base as a plane: a ray stays straight in the map's frame, and so do its halves.

#include "terrain/slab.glsl"

// The segment of a ray that can meet the map; its ray parameter t is 0 at the near end and 1 at the far one.
struct RaySegment {
    float near_m; // depth of its ends, metres
    float far_m;
    int side; // the surface it comes in through
    vec3 from; // u, v, h
    vec3 whole;
};

// A piece of a ray in the map's frame (eq. 9), and the depth of its near end.
struct Subsegment {
    vec3 near;
    vec3 far;
    float depth_m;
};

// Where the ray meets the base, and how much farther it must go to be below it without doubt.
vec2 base_depth(vec3 direction) {
    float above = terrain.eye.z - terrain.base_height;
    float base_m = direction.z < 0.0 ? above / -direction.z : NO_DEPTH;
    float slack_m = 2.0 * terrain.rounding_height / max(-direction.z, 1.0e-20);
    return above <= 0.0 ? vec2(0.0) : vec2(base_m, slack_m);
}

vec2 base_place(vec3 direction, float depth_m) {
    return terrain.eye.xy + depth_m * direction.xy;
}

RaySegment ray_segment(vec3 eye, vec3 direction, float limit_m) {
    vec2 all = vec2(0.0, limit_m);
    vec2 last = vec2(map.last);
    vec2 u = clip_to_slab(all, eye.x, direction.x, 0.0, last.x);
    vec2 v = clip_to_slab(all, eye.y, direction.y, 0.0, last.y);
    float margin = terrain.rounding_height;
    vec2 h = clip_to_slab(all, eye.z, direction.z, terrain.lowest - margin, terrain.highest + margin);
    float near_m = max(max(u.x, v.x), h.x);
    float far_m = min(min(u.y, v.y), h.y);
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
    return RaySegment(near_m, far_m, side, eye + near_m * direction, (far_m - near_m) * direction);
}

// The longest subsegment that is tried, of `whole` units.
int first_units(RaySegment ray, int whole) {
    return whole;
}

Subsegment subsegment_of(RaySegment ray, vec3 near, float start, float size) {
    return Subsegment(near, ray.from + (start + size) * ray.whole, ray.near_m + start * (ray.far_m - ray.near_m));
}

float depth_at(RaySegment ray, float start) {
    return ray.near_m + start * (ray.far_m - ray.near_m);
}

// The near end of what begins at `start`, behind a piece.
vec3 next_point(RaySegment ray, Subsegment before, float start) {
    return ray.from + start * ray.whole;
}

// The near end of a ray in the map's coordinates.
vec3 first_point(RaySegment ray) {
    return ray.from;
}

// Terrain is solid below its height: a wall where the ray comes in, or the inside of the mountain. 0 where it is neither.
int entry_surface(RaySegment ray, vec3 first, float height) {
    return first.z <= height ? ray.side : 0;
}

// How far the ray may leave the straight line between the ends: nodes along u and v, height.
vec3 slack_of(Subsegment subsegment) {
    return vec3(0.0);
}

// Whether a subsegment is straight enough to be met at a level.
bool is_straight(vec3 slack, int shift) {
    return true;
}

Clip clip_to_map(Subsegment subsegment) {
    return Clip(0.0, 1.0, TERRAIN);
}

// What leads a ray of that direction a texel of a level on, but no farther than the longest side of one.
float texel_m(vec3 direction, int shift) {
    float nodes = max(max(abs(direction.x), abs(direction.y)), 1.0e-20); // for 1 m
    return min(terrain.widest_spacing_m, 1.0 / nodes) * exp2(float(shift));
}
