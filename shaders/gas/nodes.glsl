// A pixel's list when it has its sections.

layout(set = 0, binding = 7, std430) readonly buffer Heads {
    uint heads[];
};

layout(set = 0, binding = 8, std430) readonly buffer Links {
    Link links[];
};

layout(set = 0, binding = 13, std430) readonly buffer Sections {
    Section sections[];
};

// The node itself, or the fragment after the sections that begin with it.
uint fragment_at(uint node) {
    uint fragment = node;
    while (fragment != NONE && is_section(fragment)) {
        fragment = sections[fragment & ~SECTION].next;
    }
    return fragment;
}
