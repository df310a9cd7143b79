// Uniform block of the passes of stage three.

layout(set = 0, binding = 0, std140) uniform Scene {
    mat4 view_projection;
    vec3 glow; // the constant orange of section 7.2, RGB of the display
    float splat_radius_m;
    vec3 space_m; // sides of the simulation space
    float epsilon_m; // of eq. 7.1
    vec2 columns; // texels of the normal and height texture along x and z
    vec2 rock_texels; // along both sides of the rock, without the border
    float depth_per_m; // depths in the texture are eye-space depths scaled to at most 1
    float rock_tile_m; // side of the square that the rock texture covers once
    vec2 temperatures_k; // of a black body's colour, at the floor and at the top of the space
    float per_brightest; // 1 / the brightest primary of the hottest
    float is_blackbody; // 1 or 0
    float bare_m; // a place that is no higher above the ground has no lava, and nothing is drawn of it
    float fitted; // 1 for splats that cover discs of the map, 0 for discs on the surface
    vec3 eye_m;
    float daylight; // factor of the sky's light
    float gloss; // share of it that a fluid's skin mirrors
} scene;
