#version 450

// The moments of the parts. A thread adds up a run of vertices by itself as long as they are of one part.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/constants.glsl"
#include "burning/parting.glsl"
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

layout(set = 0, binding = 63, std430) readonly buffer Searching {
    Progress progress;
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

uint run_sums[MOMENTS];

void flush(uint part) {
    for (uint k = 0u; k < MOMENTS; k++) {
        if (run_sums[k] != 0u) {
            atomicAdd(sums[part * MOMENTS + k], run_sums[k]);
        }
        run_sums[k] = 0u;
    }
}

void add(uint k, float fraction, uint weight) {
    uint bits = progress.moment_bits;
    uint whole = uint(clamp(fraction, 0.0, 1.0) * float((1u << (2u * bits)) - 1u));
    run_sums[1u + 2u * k] += weight * (whole & ((1u << bits) - 1u));
    run_sums[2u + 2u * k] += weight * (whole >> bits);
}

void main() {
    uint first = element(64u) * RUN;
    uint current = NO_PART;
    for (uint k = 0u; k < MOMENTS; k++) {
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
