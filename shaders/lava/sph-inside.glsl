// A place off bed and walls by the margin, below no ceiling; where the space repeats along x and z, as it is.
vec3 inside(vec3 place_m) {
    vec2 free = vec2(flow.periodic * 1.0e6);
    vec2 low = flow.margin_m - free;
    vec2 across = clamp(place_m.xz, low, flow.space_m.xz - low);
    vec3 ground = bed_at(across / flow.space_m.xz);
    float lowest_m = ground.z + flow.margin_m * length(vec3(ground.xy, 1.0));
    return vec3(across.x, max(min(place_m.y, flow.space_m.y - flow.margin_m), lowest_m), across.y);
}
