// What every pass knows of one frame. Depth is measured along the view direction, in metres; a ray's direction has
// depth 1, so that eye + depth * ray is the point.

layout(set = 0, binding = 0, std140) uniform Frame {
    vec3 eye; // m
    float hither_m; // depth of the hither plane
    vec3 forward; // unit
    float yon_m; // depth of the yon plane
    vec3 ray_per_column; // change of a ray's direction from one pixel to the next on its right
    float number; // of the scene's frame, a whole number
    vec3 ray_per_row; // and to the one below
    float shadow_threshold; // density below which no shadow of the gas on itself is computed
    vec3 to_column; // a point's offset from the eye times this, over its depth, is its column from the picture's middle
    float early_end; // transparency below which the tracing of a pixel ends
    vec3 to_row; // the same for rows
    uint fragment_capacity; // slots of the fragments' buffers
    vec3 ambient; // linear RGB
    uint section_capacity;
    vec3 background; // linear RGB
    uint table_size; // entries of the tables along each axis
    uvec2 size; // of the picture, pixels
    uint noise_seed;
} frame;

const uint NONE = 0xffffffffu; // the end of a list
const uint MAX_LIGHTS = 4u;

vec3 ray_direction(vec2 pixel) {
    vec2 offset = pixel - 0.5 * vec2(frame.size);
    return frame.forward + frame.ray_per_column * offset.x + frame.ray_per_row * offset.y;
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
