// The particles as squares that face the viewer. Lengths are in diagonals.

layout(set = 0, binding = 44, std140) uniform Billboards {
    vec3 right; // the picture's axis in space, a unit vector
    float particle_radius; // also the distance over which a particle fades towards the mesh
    vec3 up; // the other axis
    float depth_scale; // distance along the view = depth_scale / (depth_offset + depth)
    float depth_offset;
    uint layer_scale; // pixels of the picture along a side of a pixel of the fire's layer
    uvec2 last_pixel; // of the picture
    float fire_light; // factor of the light of the flames
    uvec2 layer_size; // pixels of the fire's layer
} billboards;

// Distance along the view of a depth of the picture.
float eye_distance(float depth) {
    return billboards.depth_scale / (billboards.depth_offset + depth);
}

// The pixel of the picture in the middle of a pixel of the layer.
ivec2 layer_pixel(ivec2 texel) {
    int scale = int(billboards.layer_scale);
    return min(texel * scale + scale / 2, ivec2(billboards.last_pixel));
}
