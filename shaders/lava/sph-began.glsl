// Places as the step begins in one texel each, for those who look at many.

layout(set = 0, binding = 15) uniform texture2D began; // metres

vec3 began_near_m(uint at) {
    return texelFetch(began, texel_of(at), 0).xyz;
}
