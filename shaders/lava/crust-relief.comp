#version 450

// The crust of a fluid's surface, on a grid finer than the particles can show: heights, temperatures and rock of each column.
// Ropes (section 3.2): folds of a stiff skin over a softer inside, as long as Fink and Fletcher (1978) find. A skin that is
// shortened along the flow keeps its length and rises; its folds lie where the lava was level with each other when its rock was laid, so
// that they are carried and bent with it. Pieces (section 3.3): the part of the surface that lies nearest to one of the particles
// beneath, whose borders gape as the flow stretches them and close as new crust grows. Toes (section 3.2): each has a skin of its own, so that
// two of them do not run into one but meet in a seam, which glows until crust has closed it.

#extension GL_EXT_samplerless_texture_functions : require

layout(local_size_x = 8, local_size_y = 8) in;

#include "lava/sph.glsl"
#include "lava/bed.glsl"
#include "lava/crust.glsl"
#include "lava/hash.glsl"
#include "lava/face.glsl"
#include "lava/crowded.glsl"
#include "lava/stretches.glsl"

layout(set = 0, binding = 4, std430) readonly buffer Predicted {
    vec4 list[]; // metres
} predicted;

layout(set = 0, binding = 5, std430) readonly buffer Items {
    uvec2 list[]; // cell and particle, by cells
} items;

layout(set = 0, binding = 6) uniform texture2D motion; // of the surface: metres per second, kelvin, metres
layout(set = 0, binding = 7) uniform texture2D temperatures;
layout(set = 0, binding = 8) uniform texture2D carried;

layout(set = 0, binding = 12, rgba32f) uniform image2D heights;
layout(set = 0, binding = 13, rgba32f) uniform image2D crust_temperatures;
layout(set = 0, binding = 14, rgba32f) uniform image2D crust_carried;

layout(set = 0, binding = 15, std430) readonly buffer Toes {
    uint list[]; // number of each particle's
} toes;

const float STEEPEST = 1.5; // slope of a rope; beyond it a fold would overturn
const float TURN = 6.28318531;
const float WIDEST = 0.8; // share of gaps
const float FAR_M = 1.0e9;

// The coarse columns around a place by cubic B-splines, which have no creases at the columns.
struct Surface {
    float lava_m;
    float kelvin;
    float core_k;
    float opening; // divergence of the surface's motion, per second
    vec4 carried_m; // of both layings, along x and z
    vec2 shortening; // of each laying across its ropes: length as laid over length
    float share; // of the first laying
    bool is_there;
};

float spline(float t) {
    float a = abs(t);
    float b = max(2.0 - a, 0.0);
    return a < 1.0 ? 2.0 / 3.0 - a * a + 0.5 * a * a * a : b * b * b / 6.0;
}

float spline_slope(float t) {
    float a = abs(t);
    float b = max(2.0 - a, 0.0);
    return sign(t) * (a < 1.0 ? a * (1.5 * a - 2.0) : -0.5 * b * b);
}

Surface surface_at(vec2 share) {
    ivec2 last = textureSize(motion, 0) - 1;
    vec2 per_m = vec2(last + 1) / flow.space_m.xz;
    vec2 column = share * vec2(last + 1) - 0.5;
    vec2 base = floor(column);
    vec2 fraction = column - base;
    float lava_m = 0.0;
    float weights = 0.0;
    vec2 slopes = vec2(0.0);
    vec2 warmth = vec2(0.0);
    vec2 speed = vec2(0.0);
    vec2 speeding = vec2(0.0); // along x of the first, along z of the second
    vec4 carried_m = vec4(0.0);
    vec2 along_x = vec2(0.0); // slopes of both layings' way along x
    vec2 along_z = vec2(0.0);
    for (int z = -1; z <= 2; z++) {
        for (int x = -1; x <= 2; x++) {
            ivec2 at = clamp(ivec2(base) + ivec2(x, z), ivec2(0), last);
            vec2 t = fraction - vec2(x, z);
            vec2 value = vec2(spline(t.x), spline(t.y));
            float weight = value.x * value.y;
            vec4 moved = texelFetch(motion, at, 0);
            lava_m += weight * moved.w;
            vec4 heat = texelFetch(temperatures, at, 0);
            weight *= heat.g;
            vec2 slope = heat.g * per_m * vec2(spline_slope(t.x) * value.y, value.x * spline_slope(t.y));
            vec4 way_m = texelFetch(carried, at, 0);
            weights += weight;
            slopes += slope;
            warmth += weight * vec2(heat.a, moved.z);
            speed += weight * moved.xy;
            speeding += slope * moved.xy;
            carried_m += weight * way_m;
            along_x += slope.x * way_m.xz;
            along_z += slope.y * way_m.xz;
        }
    }
    float most = max(weights, 1.0e-6);
    carried_m /= most;
    // Slopes of means: of the sums, less what the sum of the weights has.
    along_x = (along_x - slopes.x * carried_m.xz) / most;
    along_z = (along_z - slopes.y * carried_m.xz) / most;
    speeding = (speeding - slopes * speed / most) / most;
    Surface surface;
    surface.lava_m = lava_m;
    surface.kelvin = warmth.x / most;
    surface.core_k = warmth.y / most;
    surface.opening = speeding.x + speeding.y;
    surface.carried_m = carried_m;
    surface.shortening = vec2(length(vec2(1.0 - along_x.x, along_z.x)), length(vec2(1.0 - along_x.y, along_z.y)));
    surface.share = texelFetch(temperatures, ivec2(0), 0).b;
    surface.is_there = weights > 1.0e-3;
    return surface;
}

