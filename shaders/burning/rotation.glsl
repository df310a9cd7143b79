// A position rotated with its block about the block's midpoint (3.5.3).

#include "burning/grid.glsl"

// By pitch about x, then yaw about y, then roll about z.
vec3 rotated(vec3 v, vec3 angles) {
    vec3 s = sin(angles);
    vec3 c = cos(angles);
    vec3 p = vec3(v.x, c.x * v.y - s.x * v.z, s.x * v.y + c.x * v.z);
    vec3 q = vec3(c.y * p.x + s.y * p.z, p.y, -s.y * p.x + c.y * p.z);
    return vec3(c.z * q.x - s.z * q.y, s.z * q.x + c.z * q.y, q.z);
}

vec3 rotated_with_block(vec3 position, uint block, vec3 angles) {
    if (angles == vec3(0.0)) {
        return position;
    }
    vec3 midpoint = midpoint_of(block);
    return midpoint + rotated(position - midpoint, angles);
}
