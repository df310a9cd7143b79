#version 450

#pragma variants OPACITY=plain,gas

// What the triangles of each tile leave in its pixels. A thread a pixel looks for the depth at which a triangle that is opaque and
// fills the pixel covers it, and puts those that may be nearer, with the pixel, into a queue of the tile's, which all its threads
// work off: none waits for the pixel that has the most of them. Where a fragment reaches through the cover, and may show in its
// place (see fraction_behind), one more is looked for that stands between the two, and kept where there is one. So the lists
// are those of `linked` up to the cover, and show the same. Slots are taken for all of a tile at once.

#include "gas/tile-pixels.glsl"

shared uint wanted_of[64];
shared uint wanted_of_row[8];
shared uint first_of_tile;

const uint PAIRS_A_ROUND = 8u; // of a pixel
shared uint pairs[64u * PAIRS_A_ROUND]; // the place of a triangle in the dispatch's chunks, times 64, and a pixel
shared uint pair_count;
shared uint has_more; // 1 where a pixel has pairs for another round
shared uint has_through; // 1 where a pixel has a fragment that reaches through its cover
// Of each pixel.
shared uint first_of[64]; // slot
shared uint used_of[64]; // slots
shared uint head_of[64]; // what dispatches before this one have left
shared float bound_of[64]; // depth of what is behind the cover for certain
shared uint through_of[64]; // bits of the least mean depth of what reaches through the cover

const uint NO_DEPTH = 0x7f000000u; // farther than anything
const uint NEARER = 0u; // what the queue is filled with: triangles that may be nearer than the cover
const uint BETWEEN = 1u; // those behind it, before what reaches through it

void main() {
    read_counts();
    uvec2 pixel = pixel_of(gl_GlobalInvocationID.xy);
    uint lane = gl_LocalInvocationID.y * TILE + gl_LocalInvocationID.x;
    bool is_mine = is_in_band(pixel);
    uint list = is_mine ? list_of(pixel) : 0u;
    vec2 corner = vec2(pixel - gl_LocalInvocationID.xy);

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
    wanted_of[lane] = wanted;
    barrier();
    if (lane < TILE) {
        uint sum = 0u;
        for (uint i = 0u; i < TILE; i++) {
            sum += wanted_of[lane * TILE + i];
        }
        wanted_of_row[lane] = sum;
    }
    barrier();
    uint before = 0u;
    uint of_tile = 0u;
    for (uint i = 0u; i < TILE; i++) {
        uint of_row = wanted_of_row[i];
        of_tile += of_row;
        before += i < gl_LocalInvocationID.y ? of_row : 0u;
        before += i < gl_LocalInvocationID.x ? wanted_of[gl_LocalInvocationID.y * TILE + i] : 0u;
    }
    uint head = is_mine ? heads[list] : NONE;
    used_of[lane] = 0u;
    head_of[lane] = head;
    bound_of[lane] = bound_m;
    through_of[lane] = NO_DEPTH;
    if (lane == 0u) {
        first_of_tile = of_tile > 0u ? atomicAdd(fragment_count, of_tile) : 0u;
        if (first_of_tile >= MOST_SLOTS) {
            atomicAdd(fragment_count, 0u - of_tile);
        }
        pair_count = 0u;
        has_more = 0u;
        has_through = 0u;
    }
    barrier();
    uint first = first_of_tile + before;
    first_of[lane] = first;
    // What has no room is counted: the host grows the buffers and repeats the run.
    bool has_room = first_of_tile + of_tile <= frame.fragment_capacity;

    uint first_chunk = tiles[2u * tile_of_group() + 1u] + band.call * CHUNKS_A_CALL;
    chunk = has_room ? from : to;
    bits = 0u;
    float from_m = -1.0; // nearest corners of the triangles that are looked for are behind it
    float to_m = bound_m; // and not behind this
    uint phase = NEARER;
    bool is_over = false;
    do {
        uint queued = 0u;
        do {
            if (bits == 0u && chunk < to) {
                bits = tile_pixels[chunk * 64u + lane].x;
                chunk++;
            }
            if (bits != 0u) {
                uint at = (chunk - 1u) * CHUNK + uint(findLSB(bits));
                bits &= bits - 1u;
                float nearest_m = uintBitsToFloat(tile_triangles[at].y);
                if (nearest_m > from_m && nearest_m <= to_m) {
                    uint place = atomicAdd(pair_count, 1u);
                    pairs[place] = (at - first_chunk * CHUNK) * 64u + lane;
                    queued++;
                }
            }
        } while (queued < PAIRS_A_ROUND && (bits != 0u || chunk < to));
        if (bits != 0u || chunk < to) {
            has_more = 1u;
        }
        barrier();
        uint count = pair_count;
        uint i = lane;
        do {
            uint pair = pairs[min(i, 64u * PAIRS_A_ROUND - 1u)];
            uint of = pair & 63u;
            uint at = first_chunk * CHUNK + (pair >> 6u);
            uint triangle = i < count ? tile_triangles[at].x : 0u;
            Fragment fragment = fragment_in(triangle, corner + vec2(of & (TILE - 1u), of / TILE));
            float depth_m = mean_depth(fragment.link);
            bool is_kept = i < count && fragment.is_there;
            if (is_kept && phase == BETWEEN) {
                is_kept = depth_m <= uintBitsToFloat(through_of[of]) && atomicExchange(through_of[of], 0u) != 0u;
            }
            if (is_kept) {
                uint rank = atomicAdd(used_of[of], 1u);
                uint slot = first_of[of] + rank;
                fragment.link.next = rank > 0u ? slot - 1u : head_of[of];
                links[slot] = link_words(fragment.link);
                surfaces[slot] = surface_words(fragment.surface);
                colors[slot] = color_words(fragment.color);
                float bound = bound_of[of];
                if (phase == NEARER && depth_m > bound && fragment.link.near_m <= bound) {
                    atomicMin(through_of[of], floatBitsToUint(depth_m));
                    has_through = 1u;
                }
            }
            i += 64u;
        } while (i < count);
        is_ended_here = is_ended_here || i < count;
        barrier();
        is_over = has_more == 0u || count == 0u;
        if (is_over && phase == NEARER && has_through != 0u) {
            is_over = false;
            phase = BETWEEN;
            from_m = bound_m;
            to_m = uintBitsToFloat(through_of[lane]);
            is_ended_here = is_ended_here || bits != 0u || chunk < to;
            chunk = to_m < 1.0e30 ? from : to;
            bits = 0u;
        }
        barrier();
        if (lane == 0u) {
            pair_count = 0u;
            has_more = 0u;
        }
        barrier();
    } while (!is_over);
    is_ended_here = is_ended_here || bits != 0u || chunk < to;
    uint used = used_of[lane];
    if (is_mine) {
        heads[list] = used > 0u ? first + used - 1u : head;
    }
    if (is_ended_here || is_cut) {
        is_ended = 1u;
    }
}
