#version 450

// The parts of the search that has ended take the place of those before.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/constants.glsl"
#include "burning/parting.glsl"
#include "burning/parts.glsl"

layout(set = 0, binding = 60, std430) readonly buffer Roots {
    uint roots[];
};

layout(set = 0, binding = 61, std430) readonly buffer Attached {
    uint attached[];
};

layout(set = 0, binding = 63, std430) readonly buffer Searching {
    Progress progress;
};

layout(set = 0, binding = 64, std430) readonly buffer Numbers {
    uint numbers[];
};

layout(set = 0, binding = 65, std430) buffer PartOf {
    uint part_of[];
};

layout(set = 0, binding = 66, std430) buffer Parts {
    Part parts[];
};

layout(set = 0, binding = 67, std430) readonly buffer Inherited {
    Part inherited[];
};

void main() {
    uint thread = element(64u);
    if (progress.is_numbered == 0u) {
        return;
    }
    if (thread < min(progress.part_count, MOST_PARTS)) {
        parts[thread] = inherited[thread];
    }
    if (thread < constants.vertex_count) {
        part_of[thread] = (attached[thread] & 1u) == 0u ? NO_PART : min(numbers[roots[thread]], DUST);
    }
}
