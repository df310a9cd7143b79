// The camera and the light of the picture.

layout(set = 0, binding = 30, std140) uniform View {
    mat4 view_projection;
    vec3 eye; // diagonals
    float ambient; // fraction of the light
    vec3 to_light; // unit vector
} view;
