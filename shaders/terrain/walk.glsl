// A straight line through the levels, for the variants `dda-compute` and `dda-fragment`: blocks of cells are walked one after the
// other, from border to border. A texel of a level k above the data bounds the surface over all of its 2^k x 2^k cells, so that
// one read answers for a step: maximum mipmaps (Tevs, Ihrke, Seidel 2008) and quadtree displacement mapping (Drobot 2010). The
// ray climbs a level where it leaves a block of the level above as well, and goes at once to where it comes down to a block's
// height.
//
// Before this file stand one for the base, one for the interpolation and one for where a walk ends.

#include "terrain/cells-between.glsl"
#include "terrain/crossing.glsl"

// The part of a line over one block, 0 to 1, at which it meets the surface of the level that is seen; -1 where it does not.
float part_in(int shift, ivec2 cell, vec3 from, vec3 direction) {
#ifdef LOD_EXACT
    return touch(0, cell, vec3(from.xy - vec2(cell), from.z), direction);
#else
    return crossing_of(shift, from, from + direction);
#endif
}

// The cell of a block in which a place lies.
ivec2 cell_in(ivec2 block, int level, vec2 place, ivec2 last_cell) {
    ivec2 first = block << level;
    // No block begins below 0, so that cut off is as good as rounded down.
    return clamp(ivec2(place), first, min(first + ((1 << level) - 1), last_cell));
}

// The cell and the level at which a ray goes on that leaves a block at a cell of it: over the border that is the nearer one, and a
// level up where that is a border of the level above as well. `border` is that of the block ahead, in blocks.
ivec3 beyond(ivec2 border, int level, ivec2 forward, bool along_x, ivec2 inside) {
    ivec2 next = (border << level) + forward - 1;
    int up = 1 - ((along_x ? border.x : border.y) & 1);
    return ivec3(along_x ? next.x : inside.x, along_x ? inside.y : next.y, min(level + up, map.top));
}

// A number below 0 is a large one without its sign.
bool is_outside(ivec2 cell, ivec2 last_cell) {
    return any(greaterThan(uvec2(cell), uvec2(last_cell)));
}

// The depth up to which a ray is known to be above the surface, and the level at which it is followed from there.
struct Start {
    float free_m;
    int level;
};

Start nothing_known() {
    return Start(0.0, max(map.top - 2, 1));
}

Start known; // of the ray that is traced; over a curved base not asked

// Nodes along u and v, and height; the depth of its ends in metres.
struct Line {
    vec3 from;
    vec3 whole;
    float near_m;
    float far_m;
};

// The fraction of the line at which it meets the surface, -1 where it does not; false where the driver ended the loop.
struct Met {
    float t;
    bool is_certain;
};

// `free` is how much of the line is known to be above the surface: from there on it is walked, from a block of `first_level` on.
Met walk(Line line, float free, int first_level, inout int steps) {
    vec3 from = line.from;
    vec3 whole = line.whole;
    // A ray along the grid never comes to the borders beside it: their part of the ray is beyond its end.
    vec2 never = vec2(abs(whole.x) < 1.0e-6 ? 2.0 : 0.0, abs(whole.y) < 1.0e-6 ? 2.0 : 0.0);
    vec2 inverse = vec2(never.x > 0.0 ? 0.0 : 1.0 / whole.x, never.y > 0.0 ? 0.0 : 1.0 / whole.y);
    ivec2 forward = ivec2(whole.x > 0.0 ? 1 : 0, whole.y > 0.0 ? 1 : 0);
    bool falls = whole.z < 0.0;
    float margin = terrain.rounding_height;
    ivec2 last_cell = max(map.last - 1, ivec2(0));
    ivec2 cell = clamp(ivec2(floor(from.xy + free * whole.xy)), ivec2(0), last_cell);
    int level = first_level;
    float t = free; // of the ray
    float met = -1.0;
    bool done = false;
    // Ends are asked for after a step: where they are asked for before, processors run one more step for all rays, to no end.
    while (true) {
        bool is_last = level == 0;
        while (true) {
            if (!is_last) {
                ivec2 block = cell >> level;
                ivec2 border = block + forward;
                vec2 at_border = (vec2(border << level) - from.xy) * inverse + never;
                float end = max(min(min(at_border.x, at_border.y), 1.0), t);
                float highest = highest_over(level, block);
                bool is_free = from.z + whole.z * (falls ? end : t) - margin > highest;
                float down = falls ? max(t, min((highest + margin - from.z) / whole.z, end)) : t;
                t = is_free ? end : down;
                cell = cell_in(block, level, from.xy + t * whole.xy, last_cell);
                ivec3 next = beyond(border, level, forward, at_border.x < at_border.y, cell);
                bool is_finest = level <= finest_shift(line.near_m + t * (line.far_m - line.near_m));
                is_last = !is_free && (is_finest || level == 1);
                cell = is_free ? next.xy : cell;
                level = is_free ? next.z : level - (is_finest ? 0 : 1);
                steps += 1;
                done = is_free && (t >= 1.0 || is_outside(cell, last_cell));
            }
            if (is_last || done) {
                break;
            }
        }
        if (is_last) {
            ivec2 block = cell >> level;
            ivec2 border = block + forward;
            vec2 at_border = (vec2(border << level) - from.xy) * inverse + never;
            float end = max(min(min(at_border.x, at_border.y), 1.0), t);
            int finest = finest_shift(line.near_m + t * (line.far_m - line.near_m));
            float part = part_in(max(finest, level), cell, from + t * whole, (end - t) * whole);
            steps += level == 0 ? 1 : 0;
            done = part >= 0.0;
            met = done ? t + part * (end - t) : -1.0;
            if (!done) {
                t = end;
                ivec2 inside = cell_in(block, level, from.xy + t * whole.xy, last_cell);
                ivec3 next = beyond(border, level, forward, at_border.x < at_border.y, inside);
                cell = next.xy;
                level = next.z;
                done = t >= 1.0 || is_outside(cell, last_cell);
            }
        }
        if (done) {
            break;
        }
    }
    // Not `!done`: compilers know that the loop ends with it.
    return Met(met, met >= 0.0 || t >= 1.0 || is_outside(cell, last_cell));
}
