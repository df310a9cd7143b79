// The receiver of a culled caustics map (section 6.1).

layout(push_constant) uniform Plane {
    vec2 center; // of the box along U and W, from the rays' reference point, metres
    vec2 to_clip; // 2 / width and 2 / depth
    vec3 up; // of the world, along U, V, W
    float absorption_per_m; // K of eq. 4-17
    float texel_area_m2;
    uint vertices; // of the water
} plane;
