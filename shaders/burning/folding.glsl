// The fractional folding (6.3.3) of what melts. Of an edge out of range its upper end moves, as in the text, while there is
// fire. Ours is what happens while wax sets: an upper end that is held on the other side by edges just as long cannot give,
// so that many edges would set out of range. Then both ends of an edge move, half of its step each (Müller et al. 2007),
// and half as far again, for means of steps that work against each other fall short of them (Macklin et al. 2014).

const float SETTING_SHARE = 0.75; // of its step that each end takes

// Ticks since the last vertex has burnt out; below 0 before.
float cold_ticks() {
    return (clock.radius - constants.last_radius) / constants.growth_per_tick;
}

// Share of its motion that wax has left: it sets once the fire has ended (ours; in the text it folds for ever).
float warmth() {
    return clamp(1.0 - constants.setting_per_tick * cold_ticks(), 0.0, 1.0);
}

// True once it begins to set.
bool is_setting() {
    return constants.setting_per_tick * cold_ticks() > 0.0;
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

// The step of s, and 1, if its edge to another vertex is out of range and s is to give way.
vec4 asked(uint vertex, vec3 s, uint other, uint fixed_points) {
    vec3 d = old_state[other].position;
    float edge_length = length(s - d);
    bool is_violating = edge_length > longest() || (edge_length < shortest() && edge_length > 0.0);
    bool gives_way = is_violating && (is_setting() || is_source(vertex, s.y, other, d.y));
    return gives_way ? vec4(folded(s, d, fixed_points), 1.0) : vec4(0.0);
}

float violation(vec3 edge) {
    return max(0.0, length(edge.xz) - longest()) + max(0.0, shortest() - length(edge));
}

// By which a step of s moves it out of range of another vertex that holds it.
float torn(vec3 s, vec3 fold, uint other) {
    VertexState holder = old_state[other];
    bool is_above = holder.left > 0.0 && holder.position.y - s.y > shortest();
    bool holds = labels[other] < DEFORMED || is_above;
    return holds ? violation(s + fold - holder.position) - violation(s - holder.position) : 0.0;
}

// Fractional folding (6.3.3): the mean of the steps that the edges out of range ask for. It is not taken where it would
// tear the vertex from those that hold it: what is not deformed yet, and what still burns above it. Without, the
// surface is pulled out from under the solid rest.
vec3 folding(uint vertex, vec3 s) {
    vec4 sum = vec4(0.0);
    uint from = incidence_offsets[vertex];
    uint to = incidence_offsets[vertex + 1u];
    for (uint i = from; i < to; i++) {
        uint triangle = incidence[i] / 4u;
        uint corner = incidence[i] % 4u;
        uvec2 others = uvec2(triangles[3u * triangle + (corner + 1u) % 3u], triangles[3u * triangle + (corner + 2u) % 3u]);
        uint fixed_points = (labels[others.x] < READY ? 1u : 0u) + (labels[others.y] < READY ? 1u : 0u);
        sum += asked(vertex, s, others.x, fixed_points);
        sum += asked(vertex, s, others.y, fixed_points);
    }
    if (sum.w == 0.0) {
        return vec3(0.0);
    }
    vec3 fold = (is_setting() ? SETTING_SHARE : 1.0) * sum.xyz / sum.w;
    float growth = 0.0;
    for (uint i = from; i < to; i++) {
        uint triangle = incidence[i] / 4u;
        uint corner = incidence[i] % 4u;
        growth += torn(s, fold, triangles[3u * triangle + (corner + 1u) % 3u]);
        growth += torn(s, fold, triangles[3u * triangle + (corner + 2u) % 3u]);
    }
    return growth <= 0.0 ? fold : vec3(0.0);
}