// Height of a rope over the mean: round crests, creased hollows. Its slopes are those of a sine, of at most `steepness`; an arc of it is
// longer than its chord by the root of 1 + steepness^2 / 2, within 2 %, which is what the skin has been shortened by. Folds that have come closer
// than half their length are pressed together, at a third into one.
float rope_m(float laid_m, float shortening) {
    float shortened = max(shortening, 1.0);
    float steepness = min(sqrt(2.0 * (shortened * shortened - 1.0)), STEEPEST);
    float turns = laid_m / crust.rope_m;
    float height = clamp(3.0 - shortened, 0.0, 1.0) * steepness * crust.rope_m / (TURN * shortened);
    return height * (2.0 * abs(cos(0.5 * TURN * turns)) - 4.0 / (0.5 * TURN));
}

// The piece at a place of the surface.
struct Piece {
    float to_edge_m;
    vec2 from_middle_m;
    uint particle;
};

bool is_kept(uint particle) {
    return evenly(particle) < crust.kept;
}

// Pieces and seams take two walks each through nine stretches.
const uint MOST_OF_RELIEF = MOST / 4u;
// Lengths of a piece, of the particles whose pieces may reach a place: of a particle that lies farther from it by half
// a length than the nearest one, the border to the nearest one's piece is farther from it than half a length, where
// neither gaps nor edges are.
const float PIECES_REACH = 3.0;

Piece piece_at(vec3 place_m) {
    ivec2 cell = cell_of(vec3(place_m.x, 0.0, place_m.z)).xz;
    // A step moves lava by less than the kernel's radius.
    float reach_m = PIECES_REACH * crust.piece_m + flow.support_m;
    float nearest = FAR_M;
    vec3 middle = vec3(0.0); // from there to the place
    uint particle = 0u;
    for (int z = -1; z <= 1; z++) {
        for (int x = -1; x <= 1; x++) {
            uvec2 stretch = stretch_near(cell, ivec2(x, z), place_m.y, reach_m, MOST_OF_RELIEF);
            for (uint i = stretch.x; i < stretch.y; i++) {
                vec3 way = apart(place_m - predicted.list[i].xyz);
                float squared = dot(way, way);
                uint number = items.list[i].y;
                if (squared < nearest && is_kept(number)) {
                    nearest = squared;
                    middle = way;
                    particle = number;
                }
            }
        }
    }
    float within_m = (PIECES_REACH - 0.5) * crust.piece_m;
    is_crowded = is_crowded || (is_narrowed && nearest > within_m * within_m);
    float to_edge_m = FAR_M;
    for (int z = -1; z <= 1; z++) {
        for (int x = -1; x <= 1; x++) {
            uvec2 stretch = stretch_near(cell, ivec2(x, z), place_m.y, reach_m, MOST_OF_RELIEF);
            for (uint i = stretch.x; i < stretch.y; i++) {
                vec3 way = apart(place_m - predicted.list[i].xyz);
                uint number = items.list[i].y;
                // The plane between two middles cuts the surface in a line.
                float across_m = max(length(way.xz - middle.xz), 0.25 * crust.piece_m);
                float to_line_m = 0.5 * (dot(way, way) - nearest) / across_m;
                if (to_line_m < to_edge_m && number != particle && is_kept(number)) {
                    to_edge_m = to_line_m;
                }
            }
        }
    }
    return Piece(to_edge_m, middle.xz, particle);
}

