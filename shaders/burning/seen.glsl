// A vertex of the mesh from the buffers that the simulation wrote: no vertex buffer, the stream of drawn triangles is
// the index buffer.

#include "burning/view.glsl"
#include "burning/vertices.glsl"

layout(set = 0, binding = 1, std430) readonly buffer Rest {
    RestVertex rest[];
};

layout(set = 0, binding = 6, std430) readonly buffer Welds {
    uint welds[];
};

layout(set = 0, binding = 19, std430) readonly buffer Mapped {
    MappedVertex mapped[];
};

layout(set = 0, binding = 20, std430) readonly buffer Normals {
    vec4 normals[]; // unit vector, how charred
};

layout(set = 0, binding = 21, std430) readonly buffer Colors {
    vec4 colors[]; // linear RGB, glow
};

layout(location = 0) out vec3 position;
layout(location = 1) out vec3 rest_position;
layout(location = 2) out vec4 normal;
layout(location = 3) out vec4 color;

#ifdef COLORS_AREAS
layout(set = 0, binding = 11, std430) readonly buffer Labels {
    uint labels[];
};

// From the outside in: cold, virtual, initial, combustion-ready, deformed.
vec3 area_color(uint label) {
    vec3 colors_of_areas[5] = vec3[5](
        vec3(0.6), vec3(0.1, 0.25, 0.8), vec3(0.8, 0.7, 0.1), vec3(0.8, 0.2, 0.03), vec3(0.08)
    );
    return colors_of_areas[min(label, 4u)];
}
#endif

#ifdef COLORS_BLOCKS
layout(set = 0, binding = 14, std430) readonly buffer Cells {
    uint cells[];
};

// Neighbouring numbers get unlike colours.
vec3 block_color(uint block) {
    uint h = (block + 1u) * 0x9e3779b9u;
    return 0.15 + 0.7 * vec3(h & 0xffu, (h >> 8u) & 0xffu, (h >> 16u) & 0xffu) / 255.0;
}
#endif

void see(uint corner) {
    uint vertex = welds[corner];
    position = mapped[vertex].position;
    rest_position = rest[vertex].position;
    normal = normals[corner];
    color = colors[corner];
#ifdef COLORS_AREAS
    color = vec4(area_color(labels[vertex]), 0.0);
#endif
#ifdef COLORS_BLOCKS
    color = vec4(block_color(cells[vertex]), 0.0);
#endif
    gl_Position = view.view_projection * vec4(position, 1.0);
}
