#version 450

// Temperatures at the end of the step: conduction by the symmetric form of Cleary and Monaghan (1999), in which what one
// particle loses another gains, and radiation at the free surface by Stefan and Boltzmann's law. What is exchanged is enthalpy:
// lava that crystallises gives off its latent heat evenly from the liquidus to the solidus. A particle is at the surface
// where the smoothed amount of lava falls off steeply (Mueller et al. 2003); the steepness is the share of its face. The face is
// half a distance of particles away from the middle, and as hot as what it radiates and what reaches it agree.

#extension GL_EXT_samplerless_texture_functions : require

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "lava/sph.glsl"
#include "lava/bed.glsl"
#include "lava/sph-walls.glsl"
#include "lava/sph-lists.glsl"
#include "lava/sph-began.glsl"

layout(set = 0, binding = 4, std430) readonly buffer Pushed {
    vec4 list[]; // metres per second, and kelvin as the step begins
} pushed;

layout(set = 0, binding = 5, std430) buffer Heat {
    vec2 list[]; // kelvin as the step ends, and the steepness of a particle's face, 0 inside
} heat;

layout(set = 0, binding = 6, std430) readonly buffer Latent {
    float kelvin; // latent heat over the heat capacity
    float interval_k; // from solidus to liquidus
} latent;

// Enthalpy over the heat capacity: what lava of a temperature and its share of melt hold, in kelvin.
float enthalpy_of(float kelvin) {
    return kelvin + latent.kelvin * clamp((kelvin - flow.solidus_k) / latent.interval_k, 0.0, 1.0);
}

// The temperature of it.
float kelvin_of(float enthalpy) {
    float melt = clamp((enthalpy - flow.solidus_k) / (latent.interval_k + latent.kelvin), 0.0, 1.0);
    return enthalpy - latent.kelvin * melt;
}

// Of the amount of lava per h: on a level face 1.1 in the first layer and 0.08 in the second, by the layer that lies close to
// the floor up to 0.5.
const float STEEP = 0.6;

// Gradient of the walls' share, times h, where two walls meet with each the other's part left out: it would be a face of lava.
vec3 wall_gradient_once(Walls walls) {
    vec4 q = walls.sides_q;
    float below = 1.0 - beyond(walls.bed_q);
    float along_x = 1.0 - beyond(q.x) - beyond(q.y);
    float along_z = 1.0 - beyond(q.z) - beyond(q.w);
    vec2 sides = vec2(beyond_slope(q.y) - beyond_slope(q.x), beyond_slope(q.w) - beyond_slope(q.z)) * below;
    float bed = beyond_slope(walls.bed_q) * along_x * along_z;
    return vec3(sides.x * along_z, 0.0, sides.y * along_x) - bed * walls.up;
}

// The root of T_f + radiance (T_f^4 - T_a^4) = T by Newton's method, which comes down to it: the function is convex.
float face_of(float kelvin) {
    float squared = flow.ambient_k * flow.ambient_k;
    float face = kelvin;
    for (int i = 0; i < 8; i++) {
        float cubed = face * face * face;
        float excess = face - kelvin + flow.radiance * (cubed * face - squared * squared);
        face -= excess / (1.0 + 4.0 * flow.radiance * cubed);
    }
    return face;
}

// As the step begins.
float kelvin_of(uint particle) {
    return pushed.list[particle].w;
}

vec3 place_m;
float kelvin;
float conducted = 0.0;
vec3 gradient = vec3(0.0);

void gather(uint i, float weight) {
    vec3 way = apart(place_m - began_m(i)) / flow.support_m;
    float steep = weight * slope(length(way));
    conducted -= steep * (kelvin_of(i) - kelvin);
    gradient += steep * way;
}

#include "lava/sph-gather.glsl"

void main() {
    uint at = element(64u);
    if (at >= flow.particles) {
        return;
    }
    place_m = began_m(at);
    kelvin = kelvin_of(at);
    gather_around(at, place_m);
    float steepness = length(flow.volume * gradient + wall_gradient_once(walls_at(place_m)));
    steepness = steepness > STEEP ? steepness : 0.0;
    float enthalpy = enthalpy_of(kelvin) + flow.conduction * conducted;
    kelvin = kelvin_of(enthalpy);
    enthalpy -= flow.given * steepness * (kelvin - face_of(kelvin));
    heat.list[at] = vec2(kelvin_of(enthalpy), steepness);
}
