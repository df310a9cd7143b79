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
    uint thread = element(64u);
    if (thread < MOST_PARTS * WORDS) {
        contacts[thread] = thread % WORDS < DIRECTIONS ? -FARTHEST : FARTHEST;
    }
    if (thread < ENTRIES) {
        for (uint layer = 0u; layer < LAYERS; layer++) {
            balls[layer * ENTRIES + thread] = 0xffffffffu;
        }
    }
}
