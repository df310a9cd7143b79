#version 450
// Section 2: the height of each column as grey.
layout(set = 0, binding = 0, std430) readonly buffer Heights {
    float heights[];
};
layout(location = 0) out vec4 color;

void main() {
    color = vec4(vec3(heights[int(gl_FragCoord.x)]), 1.0);
}
