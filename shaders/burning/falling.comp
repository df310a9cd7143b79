#version 450

// A tick of the rigid parts. What stands with its weight over what touches the ground stays; anything else falls: gravity
// by semi-implicit Euler, then at each contact the impulses, one after the other, that keep it from passing the ground
// or another part within the tick and that rub along it (Guendelman et al. 2003, without bouncing). Another part goes on
// as in the last tick meanwhile: what it runs away with is not caught up, and where it comes nearer it is stopped by its
// own contact and drives nothing on. An impulse that stops what approaches takes energy and never gives any, for nothing
// is pushed out of the part; the spin goes on with its angular momentum, and with less where turning would have given
// energy. Forces follow from the moments of 3.5's weight.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/constants.glsl"
#include "burning/moments.glsl"
#include "burning/contacts.glsl"
#include "burning/meeting.glsl"
#include "burning/bent.glsl"
#include "burning/rotation.glsl"
#include "burning/vertices.glsl"

layout(set = 0, binding = 10, std430) readonly buffer NewState {
    VertexState new_state[];
};

layout(set = 0, binding = 14, std430) readonly buffer Cells {
    uint cells[];
};

layout(set = 0, binding = 17, std430) readonly buffer NewRotations {
    vec4 new_rotations[]; // pitch, yaw, roll
};

layout(set = 0, binding = 66, std430) buffer Parts {
    Part parts[];
};

layout(set = 0, binding = 68, std430) readonly buffer Sums {
    uint sums[];
};

layout(set = 0, binding = 70, std430) readonly buffer Contacts {
    int contacts[];
};

layout(set = 0, binding = 77, std430) readonly buffer Met {
    Obstacle met[];
};

layout(set = 0, binding = 97, std430) buffer Moving {
    uint moving[3]; // workgroups over the vertices, in rows, while a part moves; else 0 a row
};

const uint GROUP = 64u; // of the passes over the vertices
const float TICK_S = 1.0 / 60.0;
const float GRAVITY = 9.81; // diagonals a second squared
const float FRICTION = 0.6;
// Of the spin, what rolling leaves after a tick on the ground.
const float ROLLING = 0.98;
const uint ITERATIONS = 24u;
// A part comes to rest below this speed, diagonals a second.
const float STILL = 0.04;
// What topples must lean out by so much, diagonals.
const float MARGIN = 0.005;
// Of a point: moments of parts that are thinner would not be invertible. Diagonals squared.
const float THINNEST = 1e-6;

float sum_of(uint part, uint k) {
    uint low = part * MOMENTS + 2u * k;
    return float(sums[low + 1u]) * 4294967296.0 + float(sums[low]);
}

// Mean of a quantity as a fraction of its range.
float mean_of(uint part, uint k) {
    float weight = float(sums[part * MOMENTS]);
    float half_of = 1.0 / float(1u << HALF_BITS);
    float low = sum_of(part, 1u + 2u * k) / weight;
    float high = sum_of(part, 2u + 2u * k) / weight;
    return half_of * (high + half_of * (low + 0.5));
}

vec3 mean_arm(uint part) {
    return 2.0 * REACH * (vec3(mean_of(part, 0u), mean_of(part, 1u), mean_of(part, 2u)) - 0.5);
}

// Moments of inertia about the centre over the weight, in the object's axes.
mat3 inertia_of(uint part, vec3 arm) {
    vec3 squares = 2.0 * REACH * REACH * (vec3(mean_of(part, 3u), mean_of(part, 4u), mean_of(part, 5u)) - 0.5);
    vec3 products = 2.0 * REACH * REACH * (vec3(mean_of(part, 6u), mean_of(part, 7u), mean_of(part, 8u)) - 0.5);
    squares = max(squares - arm * arm, vec3(0.0));
    products -= vec3(arm.x * arm.y, arm.x * arm.z, arm.y * arm.z);
    float sum = squares.x + squares.y + squares.z + THINNEST;
    return mat3(
        sum - squares.x, -products.x, -products.y,
        -products.x, sum - squares.y, -products.z,
        -products.y, -products.z, sum - squares.z
    );
}

mat3 matrix_of(vec4 q) {
    return mat3(turned(q, vec3(1.0, 0.0, 0.0)), turned(q, vec3(0.0, 1.0, 0.0)), turned(q, vec3(0.0, 0.0, 1.0)));
}

vec4 turned_further(vec4 q, vec3 angles) {
    float angle = length(angles);
    if (angle < 1e-9) {
        return q;
    }
    vec4 d = vec4(angles / angle * sin(0.5 * angle), cos(0.5 * angle));
    return normalize(vec4(d.w * q.xyz + q.w * d.xyz + cross(d.xyz, q.xyz), d.w * q.w - dot(d.xyz, q.xyz)));
}

// True where the weight stands over what touches the ground.
bool stands(uint part, vec3 center) {
    for (uint k = 0u; k < DIRECTIONS; k++) {
        float reach = float(contacts[part * WORDS + k]) / STEPS_A_DIAGONAL;
        if (reach < dot(direction(k), center.xz) - MARGIN) {
            return false;
        }
    }
    return true;
}

float energy_of(vec3 velocity, vec3 spin, mat3 inertia, float height) {
    return 0.5 * dot(velocity, velocity) + 0.5 * dot(spin, inertia * spin) + GRAVITY * height;
}

// The component along n that an impulse of 1 along n gives the velocity at the arm.
float yielding(mat3 inverse_inertia, vec3 arm, vec3 n) {
    return 1.0 + dot(cross(inverse_inertia * cross(arm, n), arm), n);
}

