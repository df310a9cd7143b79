// The base as a cylinder or an ellipsoid of revolution: F = P + n h (eq. 5, 6). A ray is bent in the map's frame. Its height over
// the base is convex, so that the lowest of a subsegment is below its ends by its sagitta at most; latitude and longitude leave
// the straight line between its ends by what their second derivatives allow. Subsegments are halved until both are nothing.

#include "terrain/slab.glsl"
#include "terrain/geodesy.glsl"

// How far a last subsegment may be from straight, in texels of the level that it is met at.
const float STRAIGHT = 2.5e-4;

// The segment of a ray that can meet the map; its ray parameter t is 0 at the near end and 1 at the far one.
struct RaySegment {
    float near_m; // depth of its ends, metres
    float far_m;
    vec3 from; // metres from the map's middle: east, off the axis, along it
    vec3 whole;
    float cut; // the fraction of it at which it passes behind the axis, where longitudes end; 0 where it does not
};

// A piece of a ray in the map's frame (eq. 9), the depth of its near end, and how far it may leave the straight line.
struct Subsegment {
    vec3 near;
    vec3 far;
    float depth_m;
    vec3 slack;
};

// A quadric along a ray: a t^2 + 2 b t + c.
vec3 along_ray(vec3 eye, vec3 direction, vec2 squares, vec2 linear, float constant) {
    float a = squares.x * dot(direction.xy, direction.xy) + squares.y * direction.z * direction.z;
    float b = squares.x * dot(eye.xy, direction.xy) + squares.y * eye.z * direction.z + dot(linear, direction.yz);
    float c = squares.x * dot(eye.xy, eye.xy) + squares.y * eye.z * eye.z + 2.0 * dot(linear, eye.yz) + constant;
    return vec3(max(a, 1.0e-30), b, c);
}

// Where the ray meets the base, and how much farther it must go to be below it without doubt.
vec2 base_depth(vec3 direction) {
    vec3 q = along_ray(terrain.eye, direction, terrain.base_squares, terrain.base_linear, 0.0);
    float discriminant = q.y * q.y - q.x * q.z;
    float root = sqrt(max(discriminant, 0.0));
    bool is_met = discriminant > 0.0 && q.y < 0.0;
    float base_m = is_met ? q.z / (root - q.y) : NO_DEPTH;
    if (is_met) {
        // Once more from there, where numbers are small: from afar the root loses its last digits.
        vec3 from = terrain.eye + base_m * direction;
        vec3 there = along_ray(from, direction, terrain.base_squares, terrain.base_linear, 0.0);
        base_m -= abs(there.y) > 0.1 * root ? 0.5 * there.z / there.y : 0.0;
    }
    float slack_m = terrain.rounding_height * terrain.height_unit_m / max(root, 1.0e-20);
    return q.z <= 0.0 ? vec2(0.0) : vec2(base_m, slack_m);
}

vec2 base_place(vec3 direction, float depth_m) {
    vec3 point = terrain.eye + depth_m * direction;
    return depth_m < NO_DEPTH ? map_coordinates(point, point.x).xy : vec2(0.0);
}

RaySegment ray_segment(vec3 eye, vec3 direction, float limit_m) {
    vec3 q = along_ray(eye, direction, terrain.shell_squares, terrain.shell_linear, terrain.shell_constant);
    float discriminant = q.y * q.y - q.x * q.z;
    float root = sqrt(max(discriminant, 0.0));
    float sum = q.y < 0.0 ? root - q.y : -q.y - root;
    float a = q.z / (abs(sum) < 1.0e-30 ? 1.0e-30 : sum);
    float b = sum / q.x;
    vec2 range = vec2(max(0.0, min(a, b)), min(limit_m, max(a, b)));
    if (is_kind(terrain.base_kind, CYLINDER, range.x)) {
        // From a little outside, so that a ray is seen to come in through the wall.
        float outside = terrain.rounding_nodes;
        float low = -(terrain.middle_node.y + outside) / terrain.nodes_per_unit.y;
        float high = (float(terrain.size.y - 1) - terrain.middle_node.y + outside) / terrain.nodes_per_unit.y;
        range = clip_to_slab(range, eye.z, direction.z, low, high);
    }
    if (discriminant <= 0.0 || !(range.x < range.y)) {
        range = vec2(1.0, 0.0);
    }
    vec3 from = eye + range.x * direction;
    vec3 whole = (range.y - range.x) * direction;
    float cut = whole.x != 0.0 ? -from.x / whole.x : 0.0;
    bool is_behind = terrain.axis_distance_m + from.y + cut * whole.y < 0.0;
    return RaySegment(range.x, range.y, from, whole, cut > 0.0 && cut < 1.0 && is_behind ? cut : 0.0);
}

