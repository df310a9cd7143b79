// A mean of samples, by weights: the greatest bounds it.

#include "gas/density-trilinear.glsl"
#include "gas/bound-grid.glsl"

float gas_bound(uint v, vec3 low, vec3 high) {
    return grid_bound(v, low, high, 0, 0.0);
}
