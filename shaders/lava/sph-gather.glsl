// Calls `gather`, which stands before this text, for every particle near one, in the order of the cells.

void gather_around(uint at, vec3 began) {
    uvec2 reach = reach_of(at);
    for (uint n = 0u; n < reach.x; n++) {
        gather(neighbour_of(at, n));
    }
    for (uint n = 0u; n < reach.y; n++) {
        uvec2 stretch = nth_stretch(began, n);
        for (uint i = stretch.x; i < stretch.y; i++) {
            gather(i);
        }
    }
}
