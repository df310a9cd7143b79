#version 450

#pragma variants OPACITY=plain,gas

// What the triangles of each tile leave in its pixels, a thread a pixel that goes through those that touch it. Behind
// the farthest corner of one that is opaque and fills the pixel only the next fragment is kept: a fraction of it may show
// where depths overlap. So the lists are those of `linked` up to there. Each thread adds to its own list, and takes all its slots at
// once. Without barriers: lavapipe keeps what lives beside one in memory all along, which costs more than the atomics.

#include "gas/tile-pixels.glsl"

void main() {
    read_counts();
    uvec2 pixel = pixel_of(gl_GlobalInvocationID.xy);
    uvec2 place = place_of(gl_GlobalInvocationID.xy) % TILE;
    uint lane = place.y * TILE + place.x;
    bool is_mine = is_in_band(pixel);
    uint list = is_mine ? list_of(pixel) : 0u;
    vec2 origin = vec2(pixel);

    Chunks chunks = chunks_of_call(tile_of_group(), is_mine);
    uint from = chunks.from;
    uint to = chunks.to;

    // A depth at which the pixel is covered: of the triangles that fill it the least that one lies before as a whole.
    float cover_m = 1.0e30;
    uint touching = 0u;
    uint chunk = from;
    uint bits = 0u;
    do {
        if (bits == 0u && chunk < to) {
            uvec2 pixels = tile_pixels[chunk * 64u + lane];
            touching += uint(bitCount(pixels.x));
            bits = pixels.y;
            chunk++;
        }
        if (bits != 0u) {
            uint at = (chunk - 1u) * CHUNK + uint(findLSB(bits));
            bits &= bits - 1u;
            float farthest_m = uintBitsToFloat(tile_triangles[at].z);
            cover_m = farthest_m <= frame.yon_m ? min(cover_m, farthest_m) : cover_m;
        }
    } while (bits != 0u || chunk < to);
    bool is_ended_here = bits != 0u || chunk < to;
    // What is farther is behind a cover, however its depth was rounded.
    float bound_m = cover_m * (1.0 + 1.0e-6);

    // The slots that are wanted: of all that may be nearer, and one more.
    uint nearer = 0u;
    chunk = cover_m < 1.0e30 ? from : to;
    bits = 0u;
    do {
        if (bits == 0u && chunk < to) {
            bits = tile_pixels[chunk * 64u + lane].x;
            chunk++;
        }
        if (bits != 0u) {
            uint at = (chunk - 1u) * CHUNK + uint(findLSB(bits));
            bits &= bits - 1u;
            nearer += uint(uintBitsToFloat(tile_triangles[at].y) <= bound_m);
        }
    } while (bits != 0u || chunk < to);
    is_ended_here = is_ended_here || bits != 0u || chunk < to;
    uint wanted = cover_m < 1.0e30 ? min(nearer + 1u, touching) : touching;
    uint first = 0u;
    if (wanted > 0u) {
        first = atomicAdd(fragment_count, wanted);
        if (first >= MOST_SLOTS) {
            atomicAdd(fragment_count, 0u - wanted);
        }
    }
    // What has no room is counted: the host grows the buffers and repeats the run.
    bool has_room = wanted > 0u && first < MOST_SLOTS && first + wanted <= frame.fragment_capacity;

    uint head = is_mine ? heads[list] : NONE;
    uint used = 0u;
    uint behind = NONE; // the nearest fragment behind the cover
    float behind_m = 1.0e30;
    uint behind_triangle = 0u;
    chunk = has_room ? from : to;
    bits = 0u;
    do {
        uint triangle = NONE;
        do {
            if (bits == 0u && chunk < to) {
                bits = tile_pixels[chunk * 64u + lane].x;
                chunk++;
            }
            if (bits != 0u) {
                uvec2 next = tile_triangles[(chunk - 1u) * CHUNK + uint(findLSB(bits))].xy;
                bits &= bits - 1u;
                float nearest_m = uintBitsToFloat(next.y);
                triangle = nearest_m <= bound_m || nearest_m <= behind_m ? next.x : NONE;
            }
        } while (triangle == NONE && (bits != 0u || chunk < to));
        Fragment fragment = fragment_in(triangle != NONE ? triangle : 0u, origin);
        float depth_m = mean_depth(fragment.link);
        bool is_behind = depth_m > bound_m;
        // Triangles are numbered object by object.
        bool is_nearest = depth_m < behind_m
            || (depth_m == behind_m && fragment.surface.triangle < behind_triangle);
        if (triangle != NONE && fragment.is_there && (!is_behind || is_nearest)) {
            uint slot = is_behind ? first + wanted - 1u : first + used;
            fragment.link.next = head;
            links[slot] = link_words(fragment.link);
            surfaces[slot] = surface_words(fragment.surface);
            colors[slot] = color_words(fragment.color);
            if (is_behind) {
                behind = slot;
                behind_m = depth_m;
                behind_triangle = fragment.surface.triangle;
            } else {
                head = slot;
                used++;
            }
        }
    } while (bits != 0u || chunk < to);
    is_ended_here = is_ended_here || bits != 0u || chunk < to;
    if (behind != NONE) {
        links[behind].x = head;
        head = behind;
    }
    if (is_mine) {
        heads[list] = head;
    }
    if (is_ended_here || is_cut) {
        is_ended = 1u;
    }
}
