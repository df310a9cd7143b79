#version 450

// The moments of the parts. A thread adds up a run of vertices by itself as long as they are of one part.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/constants.glsl"
#include "burning/moments.glsl"
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

layout(set = 0, binding = 65, std430) readonly buffer PartOf {
    uint part_of[];
};

layout(set = 0, binding = 66, std430) readonly buffer Parts {
    Part parts[];
};

layout(set = 0, binding = 68, std430) buffer Sums {
    uint sums[];
};

layout(set = 0, binding = 69, std430) readonly buffer Weights {
    uint weights[];
};

const uint RUN = 16u;

uint run_sums[SUMS]; // of a weight below 256 times a half they are no longer than a word

void flush(uint part) {
    for (uint k = 0u; k < SUMS; k++) {
        if (run_sums[k] != 0u) {
            uint low = part * MOMENTS + 2u * k;
            uint before = atomicAdd(sums[low], run_sums[k]);
            if (before + run_sums[k] < before) {
                atomicAdd(sums[low + 1u], 1u);
            }
        }
        run_sums[k] = 0u;
    }
}

void add(uint k, float fraction, uint weight) {
    uint whole = uint(clamp(fraction, 0.0, 1.0) * float((1u << (2u * HALF_BITS)) - 1u));
    run_sums[1u + 2u * k] += weight * (whole & ((1u << HALF_BITS) - 1u));
    run_sums[2u + 2u * k] += weight * (whole >> HALF_BITS);
}

void main() {
    uint first = element(64u) * RUN;
    uint current = NO_PART;
    for (uint k = 0u; k < SUMS; k++) {
        run_sums[k] = 0u;
    }
    for (uint i = 0u; i < RUN; i++) {
        uint vertex = first + i;
        uint part = vertex < constants.vertex_count ? part_of[min(vertex, constants.vertex_count - 1u)] : NO_PART;
        if (part < MOST_PARTS) {
            if (part != current) {
                if (current != NO_PART) {
                    flush(current);
                }
                current = part;
            }
            uint block = cells[vertex];
            vec3 place = rotated_with_block(new_state[vertex].position, block, new_rotations[block].xyz);
            place = bent(vertex, place);
            vec3 arm = place - parts[part].anchor;
            uint weight = weights[vertex];
            run_sums[0] += weight;
            for (uint k = 0u; k < 3u; k++) {
                add(k, 0.5 + arm[k] / (2.0 * REACH), weight);
                add(3u + k, 0.5 + arm[k] * arm[k] / (2.0 * REACH * REACH), weight);
            }
            add(6u, 0.5 + arm.x * arm.y / (2.0 * REACH * REACH), weight);
            add(7u, 0.5 + arm.x * arm.z / (2.0 * REACH * REACH), weight);
            add(8u, 0.5 + arm.y * arm.z / (2.0 * REACH * REACH), weight);
        }
    }
    if (current != NO_PART) {
        flush(current);
    }
}
