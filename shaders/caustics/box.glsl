// The receiver's box (section 4.2.1): x along U, y along V = -T, z along W, origin at the box's centre, metres.
// Rows of maps run along +W and columns along +U, so row 0 lies at z = -depth/2.

struct Box {
    vec3 u; // unit axis
    float center_u; // coordinate of the box's centre along it, metres
    vec3 v;
    float center_v;
    vec3 w;
    float center_w;
    vec3 extent; // width along U, height along V, depth along W, metres
    float texels; // texels a side of the box's maps
};

vec3 to_box(Box box, vec3 world) {
    return vec3(dot(box.u, world) - box.center_u, dot(box.v, world) - box.center_v, dot(box.w, world) - box.center_w);
}

// Orthographic clip space of the maps, looking along -V (eq. 4-10 to 4-13): depth 0 at height `top`, 1 at `bottom`.
vec4 to_map_clip(Box box, vec3 point, float top, float bottom) {
    return vec4(2.0 * point.x / box.extent.x, 2.0 * point.z / box.extent.z, (top - point.y) / (top - bottom), 1.0);
}
