// The camera, the light and the shading of the picture.

layout(set = 0, binding = 30, std140) uniform View {
    mat4 view_projection;
    vec3 eye; // diagonals
    float ambient; // fraction of the light
    vec3 to_light; // unit vector
    uint shading; // LIT to NORMALS, or beyond as LIT
} view;

// Numbered as src/papers/burning/parameters.rs does.
const uint LIT = 0u;
const uint AREAS = 1u;
const uint BLOCKS = 2u;
const uint NORMALS = 3u;
