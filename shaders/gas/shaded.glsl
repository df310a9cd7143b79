// Light of a surface, by what material.glsl knows of it.

// Opacity of what shows of the fragment behind in place of one of this object; 0 where they do not overlap, and where both are
// of one object.
float shown_behind(uint behind, float overlap, Link next, uint object, float end_m) {
    if (overlap <= 0.0) {
        return 0.0;
    }
    uint other = surfaces[behind].y;
    float fade_m = uintBitsToFloat(object_words[6u * other + 3u].w);
    float shown = overlap * seen_opacity(color_at(behind), fade_m, mean_depth(next), end_m);
    return other != object ? shown : 0.0;
}

// Light that fragment f sends to the eye, per opacity. The highlight is Phong's.
vec3 shaded(uint f, Surface surface, Material material, vec3 color, float depth_m, vec3 ray) {
    vec3 point = frame.eye + ray * depth_m;
    vec3 direction = normalize(ray);
    vec3 normal = unpack_normal(surface.normal);
    normal = dot(normal, ray) > 0.0 ? -normal : normal;
    vec3 albedo = checkered(material, color, point, normal, ray);
    albedo = veined(surface.object, material.offset_m, albedo, point, normal, ray);
    vec3 sum = albedo * frame.ambient;
    uint l = 0u;
    do {
        take_light(l);
        LightRay to_light = ray_to_light(point);
        float facing = dot(normal, to_light.direction);
        if (facing > 0.0) {
            vec3 light = irradiance(to_light.distance_m);
            if (attenuation_count != 0u) {
                light *= 1.0 - attenuations[f * light_count + l];
            }
            float mirrored = max(dot(reflect(direction, normal), to_light.direction), 0.0);
            sum += light * (albedo * facing + material.highlight_strength * pow(mirrored, material.highlight_exponent));
        }
        if (l < light_count) {
            l++;
        }
    } while (l < light_count);
    is_cut = is_cut || l < light_count;
    return sum;
}
