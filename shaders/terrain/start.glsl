// The pass `start` of one tile of 8 x 8 pixels, over a plane: a depth in metres up to which none of its rays has met the map. All of
// them together are a beam, as wide as the tile at every depth. It is followed in pieces, longer ones where it is free and shorter
// ones where it is not: a piece is free where the box around it lies above all that the map has below it.

#include "terrain/cells-between.glsl"
#include "terrain/tile-pixels.glsl"

// What rounding may cost a direction, and what is given away of a depth, as fractions of themselves.
const float ROUNDING = 1.0e-6;
const float BACK = 1.0e-5;
// A beam is left where a piece as long as this part of its width is not free, or after so many pieces.
const float SHORTEST = 0.5;
const int MOST_PIECES = 64;

float free_depth(ivec2 tile) {
    read_map();
    float middle = 0.5 * float(TILE_PIXELS - 1);
    vec3 direction = direction_of(vec2(TILE_PIXELS * tile) + middle);
    vec3 spread = (middle + BACK) * (abs(terrain.right_step) + abs(terrain.down_step)) + ROUNDING * abs(direction);
    vec3 least = direction - spread;
    vec3 most = direction + spread;
    vec3 eye = terrain.eye;
    vec2 end = vec2(map.last);
    float width = 2.0 * max(spread.x, spread.y);
    float speed = max(abs(direction.x) + spread.x, abs(direction.y) + spread.y);
    bool falls = least.z < 0.0;
    // From above the map the beam is free until it comes down to it.
    float over = eye.z - (terrain.highest + terrain.rounding_height);
    float depth_m = over > 0.0 ? (falls ? (1.0 - BACK) * over / -least.z : NO_DEPTH) : 0.0;
    float piece_m = 0.25 * float(max(terrain.size.x, terrain.size.y)) / speed;
    bool is_done = depth_m >= NO_DEPTH;
    for (int piece = 0; piece < MOST_PIECES && !is_done; piece++) {
        float far_m = depth_m + piece_m;
        vec2 low = eye.xy + min(depth_m * least.xy, far_m * least.xy) - terrain.rounding_nodes;
        vec2 high = eye.xy + max(depth_m * most.xy, far_m * most.xy) + terrain.rounding_nodes;
        float lowest = eye.z + min(depth_m * least.z, far_m * least.z) - terrain.rounding_height;
        float highest = highest_between(low, high, shift_for(max(high.x - low.x, high.y - low.y)));
        if (lowest > highest) {
            depth_m = far_m;
            piece_m *= 2.0;
            // Past the map no ray comes back.
            bvec2 is_past = bvec2((least.x > 0.0 && low.x > end.x) || (most.x < 0.0 && high.x < 0.0),
                                  (least.y > 0.0 && low.y > end.y) || (most.y < 0.0 && high.y < 0.0));
            is_done = any(is_past) || (!falls && lowest > terrain.highest);
        } else {
            float down_m = falls ? (1.0 - BACK) * (highest + terrain.rounding_height - eye.z) / least.z : 0.0;
            is_done = piece_m * speed < SHORTEST * max(width * depth_m, 1.0);
            depth_m = clamp(down_m, depth_m, far_m);
            piece_m *= 0.5;
        }
    }
    return (1.0 - BACK) * depth_m;
}
