// Section "Calculation of the shadow table": the eight entries round the point, interpolated. Outside the volume's box
// the table is read where the light's ray enters it.

layout(set = 0, binding = 16, std430) readonly buffer ShadowTables {
    float shadow_tables[]; // a table a volume and light
};

float table_value(uint l, vec3 point) {
    uint n = frame.table_size;
    vec3 q = (point - in_hand.center) / in_hand.half_extent_m * 0.5 + 0.5;
    vec3 position = clamp(q, 0.0, 1.0) * float(n - 1u);
    uvec3 low = min(uvec3(position), uvec3(n - 2u));
    vec3 t = position - vec3(low);
    uint first = (index_in_hand * light_count + l) * n * n * n + (low.z * n + low.y) * n + low.x;
    uint up = first + n * n;
    float s00 = mix(shadow_tables[first], shadow_tables[first + 1u], t.x);
    float s10 = mix(shadow_tables[first + n], shadow_tables[first + n + 1u], t.x);
    float s01 = mix(shadow_tables[up], shadow_tables[up + 1u], t.x);
    float s11 = mix(shadow_tables[up + n], shadow_tables[up + n + 1u], t.x);
    return mix(mix(s00, s10, t.y), mix(s01, s11, t.y), t.z);
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
        v++;
    } while (v < volume_count);
    is_cut = is_cut || v < volume_count;
    return sum;
}

// Of the light in hand, which is that number's.
float transmittance_to(uint l, vec3 point) {
    return exp(-optical_depth_to(l, point));
}
