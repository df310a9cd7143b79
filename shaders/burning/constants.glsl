// Every number of the run, uploaded once (3.7.4), and the enumerations that all passes share. The unit of length is the
// object's diagonal.

layout(set = 0, binding = 0, std140) uniform Constants {
    uvec3 blocks; // along x, y, z
    uint block_count;
    vec3 grid_origin; // lowest corner of the blocks
    float floor_y; // lowest height of what melts
    vec3 block_size;
    float mean_edge; // of the finest triangles at rest
    vec3 albedo; // linear RGB
    float gravity_per_tick; // g dt^2
    uint vertex_count;
    uint triangle_count; // finest triangles
    uint draw_vertex_count;
    float growth_per_tick; // of the boundary's radius
    float area_width; // of the boundary
    float highest_source_y;
    uint level_stride; // of the lists of table 3.1's levels: 0 where an object has one material
    float gamma; // rotation of blocks (eq. 4)
    float spread; // x of 3.5.2
    float greatest_rotation_rad; // of a block
    float greatest_free_rotation_rad; // of a block with two or more free sides
    float omega; // longest edge, mean edges
    float chi; // longest over shortest edge
    float upsilon; // fraction of a violation that is folded in a tick
    float outward; // 1 where triangles wind outwards, else -1
    float retire_at; // fraction of L at which a vertex of a solid retires (5.5), else 0
    float char_depth; // of a solid
    uint active_limit; // of vertices (3.7.1), NONE for none
    uint seed;
    uint levels; // of the refinement pattern
    uint coarse_count; // coarse triangles
    uint fire_pool; // most fire particles
    uint smoke_pool; // most smoke particles
    float charring; // 1 of a material that chars and glows, 0 of wax
    vec3 wind; // diagonals a second
    float evaporation_per_tick; // of the height of a puddle
    float embers; // 1 where char glows while it burns, else 0
    float setting_per_tick; // share of its motion that wax loses once the fire has ended
    float last_radius; // of the boundary when the last vertex has burnt out
    float ground_y; // lowest height that is drawn
} constants;

// Areas of the heat boundary, from the outside in (3.3, 4.3).
const uint OUTSIDE = 0u;
const uint VIRTUAL = 1u;
const uint INITIAL = 2u;
const uint READY = 3u;
const uint DEFORMED = 4u;

const uint NONE = 0xffffffffu;
