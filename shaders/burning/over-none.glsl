// A picture without fire.

vec3 with_fire(vec3 light, ivec2 pixel) {
    return light;
}
