// Lights at infinity or at a point.

struct Light {
    vec3 source; // position of a point light, m; unit direction towards one at infinity
    uint is_point; // 1 or 0
    vec3 intensity; // linear RGB
};

layout(set = 0, binding = 2, std430) readonly buffer Lights {
    Light lights[];
};
