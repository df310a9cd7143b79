#version 450

// The bend of each vertex, between those of the sections that it goes with: their mean rotation, and its place at rest
// where their places are in the mean. What has come off keeps the bend that it came off with.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/constants.glsl"
#include "burning/parts.glsl"
#include "burning/sections.glsl"
#include "burning/vertices.glsl"

layout(set = 0, binding = 1, std430) readonly buffer Rest {
    RestVertex rest[];
};

layout(set = 0, binding = 65, std430) readonly buffer PartOf {
    uint part_of[];
};

layout(set = 0, binding = 101, std430) buffer Bends {
    Bend bends[]; // of vertices
};

layout(set = 0, binding = 106, std430) readonly buffer Holds {
    Hold holds[];
};

layout(set = 0, binding = 107, std430) readonly buffer Loads {
    Load loads[];
};

layout(set = 0, binding = 109, std430) readonly buffer SectionBends {
    Bend section_bends[];
};

void main() {
    uint vertex = element(64u);
    if (vertex >= constants.vertex_count) {
        return;
    }
    Hold hold = holds[vertex];
    uint own = hold.sections & 0xffffu;
    uint other = hold.sections >> 16u;
    if (part_of[vertex] >= MOST_PARTS || part_of[vertex] != loads[own].part) {
        return;
    }
    if (loads[other].part != loads[own].part) {
        other = own;
    }
    Bend near = section_bends[own];
    Bend far = section_bends[other];
    vec3 place = rest[vertex].position;
    vec3 to = mix(turned(near.turn, place) + near.offset, turned(far.turn, place) + far.offset, hold.share);
    // Of q and -q, which are the same rotation, the one that is nearer.
    vec4 turn = normalize(mix(near.turn, dot(near.turn, far.turn) < 0.0 ? -far.turn : far.turn, hold.share));
    bends[vertex] = Bend(turn, to - turned(turn, place));
}
