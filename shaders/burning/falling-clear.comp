#version 450

// Before the contacts are found.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/parts.glsl"
#include "burning/contacts.glsl"

layout(set = 0, binding = 76, std430) buffer Balls {
    uint balls[];
};

layout(set = 0, binding = 70, std430) buffer Contacts {
    int contacts[];
};

void main() {
    // By as many threads as there are: while nothing falls there are none but every fourth tick.
    uint stride = 64u * gl_NumWorkGroups.x * gl_NumWorkGroups.y;
    for (uint i = element(64u); i < max(MOST_PARTS * WORDS, ENTRIES); i += stride) {
        if (i < MOST_PARTS * WORDS) {
            contacts[i] = i % WORDS < DIRECTIONS ? -FARTHEST : FARTHEST;
        }
        if (i < ENTRIES) {
            for (uint layer = 0u; layer < LAYERS + 2u; layer++) {
                balls[layer * ENTRIES + i] = 0xffffffffu;
            }
        }
    }
}
