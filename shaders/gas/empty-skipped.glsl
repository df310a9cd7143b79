// Metres of a ray from a point to the end of a brick that has no density; 0 in one that has.

#include "gas/bricks.glsl"

float empty_m(vec3 point, vec3 direction) {
    vec3 scale = bricks_a_metre();
    vec3 at = (point - in_hand.center) * scale + 0.5 * float(brick_count);
    ivec3 brick = brick_of(at);
    if (brick_bounds[brick_at(index_in_hand, brick)] > 0.0) {
        return 0.0;
    }
    made++;
    return max(way_through(brick, at, direction * scale), 1.0e-30);
}
