#version 450

#pragma variants START=clear,keep

// The layer of fire and smoke, tile by tile (ours): smoke covers what was drawn before it, fire adds light; both are hidden by
// the mesh, and fade where they come near it. A thread draws a column of a tile, so that it asks for each particle
// once: drivers that run eight threads at once (lavapipe) read them one by one, which takes as long as the flame of
// eight pixels. Threads along y are further tiles. Colours are premultiplied.

#extension GL_EXT_samplerless_texture_functions : require

layout(local_size_x = 8, local_size_y = 4) in;

#include "burning/flames.glsl"
#include "burning/flame-color.glsl"
#include "burning/smoke-body.glsl"
#include "burning/fire-layer.glsl"
#include "burning/fire-tiles.glsl"

layout(set = 0, binding = 45) uniform texture2D mesh_depth;
layout(set = 0, binding = 118, r32ui) uniform readonly uimage2D masks; // of the lines
layout(set = 0, binding = 119, rgba32f) uniform readonly image2D records; // of the particles
#ifdef START_CLEAR
layout(set = 0, binding = 120, rgba16f) uniform writeonly image2D fire_layer;
#else
layout(set = 0, binding = 120, rgba16f) uniform image2D fire_layer;
#endif

// Of each pixel, for the picture: two halves of 16 bits each, and the distance of the mesh.
layout(set = 0, binding = 121, rgba32ui) uniform writeonly uimage2D fire_texels;

layout(set = 0, binding = 114, std430) buffer Tiles {
    uint tiles[]; // row by row, the picture that fire or smoke reached each in last
};

const uint GROUP = 4u; // tiles below each other

float mesh_distance(ivec2 pixel) {
    return eye_distance(texelFetch(mesh_depth, layer_pixel(pixel), 0).x);
}

vec4 start(ivec2 pixel) {
#ifdef START_CLEAR
    return vec4(0.0);
#else
    return imageLoad(fire_layer, min(pixel, ivec2(billboards.layer_size) - 1));
#endif
}

uint reaching(uint word, ivec2 lines) {
    return imageLoad(masks, ivec2(word, lines.x)).x & imageLoad(masks, ivec2(word, lines.y)).x;
}

// Of a particle.
struct Square {
    vec2 center; // pixels
    vec2 inverse; // 1 over half of its sides
    float eye_depth; // distance along the view, diagonals
    float age; // of its life
    float own; // a random number
};

const uint NONE = 0xffffffffu;
const float FARTHEST = 1.0e30; // beyond all that is drawn

// Of no particle, whatever lies in the records: a square behind everything.
Square square_of(uint slot) {
    bool is_there = slot != NONE;
    ivec2 record = record_at(is_there ? slot : 0u);
    vec4 place = imageLoad(records, record);
    vec4 own = imageLoad(records, record + ivec2(0, 1));
    place = is_there ? place : vec4(0.0);
    own = is_there ? own : vec4(FARTHEST, vec3(0.0));
    return Square(place.xy, place.zw, own.x, own.y, own.z);
}

// Of smoke, and its opacity.
vec4 color_of(uint slot) {
    bool is_there = slot != NONE;
    vec4 color = imageLoad(records, record_at(is_there ? slot : 0u) + ivec2(0, 2));
    return is_there ? color : vec4(0.0);
}

// Of a square the share that shows at a place of it, before a mesh at this distance.
float shown(Square square, vec2 at, float widest, float mesh) {
    bool is_inside = abs(at.x) <= widest && abs(at.y) <= 1.0;
    return is_inside ? clamp((mesh - square.eye_depth) / billboards.particle_radius, 0.0, 1.0) : 0.0;
}

vec4 covered(vec4 behind, Square square, vec4 color, vec2 pixel, float mesh) {
    vec2 at = (pixel - square.center) * square.inverse;
    float alpha = color.a * smoke_body(at, square.age, square.own) * shown(square, at, 1.0, mesh);
    return behind * (1.0 - alpha) + vec4(color.rgb, 1.0) * alpha;
}

vec4 shining(Square square, vec2 pixel, float mesh) {
    vec2 at = (pixel - square.center) * square.inverse;
    return vec4(shown(square, at, WIDEST, mesh) * fire(at, square.age, square.own), 0.0);
}

// The particles that reach a tile, one after the other.
struct Walk {
    uint slot; // NONE behind the last
    uint bits; // left of its word
    uint word;
    uint words; // left of its summary
    uint summary;
};

Walk next(Walk walk, ivec2 lines, bool of_smoke) {
    while (walk.bits == 0u && (walk.words != 0u || walk.summary < SUMMARIES)) {
        if (walk.words == 0u) {
            bool is_smoke = chunk.first + 1024u * walk.summary < chunk.fire_from;
            walk.words = is_smoke == of_smoke ? reaching(WORDS + walk.summary, lines) : 0u;
            walk.summary++;
        } else {
            walk.word = 32u * (walk.summary - 1u) + uint(findLSB(walk.words));
            walk.words &= walk.words - 1u;
            walk.bits = reaching(walk.word, lines);
        }
    }
    walk.slot = walk.bits == 0u ? NONE : 32u * walk.word + uint(findLSB(walk.bits));
    walk.bits &= walk.bits - 1u;
    return walk;
}

