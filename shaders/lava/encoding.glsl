// The display's encoding of linear light (IEC 61966-2-1), and back.
vec3 encoded(vec3 light) {
    vec3 bent = 1.055 * pow(max(light, 0.0031308), vec3(1.0 / 2.4)) - 0.055;
    return mix(12.92 * light, bent, step(vec3(0.0031308), light));
}

vec3 decoded(vec3 value) {
    vec3 bent = pow((max(value, 0.04045) + 0.055) / 1.055, vec3(2.4));
    return mix(value / 12.92, bent, step(vec3(0.04045), value));
}
