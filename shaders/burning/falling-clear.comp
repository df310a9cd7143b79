#version 450

// Before the contacts are found.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/parts.glsl"
#include "burning/contacts.glsl"

layout(set = 0, binding = 76, std430) buffer Lying {
    uint lying[];
};

layout(set = 0, binding = 70, std430) buffer Contacts {
    int contacts[];
};

void main() {
    uint thread = element(64u);
    if (thread < MOST_PARTS * WORDS) {
        contacts[thread] = thread % WORDS < DIRECTIONS ? -FARTHEST : FARTHEST;
    }
    if (thread < 65536u) {
        lying[thread] = 0xffffffffu;
    }
}
