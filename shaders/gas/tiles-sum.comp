#version 450

// The chunks before each tile's: the sum of those of the tiles before it. One workgroup.

layout(local_size_x = 256) in;

#include "gas/frame.glsl"
#include "gas/band.glsl"
#include "gas/counters.glsl"

const uint GROUP = 256u;
const uint CHUNK = 32u;

layout(set = 0, binding = 22, std430) buffer Tiles {
    uint tiles[]; // of each its triangles, and its first chunk
};

shared uint sums[GROUP];
shared uint most[GROUP];

void main() {
    uint lane = gl_LocalInvocationID.x;
    uint count = ((frame.size.x + 7u) / 8u) * ((band.end_row - band.list_row + 7u) / 8u);
    uint each = (count + GROUP - 1u) / GROUP;
    uint from = min(lane * each, count);
    uint to = min(from + each, count);
    uint own = 0u;
    uint largest = 0u;
    uint tile = from;
    for (; tile < to; tile++) {
        uint size = tiles[2u * tile];
        own += (size + CHUNK - 1u) / CHUNK;
        largest = max(largest, size);
    }
    bool is_ended_here = tile < to;
    sums[lane] = own;
    most[lane] = largest;
    barrier();
    for (uint reach = 1u; reach < GROUP; reach *= 2u) {
        uint add = 0u;
        uint other = 0u;
        if (lane >= reach) {
            add = sums[lane - reach];
            other = most[lane - reach];
        }
        barrier();
        sums[lane] += add;
        most[lane] = max(most[lane], other);
        barrier();
    }
    uint first = sums[lane] - own;
    for (tile = from; tile < to; tile++) {
        uint size = tiles[2u * tile];
        tiles[2u * tile] = 0u; // filled in again by tiles-fill
        tiles[2u * tile + 1u] = first;
        first += (size + CHUNK - 1u) / CHUNK;
    }
    if (is_ended_here || tile < to) {
        is_ended = 1u;
    }
    if (lane == GROUP - 1u) {
        tiles[2u * count + 1u] = sums[lane];
        chunk_count = sums[lane];
        most_chunks = max(most_chunks, sums[lane]);
        most_of_tile = max(most_of_tile, most[lane]);
    }
}