// The longest subsegment that is tried, of `whole` units: a ray behind the axis is cut there before it is halved.
int first_units(RaySegment ray, int whole) {
    return ray.cut > 0.0 ? whole / 2 : whole;
}

float fraction_at(RaySegment ray, float start) {
    float cut_part = start < 0.5 ? 2.0 * start * ray.cut : ray.cut + (2.0 * start - 1.0) * (1.0 - ray.cut);
    return ray.cut > 0.0 ? cut_part : start;
}

float depth_at(RaySegment ray, float start) {
    return ray.near_m + fraction_at(ray, start) * (ray.far_m - ray.near_m);
}

// The piece from `near` on, where the piece before it ended: a place's coordinates cost more than the rest of a step.
Subsegment subsegment_of(RaySegment ray, vec3 near, float start, float size) {
    vec3 a = ray.from + fraction_at(ray, start) * ray.whole;
    vec3 b = ray.from + fraction_at(ray, start + size) * ray.whole;
    float side = ray.cut > 0.0 ? (start < 0.5 ? -ray.whole.x : ray.whole.x) : b.x;
    // The distance from the axis at its smallest.
    vec2 from = vec2(a.x, terrain.axis_distance_m + a.y);
    vec2 move = b.xy - a.xy;
    float nearest = clamp(-dot(from, move) / max(dot(move, move), 1.0e-30), 0.0, 1.0);
    float radius = max(length(from + nearest * move), 1.0e-6 * terrain.axis_distance_m);
    float angle = length(move) / radius;
    float longitude_slack = min(0.125 * angle * angle, 0.5 * angle);
    vec3 slack = vec3(longitude_slack * terrain.nodes_per_unit.x, 0.0, 0.125 * length(move) * angle);
    if (!is_kind(terrain.base_kind, CYLINDER, radius)) {
        float bend = length(b - a) / terrain.smallest_radius_m;
        float second = 0.125 * bend * bend * (2.0 + terrain.curvature_change + terrain.smallest_radius_m / radius);
        slack.y = min(second, 0.5 * bend) * abs(terrain.nodes_per_unit.y);
        slack.z = 0.125 * length(b - a) * bend;
    }
    slack.z = slack.z / terrain.height_unit_m;
    return Subsegment(near, map_coordinates(b, side), depth_at(ray, start), slack);
}

// The near end of what begins at `start`, behind a piece: where that ended; at the cut, by longitudes of the other side.
vec3 next_point(RaySegment ray, Subsegment before, float start) {
    vec3 far = before.far;
    bool is_cut = ray.cut > 0.0 && start == 0.5;
    return is_cut ? vec3(2.0 * terrain.middle_node.x - far.x, far.yz) : far;
}

// The near end of a ray in the map's coordinates.
vec3 first_point(RaySegment ray) {
    return map_coordinates(ray.from, ray.from.x);
}

// Whether the camera stands in the mountain. 0 where it does not.
int entry_surface(RaySegment ray, vec3 first, float height) {
    vec2 last = vec2(terrain.size - 1);
    bool is_over = first.x >= 0.0 && first.y >= 0.0 && first.x <= last.x && first.y <= last.y;
    return ray.near_m <= 0.0 && is_over && first.z <= height ? INSIDE : 0;
}

// How far the ray may leave the straight line between the ends: nodes along u and v, height.
vec3 slack_of(Subsegment subsegment) {
    return subsegment.slack;
}

// Whether a subsegment is straight enough to be met at a level.
bool is_straight(vec3 slack, int shift) {
    float straight = STRAIGHT * exp2(float(shift));
    return max(slack.x, slack.y) <= straight && slack.z * terrain.height_unit_m <= straight * terrain.spacing_m.x;
}

Clip clip_to_map(Subsegment subsegment) {
    vec2 move = subsegment.far.xy - subsegment.near.xy;
    vec2 u = clip_to_slab(vec2(0.0, 1.0), subsegment.near.x, move.x, 0.0, float(terrain.size.x - 1));
    vec2 v = clip_to_slab(vec2(0.0, 1.0), subsegment.near.y, move.y, 0.0, float(terrain.size.y - 1));
    int side = move.x > 0.0 ? WALL_WEST : WALL_EAST;
    if (v.x > u.x) {
        side = move.y > 0.0 ? WALL_NORTH : WALL_SOUTH;
    }
    float near = max(u.x, v.x);
    return Clip(near, min(u.y, v.y), near > 0.0 ? side : TERRAIN);
}

// What leads a ray of any direction a texel of a level on.
float texel_m(vec3 direction, int shift) {
    return terrain.widest_spacing_m * exp2(float(shift));
}
