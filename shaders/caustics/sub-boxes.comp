#version 450

// The sub-boxes of smart slicing, runs of levels that hold the receiver (section 4.7.2), in order and where the profile is
// (section 6.1). One workgroup: an invocation has some levels, and the runs that end in them.

layout(local_size_x = 256) in;

#include "caustics/sub-box.glsl"

layout(std430, set = 0, binding = 2) buffer SubBoxes {
    SubBox list[];
} sub_boxes;

layout(std430, set = 0, binding = 3) buffer Placed {
    uint planes;
    uint boxes;
} placed;

shared uint firsts[256];
shared uvec2 sums[256];

// Passes the levels from one to another, the first of whose run is known, and counts sub-boxes and planes on from those before them.
uvec2 passed(uint from, uint to, uint run, uvec2 before, bool stores) {
    uint first = run;
    uvec2 count = before;
    for (uint level = from; level < to; level++) {
        bool is_held = held.list[level] != 0u;
        bool is_next = held.list[min(level + 1u, smart.levels - 1u)] != 0u;
        if (is_held && (level + 1u == smart.levels || !is_next)) {
            uint planes = fits.list[level - first].planes;
            if (stores) {
                sub_boxes.list[count.x] = SubBox(first, level + 1u, count.y, planes);
            }
            count += uvec2(1u, planes);
        }
        first = is_held ? first : level + 1u;
    }
    return count;
}

void main() {
    uint lane = gl_LocalInvocationID.x;
    uint each = (smart.levels + 255u) / 256u;
    uint from = min(lane * each, smart.levels);
    uint to = min(from + each, smart.levels);
    // The level after the last empty one: of the invocation's own, then of all before them.
    uint first = 0u;
    for (uint level = from; level < to; level++) {
        first = held.list[level] == 0u ? level + 1u : first;
    }
    firsts[lane] = first;
    barrier();
    for (uint reach = 1u; reach < 256u; reach *= 2u) {
        uint other = 0u;
        if (lane >= reach) {
            other = firsts[lane - reach];
        }
        barrier();
        firsts[lane] = max(firsts[lane], other);
        barrier();
    }
    uint run = 0u;
    if (lane > 0u) {
        run = firsts[lane - 1u];
    }

    uvec2 own = passed(from, to, run, uvec2(0u), false);
    sums[lane] = own;
    barrier();
    for (uint reach = 1u; reach < 256u; reach *= 2u) {
        uvec2 add = uvec2(0u);
        if (lane >= reach) {
            add = sums[lane - reach];
        }
        barrier();
        sums[lane] += add;
        barrier();
    }
    passed(from, to, run, sums[lane] - own, true);
    if (lane == 255u) {
        placed.boxes = sums[255].x;
        placed.planes = sums[255].y;
    }
}
