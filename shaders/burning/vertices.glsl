// Elements of the buffers of vertices. Lengths are in diagonals.

struct RestVertex {
    vec3 position;
    float boundary_distance; // R: the radius at which the boundary reaches it (3.3)
};

struct VertexState {
    vec3 position;
    float left; // L, ticks
};

struct MappedVertex {
    vec3 position; // rotated with its block
    float left_fraction; // L / L0
};

struct BaseDisplacement {
    vec3 offset; // of the base point since the start
    float is_active; // 0 or 1
};
