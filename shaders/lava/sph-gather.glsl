// Calls `gather`, which stands before this text, for every particle near one, in the order of the cells.

void gather_around(uint at, vec3 began) {
    uvec2 reach = reach_of(at);
    for (uint first = 0u; first < reach.x; first += 4u) {
        vec4 four = neighbours_of(at, first);
        uint count = min(reach.x - first, 4u);
        for (uint n = 0u; n < count; n++) {
            gather(uint(four.x));
            four = four.yzwx;
        }
    }
    for (uint n = 0u; n < reach.y; n++) {
        uvec2 stretch = nth_stretch(began, n);
        for (uint i = stretch.x; i < stretch.y; i++) {
            gather(i);
        }
    }
}
