#version 450

#pragma variants SURFACE=one,several

// Normals of the mapped mesh (appendix B: summed over triangles), weighted by area, gathered by draw vertex; and the
// colour of its charring: the albedo of what chars fades from the initial boundary to the deformed area, and what has
// just reached combustion glows; metal glows while the fire is near it. Ours, by the natural look: what is charred and
// still burns glows in patches that wander upwards. What has not changed since the last picture stays.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/constants.glsl"
#include "burning/clock.glsl"
#include "burning/shown.glsl"
#include "burning/substances.glsl"
#include "burning/vertices.glsl"
#include "burning/wood.glsl"

layout(set = 0, binding = 1, std430) readonly buffer Rest {
    RestVertex rest[];
};

layout(set = 0, binding = 2, std430) readonly buffer Triangles {
    uint triangles[];
};

layout(set = 0, binding = 6, std430) readonly buffer Welds {
    uint welds[];
};

layout(set = 0, binding = 7, std430) readonly buffer CornerIncidenceOffsets {
    uint corner_incidence_offsets[];
};

layout(set = 0, binding = 8, std430) readonly buffer CornerIncidence {
    uint corner_incidence[]; // triangle * 4 + corner, ascending
};

layout(set = 0, binding = 24, std430) readonly buffer Alive {
    uint alive[];
};

layout(set = 0, binding = 13, std430) readonly buffer Removed {
    uint removed[];
};

layout(set = 0, binding = 18, std430) readonly buffer Clock {
    Counts clock;
};

layout(set = 0, binding = 19, std430) readonly buffer Mapped {
    MappedVertex mapped[];
};

layout(set = 0, binding = 20, std430) buffer Normals {
    vec4 normals[]; // unit vector, how charred
};

layout(set = 0, binding = 21, std430) buffer Colors {
    vec4 colors[]; // linear RGB, glow
};

layout(set = 0, binding = 113, std430) readonly buffer Touched {
    uint touched[]; // last tick at which a triangle of the vertex changed
};

#ifdef SURFACE_SEVERAL
layout(set = 0, binding = 81, std430) readonly buffer Substances {
    Appearance substances[];
};

layout(set = 0, binding = 82, std430) readonly buffer SubstanceOf {
    uint substance_of[]; // of draw vertices
};
#endif

const vec3 CHAR = vec3(0.02);

const float PATCHES = 40.0; // a diagonal
const float WANDER = 30.0; // patches of it a minute

// Of char that burns: the less, the less of it is left.
float ember(vec3 place, float left_fraction) {
    float time_s = float(clock.tick) / 60.0;
    float patched = smoothstep(0.45, 0.85, wood_noise(PATCHES * place - vec3(0.0, WANDER / 60.0 * time_s, 0.0)));
    return 0.7 * patched * left_fraction;
}

// The sum of (b - a) x (c - a) over the triangles that are still there, or over all of them.
vec3 area_vectors(uint from, uint to, bool with_removed) {
    vec3 sum = vec3(0.0);
    for (uint i = from; i < to; i++) {
        uint triangle = corner_incidence[i] / 4u;
        if (with_removed || removed[triangle] == 0u) {
            vec3 a = mapped[triangles[3u * triangle]].position;
            vec3 b = mapped[triangles[3u * triangle + 1u]].position;
            vec3 c = mapped[triangles[3u * triangle + 2u]].position;
            sum += cross(b - a, c - a);
        }
    }
    return sum;
}

// Appendix B's normal of a draw vertex, a unit vector.
vec3 normal_of(uint corner) {
    uint from = corner_incidence_offsets[corner];
    uint to = corner_incidence_offsets[corner + 1u];
    vec3 sum = area_vectors(from, to, false);
    if (sum == vec3(0.0)) {
        sum = area_vectors(from, to, true);
    }
    // The largest component first: squares of small areas would underflow.
    float largest = max(abs(sum.x), max(abs(sum.y), abs(sum.z)));
    vec3 normal = vec3(0.0, 1.0, 0.0);
    if (largest > 0.0) {
        normal = normalize(sum / largest);
    }
    return normal;
}

void main() {
    uint corner = element(64u);
    if (corner >= constants.draw_vertex_count) {
        return;
    }
    uint vertex = welds[corner];
    // Nothing that is drawn has a vertex that does not exist.
    if (alive[vertex] == 0u) {
        normals[corner] = vec4(0.0, 1.0, 0.0, 0.0);
        colors[corner] = vec4(0.0);
        return;
    }
    float r = clock.radius;
    float width = constants.area_width;
    float distance_to_boundary = rest[vertex].boundary_distance;
    float charred = clamp((r - distance_to_boundary) / (2.0 * width), 0.0, 1.0);
    float glow = max(0.0, 1.0 - abs(distance_to_boundary - (r - width)) / (0.5 * width));
    // No branch: drivers compile a shader anew for each value that a branch on constants sees.
    float is_char = constants.embers * step(1.0, charred);
    glow = max(glow, is_char * ember(rest[vertex].position, mapped[vertex].left_fraction));
#ifdef SURFACE_SEVERAL
    Appearance own = substances[substance_of[corner]];
    // Areas that the boundary has come to lie beyond.
    float areas = (r - distance_to_boundary) / width;
    float heat = smoothstep(0.0, 3.0, areas) * (1.0 - smoothstep(6.0, 20.0, areas));
    vec4 color;
    if (own.charring > 0.0) {
        color = vec4(mix(own.albedo, CHAR, charred), glow);
    } else {
        // Hot metal shows its own light rather than its colour.
        float hidden = own.embers.x > 0.0 ? 0.9 * heat : 0.0;
        color = vec4(mix(own.albedo, CHAR, hidden), heat);
    }
#else
    vec4 color = vec4(mix(constants.albedo, CHAR, constants.charring * charred), glow);
#endif
    vec4 shown_normal = normals[corner];
    vec4 shown_color = colors[corner];
    // A vertex that did not exist is black.
    bool is_new = touched[vertex] >= shown.since || shown_color.rgb == vec3(0.0);
    if (!is_new && charred == shown_normal.w && color == shown_color) {
        return;
    }
    vec3 normal = shown_normal.xyz;
    if (is_new) {
        normal = normal_of(corner);
    }
    normals[corner] = vec4(normal, charred);
    colors[corner] = color;
}
