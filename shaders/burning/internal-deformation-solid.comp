#version 450

// Internal deformation of a solid (5.3.3, 5.3.4): after the displacement of 3.4, each triangle draws its vertex
// inwards, to the point P_in beneath its centroid, as deep as the side BA is long. The printed angles lose the
// quadrant; this is their vector form, and no step goes beyond half the distance. 5.5: a vertex that has burnt far
// enough leaves the group that deforms.
//
// Nothing printed ends the motion inwards: with a great beta L surfaces would pass each other, and the solid turn
// inside out. Ours ends at a char's depth, three quarters of the solid's volume over its surface (a quarter of a ball's
// radius): what lies deeper stays enclosed.

layout(local_size_x = 128) in;

#include "burning/constants.glsl"
#include "burning/chunks.glsl"
#include "burning/block-levels.glsl"
#include "burning/displacement.glsl"
#include "burning/flammability.glsl"
#include "burning/meltability.glsl"
#include "burning/vertices.glsl"

layout(set = 0, binding = 1, std430) readonly buffer Rest {
    RestVertex rest[];
};

layout(set = 0, binding = 2, std430) readonly buffer Triangles {
    uint triangles[];
};

layout(set = 0, binding = 3, std430) readonly buffer IncidenceOffsets {
    uint incidence_offsets[];
};

layout(set = 0, binding = 4, std430) readonly buffer Incidence {
    uint incidence[]; // triangle * 4 + corner, ascending
};

layout(set = 0, binding = 9, std430) readonly buffer OldState {
    VertexState old_state[];
};

layout(set = 0, binding = 10, std430) buffer NewState {
    VertexState new_state[];
};

layout(set = 0, binding = 11, std430) readonly buffer Labels {
    uint labels[];
};

layout(set = 0, binding = 24, std430) readonly buffer Alive {
    uint alive[];
};

layout(set = 0, binding = 83, std430) readonly buffer RestCells {
    uint rest_cells[];
};

layout(push_constant, std430) uniform Slice {
    uint number; // of the slices of a tick (3.7.2): each takes its turn of the chunks
    uint division;
} slice;

// The position that the displaced corner `d` of triangle ABC is drawn to; B is the corner, C and A follow it in the
// triangle's order.
vec3 contracted(vec3 a, vec3 b, vec3 c, vec3 d, float l) {
    vec3 normal = cross(c - b, a - b);
    float double_area = length(normal);
    if (double_area <= 0.0) {
        return d;
    }
    float depth = length(a - b);
    vec3 inner = (a + b + c) / 3.0 - constants.outward * depth / double_area * normal;
    float distance_to_inner = length(inner - d);
    return distance_to_inner > 0.0 ? d + min(l * depth, 0.5 * distance_to_inner) / distance_to_inner * (inner - d) : d;
}

// The position, no farther than the char's depth from that at rest, which sinks with it.
vec3 within_char(vec3 position, vec3 at_rest, float fallen) {
    vec3 from = at_rest - vec3(0.0, fallen, 0.0);
    float depth = distance(position, from);
    return depth > constants.char_depth ? from + constants.char_depth / depth * (position - from) : position;
}

void main() {
    uint vertex = element_visited();
    if (workgroup() % slice.division != slice.number || vertex >= constants.vertex_count) {
        return;
    }
    VertexState before = old_state[vertex];
    if (labels[vertex] != DEFORMED || before.left <= constants.retire_at * flammability_of(vertex) || alive[vertex] == 0u) {
        new_state[vertex] = before;
        return;
    }
    vec3 b = before.position;
    float flammability = flammability_of(vertex);
    float left_fraction = before.left / flammability;
    BlockLevels block = block_levels[rest_cells[vertex]];
    vec3 sum = vec3(0.0);
    float epsilons = 0.0;
    uint from = incidence_offsets[vertex];
    uint to = incidence_offsets[vertex + 1u];
    for (uint i = from; i < to; i++) {
        uint triangle = incidence[i] / 4u;
        uint corner = incidence[i] % 4u;
        uint vertex_a = triangles[3u * triangle + (corner + 2u) % 3u];
        uint vertex_c = triangles[3u * triangle + (corner + 1u) % 3u];
        vec3 a = old_state[vertex_a].position;
        vec3 c = old_state[vertex_c].position;
        float l = fraction_along(block, length(a - b), labels[vertex_a] >= INITIAL, left_fraction);
        float m = fraction_along(block, length(c - b), labels[vertex_c] >= INITIAL, left_fraction);
        sum += contracted(a, b, c, cevians_meet(a, b, c, l, m), l) - b;
        epsilons += meltabilities_at(triangle, corner);
    }
    vec3 moved = b + sum / float(max(to - from, 1u));
    float fall = constants.gravity_per_tick * epsilons / float(max(2u * (to - from), 1u));
    moved.y -= fall; // gravity
    float left = before.left - 1.0;
    new_state[vertex] = VertexState(within_char(moved, rest[vertex].position, fall * (flammability - left)), left);
}
