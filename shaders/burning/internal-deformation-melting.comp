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

float longest() {
    return constants.omega * constants.mean_edge; // omega Dist
}

float shortest() {
    return longest() / constants.chi; // omega Dist / chi
}

// Ticks for which the same end of a tie gives way.
const uint PERIOD_TICKS = 8u;

// True for the source of the edge from `vertex` to `other`: the upper one, nearer heights than the shortest edge being
// a tie. The dissertation breaks ties at random; here the indices alternate. Within a period edges are restored one
// after the other from one end of the surface to the other; with periods of a tick each end undoes what the other has
// done, and the edges do not come to rest in range.
bool is_source(uint vertex, float y, uint other, float other_y) {
    if (abs(y - other_y) > shortest()) {
        return y > other_y;
    }
    return (vertex > other) == (clock.tick / PERIOD_TICKS % 2u == 0u);
}

// The step of the source s of an edge out of range; `fixed_points` of the triangle's corners do not flow. Upward motion
// would make no sense, so an edge too long is shortened along x and z alone. No step goes beyond the limit that the
// edge violates.
vec3 folded(vec3 s, vec3 d, uint fixed_points) {
    vec3 edge = s - d;
    float edge_length = length(edge);
    float fraction = constants.upsilon / float(fixed_points + 1u);
    if (edge_length > longest()) {
        float horizontal = length(edge.xz);
        if (horizontal <= 0.0) {
            return vec3(0.0);
        }
        float left = sqrt(max(0.0, longest() * longest() - edge.y * edge.y));
        return -min(fraction, 1.0 - left / horizontal) * vec3(edge.x, 0.0, edge.z);
    }
    return min(fraction, shortest() / edge_length - 1.0) * edge;
}

float violation(vec3 edge) {
    return max(0.0, length(edge.xz) - longest()) + max(0.0, shortest() - length(edge));
}

// Fractional folding (6.3.3): the mean of the steps that the edges out of range ask for. It is not taken where it would
// tear the vertex from those that hold it: what is not deformed yet, and what still burns above it. Without, the
// surface is pulled out from under the solid rest.
vec3 folding(uint vertex, vec3 s) {
    vec3 sum = vec3(0.0);
    float violating = 0.0;
    uint from = incidence_offsets[vertex];
    uint to = incidence_offsets[vertex + 1u];
    for (uint i = from; i < to; i++) {
        uint triangle = incidence[i] / 4u;
        uint corner = incidence[i] % 4u;
        uvec2 others = uvec2(triangles[3u * triangle + (corner + 1u) % 3u], triangles[3u * triangle + (corner + 2u) % 3u]);
        uint fixed_points = (labels[others.x] < READY ? 1u : 0u) + (labels[others.y] < READY ? 1u : 0u);
        for (int k = 0; k < 2; k++) {
            uint other = k == 0 ? others.x : others.y;
            vec3 d = old_state[other].position;
            float edge_length = length(s - d);
            bool is_violating = edge_length > longest() || (edge_length < shortest() && edge_length > 0.0);
            if (is_violating && is_source(vertex, s.y, other, d.y)) {
                sum += folded(s, d, fixed_points);
                violating += 1.0;
            }
        }
    }
    if (violating == 0.0) {
        return vec3(0.0);
    }
    vec3 fold = sum / violating;
    float growth = 0.0;
    for (uint i = from; i < to; i++) {
        uint triangle = incidence[i] / 4u;
        uint corner = incidence[i] % 4u;
        for (uint k = 1u; k < 3u; k++) {
            uint other = triangles[3u * triangle + (corner + k) % 3u];
            VertexState holder = old_state[other];
            bool is_above = holder.left > 0.0 && holder.position.y - s.y > shortest();
            if (labels[other] < DEFORMED || is_above) {
                growth += violation(s + fold - holder.position) - violation(s - holder.position);
            }
        }
    }
    return growth <= 0.0 ? fold : vec3(0.0);
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

// Share of its motion that wax has left: it sets once the fire has ended (ours; in the text it folds for ever).
float warmth() {
    float cold_ticks = (clock.radius - constants.last_radius) / constants.growth_per_tick;
    return clamp(1.0 - constants.setting_per_tick * cold_ticks, 0.0, 1.0);
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
