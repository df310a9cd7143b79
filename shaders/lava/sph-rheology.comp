#version 450

// The viscosity of a particle over that of the melt at its temperature: the fit of Giordano and Dingwell (2003) for basalt of
// Etna with 0.1 % of water, and below the solidus a Bingham crust with the yield stress of Ishihara et al. (1990), over the
// rate of strain that the last step left. It is regularised by a largest viscosity (O'Donovan and Tanner 1984). Pressure shakes
// single particles, which is no flow: the tensor is the mean of those around, by the kernel.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "lava/sph.glsl"
#include "lava/sph-lists.glsl"
#include "lava/sph-began.glsl"

layout(set = 0, binding = 4, std430) readonly buffer Along {
    vec4 list[]; // rates of strain per second: the tensor's diagonal
} along;

layout(set = 0, binding = 5, std430) readonly buffer Across {
    vec4 list[]; // twice what stands beside it
} across;

layout(set = 0, binding = 6, std430) readonly buffer Heat {
    vec2 list[]; // kelvin as the step ends
} heat;

layout(set = 0, binding = 7, std430) buffer Viscosities {
    float list[]; // over the melt's
} viscosities;

const float BITS = 3.32192809; // log2(10)
const float B_K = 5769.736; // 5812.44 - 427.04 of the water
const float C_K = 565.4864; // 499.31 - 28.74 ln of the water
const float COLDEST_K = 50.0; // above C, where the fit has its pole
const float YIELD = 13.00997; // log10 of the yield stress in Pa is this, less
const float YIELD_PER_K = 0.0089;
const float MOST_BITS = 60.0; // of a ratio that single precision holds

vec3 place_m;
vec3 diagonal = vec3(0.0);
vec3 beside = vec3(0.0);
float shares = 0.0;

void gather(uint i, float weight) {
    float share = weight * kernel(length(apart(place_m - began_m(i))) / flow.support_m);
    diagonal += share * along.list[i].xyz;
    beside += share * across.list[i].xyz;
    shares += share;
}

#include "lava/sph-gather.glsl"

void main() {
    uint at = element(64u);
    if (at >= flow.particles) {
        return;
    }
    place_m = began_m(at);
    gather_around(at, place_m);
    // The root of twice the sum of the squares of all components of the mean.
    float strain_per_s = sqrt(2.0 * dot(diagonal, diagonal) + dot(beside, beside)) / shares;
    float kelvin = heat.list[at].x;
    float fit = BITS * B_K * (1.0 / max(kelvin - C_K, COLDEST_K) - 1.0 / (flow.melt_k - C_K));
    float melt = exp2(min(fit, MOST_BITS));
    float stress = exp2(min(BITS * (YIELD - YIELD_PER_K * kelvin), MOST_BITS)) * flow.per_viscosity;
    float crust = kelvin < flow.solidus_k ? stress / max(strain_per_s, 1.0e-9) : 0.0;
    viscosities.list[at] = min(melt + crust, flow.stiffest);
}
