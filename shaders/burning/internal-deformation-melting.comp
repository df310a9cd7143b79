#version 450

// Internal deformation of what melts (6.3): flow-true vertices follow the base points, and the fractional folding keeps
// the edges around them in range; the others are fixed points. Appendix C's code does otherwise and yields to the text.

layout(local_size_x = 128) in;

#include "burning/constants.glsl"
#include "burning/chunks.glsl"
#include "burning/clock.glsl"
#include "burning/grid.glsl"
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

layout(set = 0, binding = 7, std430) readonly buffer BasePoints {
    uint base_points[];
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

layout(set = 0, binding = 18, std430) readonly buffer Clock {
    Counts clock;
};

layout(set = 0, binding = 24, std430) readonly buffer Alive {
    uint alive[];
};

layout(set = 0, binding = 51, std430) readonly buffer NewBases {
    BaseDisplacement new_bases[];
};

layout(set = 0, binding = 52, std430) buffer Flows {
    vec4 flows[]; // how far the vertex has followed; 1 where it keeps its place
};

#include "burning/folding.glsl"

layout(push_constant, std430) uniform Slice {
    uint number; // of the slices of a tick (3.7.2): each takes its turn of the chunks
    uint division;
} slice;

// Displacement of the base points around the vertex's position at rest, interpolated between the blocks' middles. A
// step alone would leave those behind that become flow-true later than their base point, and blocks that move as a
// whole would tear the surface.
vec3 guided(vec3 position) {
    vec3 at = (position - constants.grid_origin) / constants.block_size - 0.5;
    ivec3 low = ivec3(floor(at));
    vec3 t = at - vec3(low);
    ivec3 size = ivec3(constants.blocks);
    vec3 sum = vec3(0.0);
    float weights = 0.0;
    for (int i = 0; i < 8; i++) {
        ivec3 corner = ivec3(i & 1, (i >> 1) & 1, i >> 2);
        ivec3 block = low + corner;
        if (all(greaterThanEqual(block, ivec3(0))) && all(lessThan(block, size))) {
            uint cell = uint((block.z * size.y + block.y) * size.x + block.x);
            if (base_points[cell] != NONE) {
                vec3 near = mix(1.0 - t, t, vec3(corner));
                float weight = near.x * near.y * near.z;
                sum += weight * new_bases[cell].offset;
                weights += weight;
            }
        }
    }
    return weights > 0.0 ? sum / weights : vec3(0.0);
}

// Fraction of its distance to the guides that a vertex covers in a tick: 1 - omega in the time in which the boundary
// crosses an area. What flows so does not outrun the heat; faster, the triangles between it and what does not flow yet
// would be drawn out into sheets, which are more surface higher up than there was before.
float following() {
    return (1.0 - constants.omega) * min(1.0, constants.growth_per_tick / constants.area_width);
}

// g dt^2 by the mean epsilon of the edges around the vertex.
float fall_of(uint vertex) {
    float epsilons = 0.0;
    uint from = incidence_offsets[vertex];
    uint to = incidence_offsets[vertex + 1u];
    for (uint i = from; i < to; i++) {
        epsilons += meltabilities_at(incidence[i] / 4u, incidence[i] % 4u);
    }
    return constants.gravity_per_tick * epsilons / float(max(2u * (to - from), 1u));
}

void main() {
    uint vertex = element_visited();
    if (workgroup() % slice.division != slice.number || vertex >= constants.vertex_count) {
        return;
    }
    VertexState before = old_state[vertex];
    uint label = labels[vertex];
    if (label < READY || alive[vertex] == 0u) {
        new_state[vertex] = before;
        return;
    }
    bool is_burning = label == DEFORMED && before.left > 0.0;
    float left = is_burning ? before.left - 1.0 : before.left;
    if (flows[vertex].w > 0.0) {
        new_state[vertex] = VertexState(before.position, left);
        return;
    }
    vec3 flow = flows[vertex].xyz;
    float warm = warmth();
    vec3 follow = warm * following() * (guided(rest[vertex].position) - flow);
    flows[vertex] = vec4(flow + follow, 0.0);
    vec3 position = before.position + follow + warm * folding(vertex, before.position);
    position.y -= is_burning ? fall_of(vertex) : 0.0; // gravity
    position.y = max(position.y, constants.floor_y);
    new_state[vertex] = VertexState(position, left);
}
