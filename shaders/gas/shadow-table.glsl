// Section "Calculation of the shadow table": the eight entries round the point, interpolated. Outside the volume's box
// the table is read where the light's ray enters it.

layout(set = 0, binding = 16, std430) readonly buffer ShadowTables {
    vec2 shadow_tables[]; // a table a volume and light: of an entry, and of the one after it in x
};

float table_value(uint l, vec3 point) {
    uint n = frame.table_size;
    vec3 q = (point - in_hand.center) / in_hand.half_extent_m * 0.5 + 0.5;
    vec3 position = clamp(q, 0.0, 1.0) * float(n - 1u);
    uvec3 low = min(uvec3(position), uvec3(n - 2u));
    vec3 t = position - vec3(low);
    uint first = (index_in_hand * light_count + l) * n * n * n + (low.z * n + low.y) * n + low.x;
    uint up = first + n * n;
    vec2 s00 = shadow_tables[first];
    vec2 s10 = shadow_tables[first + n];
    vec2 s01 = shadow_tables[up];
    vec2 s11 = shadow_tables[up + n];
    vec4 sides = mix(vec4(s00.x, s10.x, s01.x, s11.x), vec4(s00.y, s10.y, s01.y, s11.y), t.x);
    return mix(mix(sides.x, sides.y, t.y), mix(sides.z, sides.w, t.y), t.z);
}

float optical_depth_to(uint l, vec3 point) {
    LightRay to_light = ray_to_light(point);
    float sum = 0.0;
    uint v = 0u;
    do {
        take_volume(v);
        vec2 segment = intersect(bounds_segment(point, to_light.direction), vec2(0.0, to_light.distance_m));
        if (segment.x <= segment.y) {
            sum += in_hand.tau_per_m * table_value(l, point + to_light.direction * segment.x);
        }
        if (v < volume_count) {
            v++;
        }
    } while (v < volume_count);
    is_cut = is_cut || v < volume_count;
    return sum;
}

// Of the light in hand, which is that number's.
float transmittance_to(uint l, vec3 point) {
    return exp(-optical_depth_to(l, point));
}
