#version 450

#pragma variants OBJECT=shell,solid,melting

// Eq. 4 and 5 and the algorithm after figure 3.6: a block rotates by gamma rho pi / (N M) for each vertex that
// unbalanced it, and by its neighbours' own change, -x times at the sides and +x times above and below. Printed, eq. 5
// calls M epsilon. One thread a block gathers; the total angle is clamped, for a free block (two or more sides without
// neighbours) less.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/constants.glsl"
#include "burning/grid.glsl"
#include "burning/block-levels.glsl"
#include "burning/blocks.glsl"

layout(set = 0, binding = 15, std430) readonly buffer Blocks {
    Block blocks[];
};

layout(set = 0, binding = 16, std430) readonly buffer OldRotations {
    vec4 old_rotations[]; // pitch, yaw, roll
};

layout(set = 0, binding = 17, std430) buffer NewRotations {
    vec4 new_rotations[];
};

const float PI = 3.14159265358979;
const uint SIDES = 4u; // directions 0 to 3

bool has_weight(uint block) {
    return block != NONE && blocks[min(block, constants.block_count - 1u)].live > 0;
}

// Number of live vertices; of a solid's block the less, the longer it has been burning (5.4).
float weight_of(uint block) {
    float live = float(blocks[block].live);
#ifdef OBJECT_SOLID
    float flammability = block_levels[block].flammability;
    live *= flammability / (flammability + float(blocks[block].combustion));
#endif
    return live;
}

// Melting blocks rotate outside the combustion-ready boundary and above the ignition alone: there is weight to support
// (6.4).
bool is_rigid(uint block) {
#ifdef OBJECT_MELTING
    return blocks[block].heated > 0 || midpoint_of(block).y <= constants.highest_source_y;
#else
    return false;
#endif
}

vec3 own_change(uint block) {
    ivec3 signs = ivec3(blocks[block].pitch_sign, blocks[block].yaw_sign, blocks[block].roll_sign);
    if (signs == ivec3(0)) {
        return vec3(0.0);
    }
    int neighbours = 0;
    for (uint direction = 0u; direction < 6u; direction++) {
        neighbours += has_weight(neighbour_of(block, direction)) ? 1 : 0;
    }
    float count = max(weight_of(block), 1.0) * float(max(neighbours, 1));
    return constants.gamma * block_levels[block].rho * PI / count * vec3(signs);
}

void main() {
    uint block = element(64u);
    if (block >= constants.block_count) {
        return;
    }
    vec4 before = old_rotations[block];
    if (blocks[block].live <= 0 || is_rigid(block)) {
        new_rotations[block] = before;
        return;
    }
    vec3 change = own_change(block);
    uint free_sides = 0u;
    for (uint direction = 0u; direction < 6u; direction++) {
        uint neighbour = neighbour_of(block, direction);
        if (neighbour != NONE) {
            change += (direction < SIDES ? -1.0 : 1.0) * constants.spread * own_change(neighbour);
        }
        if (direction < SIDES && !has_weight(neighbour)) {
            free_sides++;
        }
    }
    float most = free_sides >= 2u ? constants.greatest_free_rotation_rad : constants.greatest_rotation_rad;
    new_rotations[block] = vec4(clamp(before.xyz + change, vec3(-most), vec3(most)), 0.0);
}
