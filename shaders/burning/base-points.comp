#version 450

// The movement of the base points (6.3.4), which guide what melts; one thread a block. An edge block without a bottom
// neighbour lets its base point fall, the slower the farther the fire has gone on; others draw it to the lowest base
// point around them, until it meets a block that does not melt yet. A base point starts at a vertex and then moves on
// its own: folding does not move it.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/constants.glsl"
#include "burning/clock.glsl"
#include "burning/grid.glsl"
#include "burning/blocks.glsl"
#include "burning/vertices.glsl"

layout(set = 0, binding = 1, std430) readonly buffer Rest {
    RestVertex rest[];
};

layout(set = 0, binding = 7, std430) readonly buffer BasePoints {
    uint base_points[];
};

layout(set = 0, binding = 11, std430) readonly buffer Labels {
    uint labels[];
};

layout(set = 0, binding = 15, std430) readonly buffer Blocks {
    Block blocks[];
};

layout(set = 0, binding = 18, std430) readonly buffer Clock {
    Counts clock;
};

layout(set = 0, binding = 50, std430) readonly buffer OldBases {
    BaseDisplacement old_bases[];
};

layout(set = 0, binding = 51, std430) buffer NewBases {
    BaseDisplacement new_bases[];
};

// So much lower must the lowest base point be to draw another, in diagonals: on the floor all are equal but for
// rounding, which is not to choose where the flow goes nor to keep it from coming to rest.
const float LEVEL = 1e-4;

bool has_base(uint block) {
    return block != NONE && base_points[min(block, constants.block_count - 1u)] != NONE;
}

bool is_active(uint block) {
    return labels[base_points[block]] >= READY;
}

vec3 base_of(uint block) {
    return rest[base_points[block]].position + old_bases[block].offset;
}

bool is_free_edge(uint block) {
    bool has_sides = true;
    for (uint direction = 0u; direction < 4u; direction++) {
        has_sides = has_base(neighbour_of(block, direction)) ? has_sides : false;
    }
    return !has_sides && !has_base(neighbour_of(block, 4u));
}

// The block around this one whose base point is the lowest, the first of several; NONE without any.
uint lowest_around(uint block) {
    ivec3 middle = ivec3(coordinates_of(block));
    ivec3 size = ivec3(constants.blocks);
    uint lowest = NONE;
    float height = 0.0;
    for (int i = 0; i < 27; i++) {
        ivec3 at = middle + ivec3(i % 3, (i / 3) % 3, i / 9) - 1;
        bool is_inside = all(greaterThanEqual(at, ivec3(0))) && all(lessThan(at, size));
        uint other = is_inside ? uint((at.z * size.y + at.y) * size.x + at.x) : NONE;
        if (other != block && has_base(other)) {
            float y = base_of(other).y;
            if (lowest == NONE || y < height) {
                lowest = other;
                height = y;
            }
        }
    }
    return lowest;
}

vec3 moved(uint block, vec3 p) {
    float omega = constants.omega;
    if (is_free_edge(block)) {
        float behind = max(0.0, clock.radius - constants.area_width - rest[base_points[block]].boundary_distance);
        float slower = max(behind / constants.block_size.y, 1.0);
        return vec3(p.x, max(constants.floor_y, p.y - omega * constants.gravity_per_tick / slower), p.z);
    }
    uint lowest = lowest_around(block);
    if (lowest == NONE) {
        return p;
    }
    vec3 q = base_of(lowest);
    if (q.y >= p.y - LEVEL) {
        return p;
    }
    vec3 drawn = omega * (p - q) + q;
    uint cell = cell_of(drawn);
    if (cell != cell_of(p) && has_base(cell)) {
        if (!is_active(cell) && blocks[cell].live > 0) {
            return p; // the flow must pass over what is solid
        }
    }
    return drawn;
}

void main() {
    uint block = element(64u);
    if (block >= constants.block_count) {
        return;
    }
    BaseDisplacement before = old_bases[block];
    if (!has_base(block)) {
        new_bases[block] = before;
        return;
    }
    if (!is_active(block)) {
        new_bases[block] = BaseDisplacement(before.offset, 0.0);
        return;
    }
    vec3 p = base_of(block);
    new_bases[block] = BaseDisplacement(before.offset + (moved(block, p) - p), 1.0);
}
