// The unit normal of a surface y(x, z) with these slopes along x and z.
vec3 surface_normal(vec2 slope) {
    return normalize(vec3(-slope.x, 1.0, -slope.y));
}
