#version 450

// The rate of strain at a particle as the step begins, by the velocities that the last one ended with: those that gravity has been
// added to and pressure not are squeezed against the floor, which is no flow. Sums over particles are divided by what they are of a
// speed that grows by the place alone (Bonet and Lok 1999), so that neither disorder nor a free surface changes a linear one's.

#extension GL_EXT_samplerless_texture_functions : require

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "lava/sph.glsl"
#include "lava/bed.glsl"
#include "lava/sph-walls.glsl"
#include "lava/sph-lists.glsl"
#include "lava/sph-began.glsl"

layout(set = 0, binding = 4, std430) readonly buffer Pushed {
    vec4 list[]; // metres per second after gravity
} pushed;

layout(set = 0, binding = 5, std430) buffer Along {
    vec4 list[]; // per second: the tensor's diagonal
} along;

layout(set = 0, binding = 6, std430) buffer Across {
    vec4 list[]; // per second: twice what stands beside it, of y and z, z and x, x and y
} across;

// The speed's slope at a wall beyond which the speed goes on linearly through 0: over the speed, times h.
float shear_beyond(float q) {
    float u = max(1.0 - q, 0.0);
    float squared = u * u;
    float series = 21.0 - 49.0 * u + 39.0 * squared - 10.5 * squared * u;
    return squared * squared * u * series / max(q, 1.0e-3);
}

mat3 outer(vec3 a, vec3 b) {
    return mat3(a * b.x, a * b.y, a * b.z);
}

// Particles that have few others around them, or all in a plane, keep their sums as they are: the least mean of the diagonal,
// and the least determinant over its cube.
const float FEWEST = 0.1;
const float FLATTEST = 0.05;

mat3 inverse_of(mat3 moment) {
    vec3 x = moment[0];
    vec3 y = moment[1];
    vec3 z = moment[2];
    mat3 adjugate = mat3(cross(y, z), cross(z, x), cross(x, y));
    float determinant = dot(x, cross(y, z));
    float mean = (x.x + y.y + z.z) / 3.0;
    bool is_there = mean > FEWEST && determinant > FLATTEST * mean * mean * mean;
    vec2 shares = is_there ? vec2(1.0 / determinant, 0.0) : vec2(0.0, 1.0);
    return adjugate * shares.x + mat3(shares.y);
}

vec3 place_m;
vec3 pushed_m_s;
// Slopes of the speed, times h, and what they come out as where every slope is 1.
mat3 slopes = mat3(0.0);
mat3 moment = mat3(0.0);

void gather(uint i, float weight) {
    vec3 way = apart(place_m - began_m(i)) / flow.support_m;
    vec3 steep = weight * flow.laplacian * slope(length(way)) * way;
    slopes += outer(pushed.list[i].xyz - pushed_m_s, steep);
    moment -= outer(way, steep);
}

#include "lava/sph-gather.glsl"

void main() {
    uint at = element(64u);
    if (at >= flow.particles) {
        return;
    }
    place_m = began_m(at);
    pushed_m_s = pushed.list[at].xyz;
    gather_around(at, place_m);
    Walls walls = walls_at(place_m);
    vec4 q = walls.sides_q;
    vec4 sides = vec4(shear_beyond(q.x), shear_beyond(q.y), shear_beyond(q.z), shear_beyond(q.w));
    float bed = shear_beyond(walls.bed_q);
    vec3 velocity = pushed_m_s - flow.time_step_s * flow.gravity_m_s2;
    slopes += outer(velocity, vec3(sides.x - sides.y, 0.0, sides.z - sides.w) + bed * walls.up);
    vec4 moments = sides * q;
    moment += bed * walls.bed_q * outer(walls.up, walls.up);
    moment += mat3(vec3(moments.x + moments.y, 0.0, 0.0), vec3(0.0), vec3(0.0, 0.0, moments.z + moments.w));
    slopes = slopes * inverse_of(moment) * (1.0 / flow.support_m);
    vec3 by_x = slopes[0];
    vec3 by_y = slopes[1];
    vec3 by_z = slopes[2];
    along.list[at] = vec4(by_x.x, by_y.y, by_z.z, 0.0);
    across.list[at] = vec4(by_z.y + by_y.z, by_x.z + by_z.x, by_y.x + by_x.y, 0.0);
}
