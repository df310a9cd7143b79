#version 450

// Before the loads and what is left of the joints are summed.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/constants.glsl"
#include "burning/sections.glsl"

layout(set = 0, binding = 107, std430) buffer Loads {
    Load loads[];
};

layout(set = 0, binding = 108, std430) buffer Strengths {
    uint strengths[]; // of joints
};

layout(set = 0, binding = 112, std430) buffer Bending {
    uint groups[3];
    uint is_idle;
};

layout(push_constant, std430) uniform Sizes {
    uint section_count;
    uint joint_count;
    uint cut_count;
    float width;
    float area;
    float bending;
} sizes;

void main() {
    uint thread = element(64u);
    if (thread == 0u) {
        is_idle = 0u;
    }
    if (thread < sizes.section_count) {
        loads[thread] = Load(0u, NONE, 0u);
    }
    if (thread < sizes.joint_count) {
        strengths[thread] = 0u;
    }
}
