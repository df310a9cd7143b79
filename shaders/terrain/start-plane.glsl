// Over a plane a ray begins where the pass `start` left its tile's, or at its own beginning: then `starts` is a texel of 0.

#include "terrain/tile-pixels.glsl"

layout(set = 0, binding = 5) uniform texture2D starts;

// A block as wide as the tile's beam holds most of what its rays may meet next.
Start start_of(ivec2 pixel) {
    float free_m = texelFetch(starts, min(pixel / TILE_PIXELS, textureSize(starts, 0) - 1), 0).x;
    int exponent = (floatBitsToInt(free_m * map.pixel * float(TILE_PIXELS)) >> 23) - 127;
    return free_m > 0.0 ? Start(free_m, clamp(exponent, 1, max(map.top, 1))) : nothing_known();
}
