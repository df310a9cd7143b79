#version 450

#pragma variants OPACITY=plain,gas

// The nearest fragments of each pixel alone (a k-buffer): those that the triangles of its tile leave, each put into its
// place among those that are kept. What is behind the last place is lost. Pixels are counted where that may show: where
// the opaque fragments before the last place, behind each of which the next one is kept, do not cover all sub-pixels.

#include "gas/tile-pixels.glsl"

layout(set = 0, binding = 26, std430) buffer Losses {
    uint losses[]; // of each pixel LOST and SHOWS, or 0
};

const uint LOST = 1u; // a fragment found no place
const uint SHOWS = 2u; // the pixel is counted

bool is_before(Link link, Surface surface, uint slot) {
    float depth_m = mean_depth(link);
    float other_m = mean_depth(link_of(links[slot]));
    // Triangles are numbered object by object.
    return depth_m < other_m || (depth_m == other_m && surface.triangle < surfaces[slot].z);
}

void main() {
    read_counts();
    uvec2 pixel = pixel_of(gl_GlobalInvocationID.xy);
    uvec2 place = place_of(gl_GlobalInvocationID.xy) % TILE;
    uint lane = place.y * TILE + place.x;
    bool is_mine = is_in_band(pixel);
    uint list = is_mine ? list_of(pixel) : 0u;
    Chunks chunks = chunks_of_call(tile_of_group(), is_mine);
    uint first = list * counts.nearest;
    uint wanted = (band.end_row - band.list_row) * frame.size.x * counts.nearest;
    if (gl_GlobalInvocationID.x == 0u && gl_GlobalInvocationID.y == 0u) {
        fragment_count = wanted;
    }
    bool has_room = first + counts.nearest <= frame.fragment_capacity;
    uint chunk = has_room ? chunks.from : chunks.to;
    // Those of the dispatches before.
    uint kept = 0u;
    uint node = is_mine ? heads[list] : NONE;
    while (node != NONE) {
        node = links[node].x;
        kept++;
    }
    float last_m = kept == counts.nearest ? mean_depth(link_of(links[first + kept - 1u])) : 1.0e30;
    // Nothing is lost before the first dispatch of a band.
    uint before = is_mine ? losses[list] * min(band.first_triangle + band.call, 1u) : 0u;
    bool has_lost = (before & LOST) != 0u;
    uint bits = 0u;
    do {
        uint triangle = NONE;
        do {
            if (bits == 0u && chunk < chunks.to) {
                bits = tile_pixels[chunk * 64u + lane].x;
                chunk++;
            }
            if (bits != 0u) {
                uvec2 next = tile_triangles[(chunk - 1u) * CHUNK + uint(findLSB(bits))].xy;
                bits &= bits - 1u;
                // However its depth was rounded; and anything until the first loss is known.
                bool may_count = !has_lost || uintBitsToFloat(next.y) <= last_m * (1.0 + 1.0e-6);
                triangle = may_count ? next.x : NONE;
            }
        } while (triangle == NONE && (bits != 0u || chunk < chunks.to));
        if (triangle != NONE) {
            Fragment fragment = fragment_in(triangle, vec2(pixel));
            bool is_full = kept == counts.nearest;
            uint slot = first + min(kept, counts.nearest - 1u); // of the last place
            has_lost = has_lost || (is_full && fragment.is_there);
            if (fragment.is_there && (!is_full || is_before(fragment.link, fragment.surface, slot))) {
                kept = min(kept + 1u, counts.nearest);
                while (slot > first && is_before(fragment.link, fragment.surface, slot - 1u)) {
                    links[slot] = links[slot - 1u];
                    surfaces[slot] = surfaces[slot - 1u];
                    colors[slot] = colors[slot - 1u];
                    slot--;
                }
                links[slot] = link_words(fragment.link);
                surfaces[slot] = surface_words(fragment.surface);
                colors[slot] = color_words(fragment.color);
                last_m = kept == counts.nearest ? mean_depth(link_of(links[first + kept - 1u])) : 1.0e30;
            }
        }
    } while (bits != 0u || chunk < chunks.to);
    if (bits != 0u || chunk < chunks.to || is_cut) {
        is_ended = 1u;
    }
    uint linked = 0u;
    for (; linked < kept; linked++) {
        links[first + linked].x = linked + 1u < kept ? first + linked + 1u : NONE;
    }
    if (linked < kept) {
        is_ended = 1u;
    }
    if (kept > 0u) {
        heads[list] = first;
    }
    uint covered = 0u;
    uint looked_at = 1u;
    for (; looked_at < kept; looked_at++) {
        uint slot = first + looked_at - 1u;
        covered |= opacity_of(Color(0u, colors[slot].y)) >= 1.0 ? links[slot].y : 0u;
    }
    if (looked_at < kept) {
        is_ended = 1u;
    }
    bool shows = has_lost && covered != FULL;
    if (shows != ((before & SHOWS) != 0u)) {
        atomicAdd(lost_pixels, shows ? 1u : 0xffffffffu);
    }
    if (is_mine) {
        losses[list] = (has_lost ? LOST : 0u) | (shows ? SHOWS : 0u);
    }
}
