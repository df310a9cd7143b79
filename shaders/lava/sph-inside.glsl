// A place off the walls by the margin, below no ceiling; where the space repeats along x and z, as it is.
vec3 inside(vec3 place_m) {
    vec2 free = vec2(flow.periodic * 1.0e6);
    vec3 low = vec3(flow.margin_m - free.x, flow.margin_m, flow.margin_m - free.y);
    vec3 high = vec3(flow.space_m.x + free.x, flow.space_m.y, flow.space_m.z + free.y) - flow.margin_m;
    return clamp(place_m, low, high);
}