void main() {
    uint index = element(64u);
    if (index >= MOST_PARTS || sums[min(index, MOST_PARTS - 1u) * MOMENTS] == 0u) {
        return;
    }
    Part part = parts[index];
    vec3 arm = mean_arm(index);
    vec3 center = part.anchor + arm;
    mat3 own_inertia = inertia_of(index, arm);
    mat3 axes = matrix_of(part.orientation);
    // What burnt away took its motion with it, and what is left goes on.
    part.velocity += cross(part.spin, axes * (center - part.center));
    part.center = center;
    part.weight = float(sums[index * MOMENTS]);
    part.extent = sqrt(0.5 * (own_inertia[0][0] + own_inertia[1][1] + own_inertia[2][2]));
    vec3 at = axes * center + part.offset;
    bool is_standing = stands(index, at);
    uint groups = (constants.vertex_count + GROUP * moving[1] - 1u) / (GROUP * moving[1]);
    if (part.rests != 0.0) {
        // Of what lies still no contacts are asked: it begins to fall in the next tick, in which they are known.
        part.rests = is_standing ? 1.0 : 0.0;
        part.energy = GRAVITY * (at.y - constants.floor_y);
        parts[index] = part;
        if (!is_standing) {
            moving[0] = groups;
        }
        return;
    }
    part.fallen_ticks += 1.0;
    mat3 inertia = axes * own_inertia * transpose(axes);
    mat3 inverse_inertia = inverse(inertia);
    float before = energy_of(part.velocity, part.spin, inertia, at.y - constants.floor_y);

    vec3 velocity = part.velocity - vec3(0.0, GRAVITY * TICK_S, 0.0);
    vec3 spin = part.spin;
    vec3 arms[CONTACTS + MEETINGS];
    vec3 normals[CONTACTS + MEETINGS];
    vec3 moved[CONTACTS + MEETINGS]; // velocity of what is met
    float least[CONTACTS + MEETINGS]; // velocity along the normal that just reaches it
    uint count = 0u;
    for (uint k = 0u; k < CONTACTS + MEETINGS; k++) {
        bool is_ground = k < CONTACTS;
        uint octant = is_ground ? 0u : k - CONTACTS;
        uint word = is_ground ? DIRECTIONS + CONTACTS + k : GAPS + MEETINGS + octant;
        int vertex = contacts[index * WORDS + word];
        if (vertex != FARTHEST) {
            uint block = cells[vertex];
            vec3 place = rotated_with_block(new_state[vertex].position, block, new_rotations[block].xyz);
            place = bent(uint(vertex), place);
            vec3 position = turned(part.orientation, place) + part.offset;
            arms[count] = position - at;
            Obstacle obstacle = met[index * MEETINGS + octant];
            normals[count] = is_ground ? vec3(0.0, 1.0, 0.0) : obstacle.toward;
            moved[count] = is_ground ? vec3(0.0) : obstacle.velocity;
            float gap = max(is_ground ? position.y - constants.floor_y : obstacle.gap, 0.0);
            least[count] = min(dot(moved[count], normals[count]), 0.0) - gap / TICK_S;
            count++;
        }
    }
    bool touches = false;
    for (uint i = 0u; i < ITERATIONS; i++) {
        for (uint k = 0u; k < count; k++) {
            vec3 r = arms[k];
            vec3 n = normals[k];
            vec3 u = velocity + cross(spin, r);
            float nearing = dot(u, n);
            if (nearing < least[k]) {
                touches = true;
                float impulse = (least[k] - nearing) / yielding(inverse_inertia, r, n);
                velocity += impulse * n;
                spin += inverse_inertia * cross(r, impulse * n);
                u = velocity + cross(spin, r) - moved[k];
                u -= dot(u, n) * n;
                float sliding = length(u);
                if (sliding > 1e-6) {
                    vec3 along = u / sliding;
                    float rubbing = min(FRICTION * impulse, sliding / yielding(inverse_inertia, r, along));
                    velocity -= rubbing * along;
                    spin -= inverse_inertia * cross(r, rubbing * along);
                }
            }
        }
    }
    spin *= touches ? ROLLING : 1.0;
    float speed = length(velocity) + part.extent * length(spin);
    if (is_standing && speed < STILL) {
        part.rests = 1.0;
        part.fallen_ticks = 0.0;
        part.velocity = vec3(0.0);
        part.spin = vec3(0.0);
        part.energy = GRAVITY * (at.y - constants.floor_y);
        parts[index] = part;
        return;
    }
    vec4 still_orientation = part.orientation;
    vec3 still_offset = part.offset;
    float still_height = at.y - constants.floor_y;
    part.orientation = turned_further(part.orientation, spin * TICK_S);
    at += velocity * TICK_S;
    axes = matrix_of(part.orientation);
    part.offset = at - axes * center;
    mat3 after = axes * own_inertia * transpose(axes);
    vec3 carried = inverse(after) * (inertia * spin);
    float given = dot(carried, after * carried);
    float had = dot(spin, inertia * spin);
    spin = given > had ? carried * sqrt(had / given) : carried;
    // A spin that lifts what it turns about its foot would gain the height: the motion pays for it, or stays away.
    float height = at.y - constants.floor_y;
    float now = energy_of(velocity, spin, after, height);
    float kinetic = now - GRAVITY * height;
    if (now > before) {
        float kept = sqrt(clamp((before - GRAVITY * height) / max(kinetic, 1e-12), 0.0, 1.0));
        velocity *= kept;
        spin *= kept;
        now = energy_of(velocity, spin, after, height);
    }
    if (GRAVITY * height > before) {
        part.orientation = still_orientation;
        part.offset = still_offset;
        now = GRAVITY * still_height;
    }
    part.velocity = velocity;
    part.spin = spin;
    part.energy = now;
    parts[index] = part;
    moving[0] = groups;
}
