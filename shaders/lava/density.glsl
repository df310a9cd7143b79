// The grid of section 6.1 under its orthographic camera from above: texel centres are grid points.

layout(push_constant, std430) uniform Grid {
    vec4 plane_heights_m; // four successive grid planes
    vec3 space_m;
    float radius_m; // h, the effective radius of a particle
    vec2 columns; // grid points along x and z
    float point_size_px; // eq. 6.1
    float peak; // F(0, h)
} grid;
