// What every pass knows of one frame. Depth is measured along the view direction, in metres; a ray's direction has depth 1, so
// that eye + depth * ray is the point.

layout(set = 0, binding = 0, std140) uniform Frame {
    vec4 eye; // w: depth of the hither plane
    vec4 forward; // unit; w: depth of the yon plane
    vec4 column; // change of a ray's direction from one pixel to the next on its right
    vec4 row; // and to the one below
    vec4 to_column; // a point's offset from the eye times this, over its depth, is its column from the picture's middle
    vec4 to_row;
    vec4 ambient; // linear RGB; w: 1 where light-attenuation runs
    vec4 background; // linear RGB
    vec4 sampling; // frame number, pixel_size, density below which no shadow is computed, transparency of the early end
    uvec4 counts; // width, height, lights, volumes
    uvec4 limits; // fragments, sections, table entries along an axis, seed
} frame;

const uint NONE = 0xffffffffu; // the end of a list
const uint MAX_VOLUMES = 8u;
const uint MAX_LIGHTS = 4u;

vec3 ray_direction(vec2 pixel) {
    vec2 offset = pixel - 0.5 * vec2(frame.counts.xy);
    return frame.forward.xyz + frame.column.xyz * offset.x + frame.row.xyz * offset.y;
}

// Integer hash with full avalanche: the lattice, the samples and their oracles use this one.
uint scramble(uint value) {
    uint h = value;
    h ^= h >> 16u;
    h *= 0x7feb352du;
    h ^= h >> 15u;
    h *= 0x846ca68bu;
    h ^= h >> 16u;
    return h;
}
