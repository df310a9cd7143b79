// Counters that the device keeps by itself: none of them is transferred (3.7.4).

struct Counts {
    uint tick;
    uint growth_ticks; // ticks in which the boundary grew
    float radius; // r of the boundary
    uint active_vertices; // deformed, with some L left
    uint active_triangles; // with an active vertex
    uint live_vertices; // with some L left
    uint ready_vertices; // live, in the combustion-ready area
    uint removed_triangles;
    uint drawn_triangles;
    uint fire_particles;
    uint smoke_particles;
};
