// Every number of the run, uploaded once (3.7.4), and the words that all passes share. Lengths are shares of the object's diagonal.

layout(set = 0, binding = 0, std140) uniform Constants {
    uvec4 counts; // vertices, finest triangles, draw vertices, blocks
    uvec4 grid; // blocks along x, y, z; the variant
    vec4 origin; // the lowest corner of the blocks; lowest height of what melts
    vec4 cell_size; // of a block; mean rest edge
    vec4 boundary; // growth of the radius a tick, width of an area, height of the highest source, flammability
    vec4 material; // epsilon, beta, rho, phi
    vec4 rotation; // gamma, x, greatest angle, greatest angle of a free block
    vec4 melting; // omega, chi, upsilon
    vec4 solid; // 1 where triangles wind outwards or else -1; L at which a vertex retires, 0 but for a solid; depth of its char
    vec4 albedo; // linear RGB; fall in a tick: epsilon g dt^2
    uvec4 choices; // active limit, whether neighbours are kept connected, seed
    uvec4 tree; // levels, coarse triangles, fire and smoke particles at most
} constants;

// Variants, numbered as src/papers/burning/state.rs does.
const uint SHELL = 0u;
const uint LOW_POLY = 1u;
const uint FULLY_SUBDIVIDED = 2u;
const uint SOLID = 3u;
const uint MELTING = 4u;

// Areas of the heat boundary, from the outside in (3.3, 4.3).
const uint OUTSIDE = 0u;
const uint VIRTUAL = 1u;
const uint INITIAL = 2u;
const uint READY = 3u;
const uint DEFORMED = 4u;

const uint NONE = 0xffffffffu;
