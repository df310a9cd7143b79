// A surface under the sun alone.

vec3 shone_on(vec3 albedo, float sun, vec3 place, vec3 n) {
    return albedo * sun;
}
