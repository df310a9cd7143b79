// The particles as squares that face the viewer. Lengths are in diagonals.

layout(set = 0, binding = 44, std140) uniform Billboards {
    vec3 right; // the picture's axis in space, a unit vector
    float particle_radius; // also the distance over which a particle fades towards the mesh
    vec3 up; // the other axis
    float depth_scale; // distance along the view = depth_scale / (depth_offset + depth)
    float depth_offset;
} billboards;
