// Calls `gather`, which stands before this text, for every particle near one, in the order of the cells, four of a list in a
// turn. What only fills its last four up has the weight 0, all others 1.

void gather_around(uint at, vec3 began) {
    uvec2 reach = reach_of(at);
    for (uint first = 0u; first < reach.x; first += 4u) {
        uvec4 four = neighbours_of(at, first);
        vec4 weights = weights_of(reach.x - first);
        gather(four.x, weights.x);
        gather(four.y, weights.y);
        gather(four.z, weights.z);
        gather(four.w, weights.w);
    }
    for (uint n = 0u; n < reach.y; n++) {
        uvec2 stretch = nth_stretch(began, n);
        for (uint i = stretch.x; i < stretch.y; i++) {
            gather(i, 1.0);
        }
    }
}
