// Smoothed particle hydrodynamics of the variant of stage one that flows: constants, the kernel, walls, and the cells
// around a particle. Particles are in the order of their cells; cells along y follow each other.

#include "common/texels.glsl"

layout(push_constant, std430) uniform Flow {
    vec3 space_m;
    uint particles;
    uvec3 counts; // cells along x, y and z
    uint width; // of the particles' textures
    vec3 gravity_m_s2;
    float time_step_s;
    float support_m; // h, where the kernel ends
    float volume; // of a particle over the kernel's unit, h^3: a lattice at rest sums up to 1
    float drag; // of two particles: twice step, viscosity and volume over density, per h^2
    uint listed; // particles, the first by cells, that have a list of those near them
    float kept; // of Chebyshev's last change, or of what lasts from the step before
    float gained; // of the residual
    float margin_m; // no particle comes nearer to a wall
    float periodic; // 1 where x and z have no walls but repeat
    float laplacian; // of a particle as `volume`, but so that a lattice has the Laplacian of a parabola
    float conduction; // of two particles: twice step, diffusivity and that volume, per h^2
    float given; // of a particle's warmth over its face's, that which goes there in a step, by the steepness
    float radiance; // of a face over what reaches it from the particle's middle for each kelvin, per K^3
    float ambient_k;
    float melt_k; // where the lava has the viscosity that `drag` is made of
    float solidus_k;
    float per_viscosity; // 1 over that viscosity
    float stiffest; // most of that viscosity that crust and cold lava have
    float share; // of the first of two layings of the rock in what is seen
    uint kept_rock; // a bit for each laying that does not begin anew with the step
    uint turn; // of three, in which iterations say whether there is more to do
} flow;

layout(set = 0, binding = 0, std430) readonly buffer Starts {
    uint list[];
} starts;

// lavapipe ends all loops of a shader after 65,535 iterations: nine stretches of so many particles.
const uint MOST = 7200u;
const uint LISTED = 96u; // particles of a list; a lattice at rest has 77 within the farther reach
const uint EIGHTS = 21u; // whose lists fill a row of a texture
const uint WALKS = 0xffffffffu; // in place of a list's length: all of 27 cells are looked at
const float SIGMA = 3.34225380493; // 21 / (2 pi)

// Of four of its list. The lists of eight particles, which are looked at together, lie side by side, four after four, and so
// does all that a cache's line and a page hold.
ivec2 four_of(uint at, uint first) {
    uint eight = at / 8u;
    uint along = (eight % EIGHTS * (LISTED / 4u) + first / 4u) * 8u + at % 8u;
    return ivec2(int(along), int(eight / EIGHTS));
}

// Wendland's kernel C2 (1995) in units of h^-3: SIGMA (1 - q)^4 (1 + 4 q).
float kernel(float q) {
    float inside = max(1.0 - q, 0.0);
    float squared = inside * inside;
    return SIGMA * squared * squared * (1.0 + 4.0 * q);
}

// Its slope over the distance, which is at most 0, in units of h^-5.
float slope(float q) {
    float inside = max(1.0 - q, 0.0);
    return -20.0 * SIGMA * inside * inside * inside;
}

// The shortest way between two places, where the space repeats.
vec3 apart(vec3 way_m) {
    vec2 turns = flow.periodic * floor(way_m.xz / flow.space_m.xz + 0.5);
    return vec3(way_m.x - turns.x * flow.space_m.x, way_m.y, way_m.z - turns.y * flow.space_m.z);
}

// The stretch of particles in the column of cells that is so far from a cell, from one height to another: none beyond a wall.
// A periodic space has three cells along x and z at least.
uvec2 stretch_of(ivec2 cell, ivec2 aside, int low, int high) {
    ivec3 counts = ivec3(flow.counts);
    ivec2 at = cell + aside;
    ivec2 turned = ivec2((at.x + counts.x) % counts.x, (at.y + counts.z) % counts.z);
    int column = (turned.y * counts.x + turned.x) * counts.y;
    uint first = starts.list[column + low];
    uint end = starts.list[column + high + 1];
    bool is_there = at == turned || flow.periodic > 0.5;
    return uvec2(first, is_there ? end : first);
}

ivec3 cell_of(vec3 place_m) {
    ivec3 counts = ivec3(flow.counts);
    return min(ivec3(place_m / flow.space_m * vec3(counts)), counts - 1);
}

// That stretch around a particle, along y a cell to either side.
uvec2 stretch_at(vec3 place_m, int along_x, int along_z) {
    ivec3 cell = cell_of(place_m);
    int highest = int(flow.counts.y) - 1;
    return stretch_of(cell.xz, ivec2(along_x, along_z), max(cell.y - 1, 0), min(cell.y + 1, highest));
}
