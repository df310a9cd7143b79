#version 450

// The edges of the drawn triangles (figure 4.2): three lines a triangle, drawn a little in front of it.

#include "burning/clock.glsl"
#include "burning/view.glsl"
#include "burning/vertices.glsl"

layout(set = 0, binding = 6, std430) readonly buffer Welds {
    uint welds[];
};

layout(set = 0, binding = 18, std430) readonly buffer Clock {
    Counts clock;
};

layout(set = 0, binding = 19, std430) readonly buffer Mapped {
    MappedVertex mapped[];
};

layout(set = 0, binding = 22, std430) readonly buffer Stream {
    uint stream[];
};

const float LIFT = 0.004; // of the distance to the eye

void main() {
    uint number = uint(gl_VertexIndex);
    uint triangle = number / 6u;
    if (triangle >= clock.drawn_triangles) {
        gl_Position = vec4(2.0, 2.0, 2.0, 1.0); // outside the picture
        return;
    }
    uint edge = (number % 6u) / 2u;
    uint corner = stream[3u * triangle + (edge + number % 2u) % 3u];
    vec3 position = mapped[welds[corner]].position;
    gl_Position = view.view_projection * vec4(mix(position, view.eye, LIFT), 1.0);
}
