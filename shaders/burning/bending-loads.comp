#version 450

// What is there of each section, and of each joint: of what its line passes through the share of L that is left, none of
// what has been removed. Sums of integers, so that no order of threads changes them.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/constants.glsl"
#include "burning/contacts.glsl"
#include "burning/flammability.glsl"
#include "burning/rotation.glsl"
#include "burning/vertices.glsl"
#define OBJECT_PARTS
#include "burning/posed.glsl"

layout(set = 0, binding = 10, std430) readonly buffer NewState {
    VertexState new_state[];
};

layout(set = 0, binding = 13, std430) readonly buffer Removed {
    uint removed[];
};

layout(set = 0, binding = 14, std430) readonly buffer Cells {
    uint cells[];
};

layout(set = 0, binding = 17, std430) readonly buffer NewRotations {
    vec4 new_rotations[]; // pitch, yaw, roll
};

layout(set = 0, binding = 69, std430) readonly buffer Weights {
    uint weights[];
};

layout(set = 0, binding = 105, std430) readonly buffer Cuts {
    Cut cuts[];
};

layout(set = 0, binding = 106, std430) readonly buffer Holds {
    Hold holds[];
};

layout(set = 0, binding = 107, std430) buffer Loads {
    Load loads[];
};

layout(set = 0, binding = 108, std430) buffer Strengths {
    uint strengths[]; // of joints
};

layout(push_constant, std430) uniform Sizes {
    uint section_count;
    uint joint_count;
    uint cut_count;
    float width;
    float area;
    float bending;
} sizes;

const float STEPS = 256.0; // of L

// 1 of what does not burn.
float left_of(uint vertex) {
    float flammability = flammability_of(vertex);
    return flammability > 0.0 ? clamp(new_state[vertex].left / flammability, 0.0, 1.0) : 1.0;
}

void main() {
    uint thread = element(64u);
    if (thread < constants.vertex_count) {
        uint part = part_of[thread];
        if (part < MOST_PARTS) {
            uint section = holds[thread].sections & 0xffffu;
            uint block = cells[thread];
            vec3 place = rotated_with_block(new_state[thread].position, block, new_rotations[block].xyz);
            atomicAdd(loads[section].weight, weights[thread]);
            atomicMin(loads[section].part, part + (parts[part].rests != 0.0 ? 0u : MOVING));
            if (posed(thread, place).y <= constants.floor_y + NEAR_GROUND) {
                atomicOr(loads[section].is_foot, 1u);
            }
        }
        return;
    }
    uint number = thread - constants.vertex_count;
    if (number < sizes.cut_count) {
        Cut cut = cuts[number];
        bool is_pair = cut.triangle == NONE;
        bool is_there = is_pair ? new_state[cut.a].left > 0.0 && new_state[cut.b].left > 0.0 : removed[cut.triangle] == 0u;
        if (is_there) {
            float left = is_pair ? min(left_of(cut.a), left_of(cut.b))
                                 : (left_of(cut.a) + left_of(cut.b) + left_of(cut.c)) / 3.0;
            // What is there holds a little, burnt out or not.
            atomicAdd(strengths[cut.joint], cut.units * max(uint(STEPS * left), 1u));
        }
    }
}
