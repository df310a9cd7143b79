// I_d of eq. 4-19 without the light's intensity: albedo x max(0, N . (-T)), and V = -T.

vec4 diffuse_light(vec3 albedo, vec3 normal, vec3 v) {
    return vec4(albedo * max(0.0, dot(normalize(normal), v)), 1.0);
}