Walk walk_of(uint summary, ivec2 lines, bool of_smoke) {
    return next(Walk(NONE, 0u, 0u, 0u, summary), lines, of_smoke);
}

void draw(ivec2 pixel, vec4 sum, float mesh) {
    // Of 16-bit floats: sums of very many flames have none.
    vec4 color = min(sum, vec4(65504.0));
    if (all(lessThan(pixel, ivec2(billboards.layer_size)))) {
        imageStore(fire_layer, pixel, color);
        uvec2 halves = uvec2(packHalf2x16(color.xy), packHalf2x16(color.zw));
        imageStore(fire_texels, pixel, uvec4(halves, floatBitsToUint(mesh), 0u));
    }
}

void main() {
    uvec2 tile = uvec2(gl_WorkGroupID.x, GROUP * gl_WorkGroupID.y + gl_LocalInvocationID.y);
    ivec2 first = ivec2(TILE * tile) + ivec2(gl_LocalInvocationID.x, 0);
    uvec2 last_tile = tiles_of_layer() - 1u;
    ivec2 lines = ivec2(tile.x, last_tile.x + 1u + min(tile.y, last_tile.y));
    const ivec2 below = ivec2(0, 1);
    float mesh0 = mesh_distance(first);
    float mesh1 = mesh_distance(first + below);
    float mesh2 = mesh_distance(first + 2 * below);
    float mesh3 = mesh_distance(first + 3 * below);
    float mesh4 = mesh_distance(first + 4 * below);
    float mesh5 = mesh_distance(first + 5 * below);
    float mesh6 = mesh_distance(first + 6 * below);
    float mesh7 = mesh_distance(first + 7 * below);
    vec4 sum0 = start(first);
    vec4 sum1 = start(first + below);
    vec4 sum2 = start(first + 2 * below);
    vec4 sum3 = start(first + 3 * below);
    vec4 sum4 = start(first + 4 * below);
    vec4 sum5 = start(first + 5 * below);
    vec4 sum6 = start(first + 6 * below);
    vec4 sum7 = start(first + 7 * below);
    vec2 pixel = vec2(first);
    const vec2 down = vec2(0.0, 1.0);
    // Loops ask at their end, and one loop alone holds what is dear: drivers that run eight threads at once go through a
    // loop's body once more than it is asked for.
    Walk walk = walk_of(0u, lines, true);
    do {
        Square square = square_of(walk.slot);
        vec4 color = color_of(walk.slot);
        sum0 = covered(sum0, square, color, pixel, mesh0);
        sum1 = covered(sum1, square, color, pixel + down, mesh1);
        sum2 = covered(sum2, square, color, pixel + 2.0 * down, mesh2);
        sum3 = covered(sum3, square, color, pixel + 3.0 * down, mesh3);
        sum4 = covered(sum4, square, color, pixel + 4.0 * down, mesh4);
        sum5 = covered(sum5, square, color, pixel + 5.0 * down, mesh5);
        sum6 = covered(sum6, square, color, pixel + 6.0 * down, mesh6);
        sum7 = covered(sum7, square, color, pixel + 7.0 * down, mesh7);
        walk = next(walk, lines, true);
    } while (walk.slot != NONE);
    walk = walk_of(0u, lines, false);
    do {
        Square square = square_of(walk.slot);
        sum0 += shining(square, pixel, mesh0);
        sum1 += shining(square, pixel + down, mesh1);
        sum2 += shining(square, pixel + 2.0 * down, mesh2);
        sum3 += shining(square, pixel + 3.0 * down, mesh3);
        sum4 += shining(square, pixel + 4.0 * down, mesh4);
        sum5 += shining(square, pixel + 5.0 * down, mesh5);
        sum6 += shining(square, pixel + 6.0 * down, mesh6);
        sum7 += shining(square, pixel + 7.0 * down, mesh7);
        walk = next(walk, lines, false);
    } while (walk.slot != NONE);
    if (any(greaterThan(tile, last_tile))) {
        return;
    }
    draw(first, sum0, mesh0);
    draw(first + below, sum1, mesh1);
    draw(first + 2 * below, sum2, mesh2);
    draw(first + 3 * below, sum3, mesh3);
    draw(first + 4 * below, sum4, mesh4);
    draw(first + 5 * below, sum5, mesh5);
    draw(first + 6 * below, sum6, mesh6);
    draw(first + 7 * below, sum7, mesh7);
    vec4 brightest = max(max(max(sum0, sum1), max(sum2, sum3)), max(max(sum4, sum5), max(sum6, sum7)));
    if (brightest == vec4(0.0)) {
        return;
    }
    // Pixels of the picture take of the layer's pixels around them.
    float scale = float(billboards.layer_scale);
    vec2 tile_pixels = (vec2(billboards.last_pixel) + 1.0) / float(TILES);
    vec2 low = scale * (vec2(first) - 2.0) / tile_pixels;
    vec2 high = scale * (vec2(first) + vec2(2.0, float(TILE) + 1.0)) / tile_pixels;
    uvec2 from = uvec2(clamp(low, 0.0, float(TILES - 1u)));
    uvec2 to = uvec2(clamp(high, 0.0, float(TILES - 1u)));
    for (uint y = from.y; y <= to.y; y++) {
        for (uint x = from.x; x <= to.x; x++) {
            // Whoever marks a tile writes the same.
            tiles[y * TILES + x] = chunk.picture;
        }
    }
}
