// The cubic's weights along an axis sum up to 1, and their sizes to 5/4 at most, in the middle between samples. Of three axes
// the sizes sum up to (5/4)^3 at most, so that the weights below 0 sum up to ((5/4)^3 - 1) / 2.

#include "gas/density-tricubic.glsl"
#include "gas/bound-grid.glsl"

float gas_bound(uint v, vec3 low, vec3 high) {
    return grid_bound(v, low, high, 1, 0.4766);
}
