#version 450

// The sections turn about the hinges between them and the ground, the nearest first.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/constants.glsl"
#include "burning/parts.glsl"
#include "burning/sections.glsl"

layout(set = 0, binding = 103, std430) readonly buffer Joints {
    Joint joints[];
};

layout(set = 0, binding = 109, std430) buffer SectionBends {
    Bend section_bends[];
};

layout(set = 0, binding = 111, std430) readonly buffer Hinges {
    Hinge hinges[]; // of sections
};

layout(push_constant, std430) uniform Sizes {
    uint section_count;
    uint joint_count;
    uint cut_count;
    float width;
    float area;
    float bending;
} sizes;

const uint ROUNDS = 128u; // of the search

vec4 product(vec4 a, vec4 b) {
    return vec4(a.w * b.xyz + b.w * a.xyz + cross(a.xyz, b.xyz), a.w * b.w - dot(a.xyz, b.xyz));
}

void main() {
    uint own = element(64u);
    if (own >= sizes.section_count) {
        return;
    }
    Bend bend = section_bends[own];
    bool turns = false;
    uint section = own;
    for (uint step = 0u; step < ROUNDS; step++) {
        Hinge hinge = hinges[section];
        if (hinge.joint == NONE) {
            break;
        }
        if (hinge.angle > 0.0) {
            vec4 turn = vec4(hinge.axis * sin(0.5 * hinge.angle), cos(0.5 * hinge.angle));
            bend.turn = product(turn, bend.turn);
            bend.offset = turned(turn, bend.offset - hinge.pivot) + hinge.pivot;
            turns = true;
        }
        uvec2 ends = joints[hinge.joint].ends;
        section = ends.x == section ? ends.y : ends.x;
    }
    if (turns) {
        bend.turn = normalize(bend.turn);
        section_bends[own] = bend;
    }
}
