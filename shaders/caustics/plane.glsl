// One reference plane and the cell of heights that it accepts (section 4.2.1 and 4.4).

layout(push_constant) uniform Plane {
    vec2 center; // of the box along U and W, from the rays' reference point, metres
    vec2 to_clip; // 2 / width and 2 / depth
    float height; // of the plane along V, from the rays' reference point, metres
    float lower; // lowest height accepted, along V from the box's centre, metres
    float upper; // first height no longer accepted
    float absorption_per_m; // K of eq. 4-17
    float texel_area_m2;
    vec3 up; // of the world, along U, V, W
} plane;
