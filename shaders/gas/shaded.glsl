// Light of a surface, by what material.glsl knows of it.

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
        l++;
    } while (l < light_count);
    is_cut = is_cut || l < light_count;
    return sum;
}
