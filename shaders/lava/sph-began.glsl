// Places as the step begins. Storage images, as all that is read for each particle near one: lavapipe calls a function for a texel of a
// sampled image, beside which nothing stays in registers, and reads storage buffers lane by lane.

layout(set = 0, binding = 1, rgba32f) uniform readonly image2D places_by_cells; // metres

vec3 began_m(uint at) {
    return imageLoad(places_by_cells, texel_of(at)).xyz;
}
