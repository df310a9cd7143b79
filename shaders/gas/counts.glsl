// Bounds of loops and conditions that are the same for all pixels. They stand in a storage buffer: where a condition
// depends on uniform blocks and push constants alone, lavapipe compiles the shader anew with their values, and keeps
// every copy.

layout(set = 0, binding = 18, std430) readonly buffer Counts {
    uint volumes;
    uint lights;
    uint octaves; // of turbulence
    uint attenuations; // of a fragment for each light: 1 where light-attenuation runs, else 0
    uint samples; // of an increment along the viewer's ray
    uint jitter; // their places: RANDOM or BLUE_NOISE
    uint nearest; // fragments that are kept of a pixel, where not all are
    uint chunks; // of the triangles of tiles that there is room for
    uint cache; // entries of the tables of densities along each axis
    uint bricks; // along each axis of a volume's box
    uint froxel_columns;
    uint froxel_rows;
    uint froxel_slices;
    float froxels_first_m; // depth at which they begin, see froxels.glsl
    float froxels_last_m; // and end
    uint glow; // 1 where files have temperatures
    uint volume_scale; // of every so many columns and rows a pixel's gas is marched before the others' is
} counts;

// Read once a thread, before any condition: a processor that does many threads in step reads a storage buffer thread by thread
// once some of them may be idle.
uint octaves = 0u;
uint cache_size = 0u;
uint brick_count = 0u;
uint sample_count = 0u;
uint jitter_kind = 0u;
uint lattice_scale = 1u;
uint attenuation_count = 0u;

void read_counts() {
    octaves = counts.octaves;
    cache_size = counts.cache;
    brick_count = counts.bricks;
    sample_count = counts.samples;
    jitter_kind = counts.jitter;
    lattice_scale = counts.volume_scale;
    attenuation_count = counts.attenuations;
}
