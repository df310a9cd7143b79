// A ray for each pixel, its length along the view 1, and what else shades it.

layout(push_constant, std430) uniform Rays {
    vec2 drift_m; // distance that the rock has moved with the lava, along x and z
    uint mode; // the one of the thesis's pictures that is drawn
    float near_m;
    vec3 eye_m;
    float far_m;
    vec3 first; // direction to the corner of the first pixel; its length along the view is 1
    vec3 across; // to the next pixel of a row
    vec3 down; // to the next row
} shading;

vec3 ray_through(vec2 pixel) {
    return shading.first + pixel.x * shading.across + pixel.y * shading.down;
}
