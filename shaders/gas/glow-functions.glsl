// Gases of density functions do not glow.

vec3 glow_at(vec3 world) {
    return vec3(0.0);
}
