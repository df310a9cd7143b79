// A triangle is consumed when nothing is left at its three vertices that burns (3.5.4).

#include "burning/flammability.glsl"
#include "burning/vertices.glsl"

layout(set = 0, binding = 2, std430) readonly buffer Triangles {
    uint triangles[];
};

layout(set = 0, binding = 10, std430) readonly buffer NewState {
    VertexState new_state[];
};

bool is_consumed(uint triangle) {
    bool is_burnt = false;
    bool is_left = false;
    for (uint corner = 0u; corner < 3u; corner++) {
        uint vertex = triangles[3u * triangle + corner];
        bool is_spent = new_state[vertex].left <= 0.0;
        is_burnt = is_burnt || is_spent;
        is_left = is_left || !(is_spent || flammability_of(vertex) <= 0.0);
    }
    return is_burnt && !is_left;
}
