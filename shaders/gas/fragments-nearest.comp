#version 450

// The nearest fragments of each pixel alone (a k-buffer): those that the triangles of its tile leave, each put into its
// place among those that are kept. What is behind the last place is lost.

#include "gas/tile-pixels.glsl"

bool is_before(Link link, Surface surface, uint slot) {
    float depth_m = mean_depth(link);
    float other_m = mean_depth(links[slot]);
    uvec2 number = uvec2(surface.object, surface.triangle);
    uvec2 other = uvec2(surfaces[slot].object, surfaces[slot].triangle);
    return depth_m < other_m || (depth_m == other_m
        && (number.x < other.x || (number.x == other.x && number.y < other.y)));
}

void main() {
    uvec2 pixel = pixel_of(gl_GlobalInvocationID.xy);
    uint lane = gl_LocalInvocationID.y * TILE + gl_LocalInvocationID.x;
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
        node = links[node].next;
        kept++;
    }
    float last_m = kept == counts.nearest ? mean_depth(links[first + kept - 1u]) : 1.0e30;
    uint bits = 0u;
    while (bits != 0u || chunk < chunks.to) {
        uint triangle = NONE;
        while (triangle == NONE && (bits != 0u || chunk < chunks.to)) {
            if (bits == 0u) {
                bits = tile_pixels[chunk * 64u + lane].x;
                chunk++;
            }
            if (bits != 0u) {
                uvec2 next = tile_triangles[(chunk - 1u) * CHUNK + uint(findLSB(bits))];
                bits &= bits - 1u;
                triangle = uintBitsToFloat(next.y) <= last_m ? next.x : NONE;
            }
        }
        if (triangle != NONE) {
            Fragment fragment = fragment_in(triangle, vec2(pixel));
            bool is_full = kept == counts.nearest;
            uint slot = first + min(kept, counts.nearest - 1u); // of the last place
            if (fragment.is_there && (!is_full || is_before(fragment.link, fragment.surface, slot))) {
                kept = min(kept + 1u, counts.nearest);
                while (slot > first && is_before(fragment.link, fragment.surface, slot - 1u)) {
                    links[slot] = links[slot - 1u];
                    surfaces[slot] = surfaces[slot - 1u];
                    colors[slot] = colors[slot - 1u];
                    slot--;
                }
                links[slot] = fragment.link;
                surfaces[slot] = fragment.surface;
                colors[slot] = fragment.color;
                last_m = kept == counts.nearest ? mean_depth(links[first + kept - 1u]) : 1.0e30;
            }
        }
    }
    if (bits != 0u || chunk < chunks.to) {
        is_ended = 1u;
    }
    for (uint i = 0u; i < kept; i++) {
        links[first + i].next = i + 1u < kept ? first + i + 1u : NONE;
    }
    if (kept > 0u) {
        heads[list] = first;
    }
}
