// The particles as squares that face the viewer.

layout(set = 0, binding = 44, std140) uniform Billboards {
    vec4 right; // of the picture, in space; radius of a particle
    vec4 up;
    vec4 depth; // distance along the view = x / (y + depth); distance over which a particle fades towards the mesh
} billboards;
