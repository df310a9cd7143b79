#version 450

// The rate of strain at a particle that viscosity leaves: the root of twice the sum of the squares of its components, from the
// velocities that the equation of viscosity has been solved for. What the pressure adds to them afterwards shakes single
// particles, and is no flow.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "lava/sph.glsl"

layout(set = 0, binding = 4, std430) readonly buffer From {
    vec4 list[]; // metres per second
} from;

layout(set = 0, binding = 5, std430) buffer Change {
    vec4 list[]; // the rate of strain per second in the fourth component
} change;

// The speed's slope at a wall beyond which the speed goes on linearly through 0: over the speed, times h.
float shear_beyond(float q) {
    float u = max(1.0 - q, 0.0);
    float squared = u * u;
    float series = 21.0 - 49.0 * u + 39.0 * squared - 10.5 * squared * u;
    return squared * squared * u * series / max(q, 1.0e-3);
}

vec3 wall_shear(Walls walls) {
    vec4 q = walls.sides_q;
    float along_x = shear_beyond(q.x) - shear_beyond(q.y);
    float along_z = shear_beyond(q.z) - shear_beyond(q.w);
    return vec3(along_x, shear_beyond(walls.floor_q), along_z);
}

void main() {
    uint at = element(64u);
    if (at >= flow.particles) {
        return;
    }
    vec3 place_m = began_m(at);
    vec3 velocity = from.list[at].xyz;
    // The rate of strain: its diagonal, and twice what stands beside it.
    vec3 along = vec3(0.0);
    vec3 across = vec3(0.0);
    for (int z = -1; z <= 1; z++) {
        for (int x = -1; x <= 1; x++) {
            uvec2 stretch = stretch_at(place_m, x, z);
            uint end = min(stretch.y, stretch.x + MOST);
            for (uint i = stretch.x; i < end; i++) {
                vec3 way = apart(place_m - began_m(i)) / flow.support_m;
                vec3 bend = slope(length(way)) * (from.list[i].xyz - velocity);
                along += bend * way;
                across += bend.yzx * way.zxy + bend.zxy * way.yzx;
            }
        }
    }
    vec3 shear = wall_shear(walls_at(place_m));
    along = flow.laplacian * along + velocity * shear;
    across = flow.laplacian * across + velocity.yzx * shear.zxy + velocity.zxy * shear.yzx;
    float strain_per_s = sqrt(2.0 * dot(along, along) + dot(across, across)) / flow.support_m;
    change.list[at] = vec4(vec3(0.0), strain_per_s);
}
