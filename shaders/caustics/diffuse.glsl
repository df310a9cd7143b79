// I_d of eq. 4-19 without the light's intensity: albedo x max(0, N . (-T)), and V = -T.

vec4 diffuse_light(vec3 albedo, vec3 normal, vec3 v) {
    // Opposite normals of neighbours may cancel: such a point gets no light, rather than one over zero.
    float cos_light = dot(normal, v) / max(length(normal), 1.0e-12);
    return vec4(albedo * max(0.0, cos_light), 1.0);
}
