// The receiver's box (section 4.2.1): x along U, y along V = -T, z along W, origin at the box's centre, metres.
// Rows of maps run along +W and columns along +U, so row 0 lies at z = -depth/2.

struct Box {
    vec4 u; // axis, and the centre's coordinate along it
    vec4 v;
    vec4 w;
    vec4 extent; // width along U, height along V, depth along W, in metres; then the map's texels a side
};

vec3 to_box(Box box, vec3 world) {
    return vec3(dot(box.u.xyz, world) - box.u.w, dot(box.v.xyz, world) - box.v.w, dot(box.w.xyz, world) - box.w.w);
}

vec3 direction_to_box(Box box, vec3 world) {
    return vec3(dot(box.u.xyz, world), dot(box.v.xyz, world), dot(box.w.xyz, world));
}

// Orthographic clip space of the maps, looking along -V (eq. 4-10 to 4-13): depth 0 at height `top`, 1 at `bottom`.
vec4 to_map_clip(Box box, vec3 point, float top, float bottom) {
    return vec4(2.0 * point.x / box.extent.x, 2.0 * point.z / box.extent.z, (top - point.y) / (top - bottom), 1.0);
}
