// How the object is seen.

layout(set = 0, binding = 30, std140) uniform View {
    mat4 view_projection;
    vec4 eye;
    vec4 to_light; // unit; ambient light
    uvec4 mode; // what the mesh is coloured by
} view;

// Numbered as src/papers/burning/parameters.rs does.
const uint LIT = 0u;
const uint AREAS = 1u;
const uint BLOCKS = 2u;
const uint NORMALS = 3u;