const uint NO_TOE = 0xffffffffu;

// 1 inside a toe, 0 on the seam between two: of the lava around a place by the kernel, what the toe that has most of it has more than the one
// that has most beside it, over what both have. Of the three toes whose particles lie nearest: one that lies farther away is left out, even if it
// has more than they do.
float seam_at(vec3 place_m) {
    ivec2 cell = cell_of(vec3(place_m.x, 0.0, place_m.z)).xz;
    // The kernel's radius, and the step's motion.
    float reach_m = 2.0 * flow.support_m;
    vec3 nearest = vec3(FAR_M); // squared, of three toes
    uvec3 toe = uvec3(NO_TOE);
    for (int z = -1; z <= 1; z++) {
        for (int x = -1; x <= 1; x++) {
            uvec2 stretch = stretch_near(cell, ivec2(x, z), place_m.y, reach_m, MOST_OF_RELIEF);
            for (uint i = stretch.x; i < stretch.y; i++) {
                vec3 way = apart(place_m - predicted.list[i].xyz);
                float squared = dot(way, way);
                if (squared < nearest.z) {
                    uint own = toes.list[items.list[i].y];
                    // One that comes nearer than others pushes those behind it, up to its own place.
                    bool is_first = own == toe.x || squared < nearest.x;
                    bool is_second = own == toe.y || squared < nearest.y;
                    if (is_first) {
                        bool was_there = own == toe.x || own == toe.y;
                        nearest.z = was_there ? nearest.z : nearest.y;
                        toe.z = was_there ? toe.z : toe.y;
                        nearest.y = own == toe.x ? nearest.y : nearest.x;
                        toe.y = own == toe.x ? toe.y : toe.x;
                        nearest.x = min(nearest.x, squared);
                        toe.x = own;
                    } else if (is_second) {
                        nearest.z = own == toe.y ? nearest.z : nearest.y;
                        toe.z = own == toe.y ? toe.z : toe.y;
                        nearest.y = min(nearest.y, squared);
                        toe.y = own;
                    } else {
                        nearest.z = squared;
                        toe.z = own;
                    }
                }
            }
        }
    }
    vec3 shares = vec3(0.0);
    for (int z = -1; z <= 1; z++) {
        for (int x = -1; x <= 1; x++) {
            uvec2 stretch = stretch_near(cell, ivec2(x, z), place_m.y, reach_m, MOST_OF_RELIEF);
            for (uint i = stretch.x; i < stretch.y; i++) {
                float weight = kernel(length(apart(place_m - predicted.list[i].xyz)) / flow.support_m);
                uint own = toes.list[items.list[i].y];
                shares += weight * vec3(own == toe.x ? 1.0 : 0.0, own == toe.y ? 1.0 : 0.0, own == toe.z ? 1.0 : 0.0);
            }
        }
    }
    float most = max(shares.x, max(shares.y, shares.z));
    float next = max(min(shares.x, shares.y), min(max(shares.x, shares.y), shares.z));
    return most > 0.0 ? (most - next) / (most + next) : 1.0;
}

const float CRACK = 0.2; // of what seam_at gives

// The smaller blocks that a piece is a heap of, their height over the piece's own, both over its length; a place from its middle in lengths.
const float BLOCKS = 3.0; // along a piece
const float CREASE = 0.3; // of a block's length

float rubble(vec2 from_middle, uint particle) {
    vec2 at = BLOCKS * from_middle;
    ivec2 cell = ivec2(floor(at));
    vec2 nearest = vec2(FAR_M); // squared distances of the nearest middle and of the second
    vec2 way = vec2(0.0);
    uint block = 0u;
    for (int z = -1; z <= 1; z++) {
        for (int x = -1; x <= 1; x++) {
            ivec2 around = cell + ivec2(x, z);
            uint number = hashed(particle ^ (uint(around.x + 128) * 256u + uint(around.y + 128)));
            vec2 from_block = at - vec2(around) - vec2(evenly(number), evenly(number ^ 0x9e3779b9u));
            float squared = dot(from_block, from_block);
            bool is_nearest = squared < nearest.x;
            nearest = is_nearest ? vec2(squared, nearest.x) : vec2(nearest.x, min(squared, nearest.y));
            way = is_nearest ? from_block : way;
            block = is_nearest ? number : block;
        }
    }
    vec2 tilt = vec2(evenly(block ^ 0x7f4a7c15u), evenly(block ^ 0x94d049bbu)) - 0.5;
    float raised = evenly(block ^ 0xbf58476du) - 0.5;
    float edge = 1.0 - smoothstep(0.0, CREASE, sqrt(nearest.y) - sqrt(nearest.x));
    return (raised - 0.5 * edge + 1.5 * dot(tilt, way)) / BLOCKS;
}

