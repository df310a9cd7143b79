// What the passes of stage three share.

layout(set = 0, binding = 0, std140) uniform Scene {
    mat4 view_projection;
    vec4 glow; // the constant orange of section 7.2
    vec3 space_m;
    float splat_radius_m;
    vec2 columns; // texels of the normal and height texture along x and z
    vec2 rock_texels; // without the border
    float epsilon_m;
    float depth_per_m; // depths in the texture are eye-space depths scaled to at most 1
    float rock_tile_m; // side of the square that the rock texture covers once
} scene;
