// One reference plane, as the caustics map needs it beside the thesis's own reading: drawn at a multiple of the map's size, with
// intensities per vertex, or with shadows between receivers.

layout(push_constant) uniform Plane {
    vec2 center; // of the box along U and W, from the rays' reference point, metres
    vec2 to_clip; // 2 / width and 2 / depth
    float height; // of the plane along V, from the rays' reference point, metres
    float lower; // lowest height accepted, along V from the box's centre, metres
    float upper; // first height no longer accepted
    float absorption_per_m; // K of eq. 4-17
    float texel_area_m2; // of the map that is drawn
    uint coverage; // texels a side that are drawn for a texel of the position map
    uint by_vertex; // 1 where intensities belong to vertices
    uint columns; // vertices of the water's mesh along x
    vec3 up; // of the world, along U, V, W
    uint rows; // and along z
    vec2 shadow_center; // of the shadow map's box along U and W, from the reference point, metres
    vec2 shadow_texels_per_m;
    float shadow_middle; // height of that box's centre along V, from the reference point, metres
    float shadow_top; // of its top
    float receiver; // index of this one
} plane;