void main() {
    ivec2 column = ivec2(gl_GlobalInvocationID.xy);
    ivec2 columns = imageSize(heights);
    if (column.x >= columns.x || column.y >= columns.y) {
        return;
    }
    vec2 share = (vec2(column) + 0.5) / vec2(columns);
    vec2 place_m = share * flow.space_m.xz;
    Surface surface = surface_at(share);
    float ground_m = bed_at(share).z;
    float relief_m = 0.0;
    float kelvin = surface.kelvin;
    float glowing_k = face_k(kelvin, crust.radiance);
    if (surface.is_there && surface.lava_m > 0.0) {
        // Crust grows from nothing at the melt's temperature to all of itself at the solidus.
        float grown = clamp((crust.melt_k - kelvin) / (crust.melt_k - crust.solidus_k), 0.0, 1.0);
        float borne = clamp(surface.lava_m / crust.least_m, 0.0, 1.0);
        if (crust.rope_m > 0.0) {
            vec2 laid_m = place_m.xx - surface.carried_m.xz;
            float first = rope_m(laid_m.x, surface.shortening.x);
            float second = rope_m(laid_m.y, surface.shortening.y);
            relief_m += grown * mix(second, first, surface.share);
        }
        if (crust.piece_m > 0.0) {
            Piece piece = piece_at(vec3(place_m.x, ground_m + surface.lava_m, place_m.y));
            // What opens by the flow's stretching and closes by the crust's growth.
            float opened = max(surface.opening, 0.0) * crust.healing_s;
            float gaps = min(opened / (1.0 + opened), WIDEST);
            // A square that keeps the rest of its area.
            float half_m = 0.5 * crust.piece_m * (1.0 - sqrt(1.0 - gaps));
            float blurred_m = max(flow.space_m.x / float(columns.x), flow.space_m.z / float(columns.y));
            float gap = 1.0 - smoothstep(half_m - blurred_m, half_m, piece.to_edge_m);
            // Pieces are as much colder than the particles say as gaps are hotter.
            float piece_k = max((kelvin - gaps * surface.core_k) / (1.0 - gaps), crust.ambient_k);
            glowing_k = mix(face_k(piece_k, crust.radiance), surface.core_k, gap);
            vec2 tilt = vec2(evenly(piece.particle ^ 0x9e3779b9u), evenly(piece.particle ^ 0x7f4a7c15u)) - 0.5;
            float raised = evenly(piece.particle ^ 0x94d049bbu) - 0.5;
            float edge = 1.0 - smoothstep(0.0, 0.2 * crust.piece_m, piece.to_edge_m);
            float jumbled_m = crust.piece_m * (raised - 0.5 * edge) + 1.5 * dot(tilt, piece.from_middle_m);
            jumbled_m += crust.piece_m * rubble(piece.from_middle_m / crust.piece_m, piece.particle);
            relief_m += grown * (crust.jumble * jumbled_m - 0.25 * gap * crust.piece_m);
        }
        relief_m *= borne;
        if (crust.seam_m > 0.0) {
            float seam = seam_at(vec3(place_m.x, ground_m + surface.lava_m, place_m.y));
            float aside = 1.0 - seam;
            // Toes are round: a quarter of an ellipse down to the seam.
            relief_m -= min(crust.seam_m, 0.8 * surface.lava_m) * (1.0 - sqrt(max(1.0 - aside * aside, 0.0)));
            float crack = (1.0 - smoothstep(0.0, CRACK, seam)) * (1.0 - grown);
            glowing_k = mix(glowing_k, max(glowing_k, surface.core_k), crack);
        }
    }
    if (is_crowded) {
        crowded.by_relief = 1u;
    }
    float height_m = ground_m + max(surface.lava_m + relief_m, min(surface.lava_m, 0.5 * crust.least_m));
    imageStore(heights, column, vec4(0.0, 0.0, 0.0, height_m));
    imageStore(crust_temperatures, column, vec4(glowing_k, surface.is_there ? 1.0 : 0.0, surface.share, 0.0));
    imageStore(crust_carried, column, surface.carried_m);
}
