// Surfaces without solid textures.

vec3 veined(uint object, vec3 offset_m, vec3 color, vec3 point, vec3 normal, vec3 ray) {
    return color;
}
