// A pixel's list when it has its sections.

layout(set = 0, binding = 7, std430) readonly buffer Heads {
    uint heads[];
};

layout(set = 0, binding = 8, std430) readonly buffer Links {
    uvec4 links[]; // each a Link
};

layout(set = 0, binding = 13, std430) readonly buffer Sections {
    uvec4 sections[]; // two of each section of gas
};

// Read as one vector: a load for each member made `resolve` a fifth slower on lavapipe.
Link link_at(uint fragment) {
    uvec4 link = links[fragment];
    return Link(link.x, link.y, uintBitsToFloat(link.z), uintBitsToFloat(link.w));
}

// The node itself, or the fragment after the sections that begin with it.
uint fragment_at(uint node) {
    uint fragment = node;
    bool is_found = false;
    do {
        if (fragment != NONE && is_section(fragment)) {
            fragment = sections[2u * (fragment & ~SECTION)].w;
        }
        if (fragment == NONE || !is_section(fragment)) {
            is_found = true;
        }
    } while (all(bvec2(fragment != NONE, is_section(fragment))));
    is_cut = is_cut || !is_found;
    return fragment;
}
