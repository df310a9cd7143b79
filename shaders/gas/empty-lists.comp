#version 450

// Every pixel's list is empty, and so are the counts; the most that any band of any frame has counted is kept for the
// host.

layout(local_size_x = 8, local_size_y = 8) in;

#include "gas/frame.glsl"
#include "gas/band.glsl"
#include "gas/counters.glsl"
#include "gas/gas-pixels.glsl"

layout(set = 0, binding = 7, std430) buffer Heads {
    uint heads[];
};

void main() {
    uvec2 pixel = pixel_of(gl_GlobalInvocationID.xy);
    if (is_in_band(pixel)) {
        heads[list_of(pixel)] = NONE;
    }
    if (gl_GlobalInvocationID.x == 0u && gl_GlobalInvocationID.y == 0u) {
        // 0 in the first band of a frame, where the counts are those of the frame before.
        uint is_later = min(band.list_row - band.picture_row, 1u);
        uint low = (earlier_fragments + fragment_count) * is_later;
        earlier_fragments_high = (earlier_fragments_high + (low < earlier_fragments ? 1u : 0u)) * is_later;
        earlier_fragments = low;
        most_fragments = max(most_fragments, fragment_count);
        most_sections = max(most_sections, section_count);
        fragment_count = 0u;
        section_count = 0u;
        most_lost_pixels = max(most_lost_pixels, lost_pixels);
        lost_pixels *= is_later;
        gas_groups[0] = 0u;
        gas_groups[1] = 1u;
        gas_groups[2] = 1u;
        gas_pixel_count = 0u;
    }
}
