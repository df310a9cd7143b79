// The map and how the camera sees it: eq. 9 to 11. Heights are the map's own numbers (16-bit steps or metres), so that no
// texel needs decoding on the ray.

layout(set = 0, binding = 0, std140) uniform Terrain {
    vec3 eye; // in the map's frame
    float pixel_nodes; // nodes that a pixel covers at a depth of 1 m; on steep terrain those over which it rises by a pixel
    vec3 corner_direction; // to the middle of pixel (0, 0), for 1 m of depth
    float near_m; // near plane of what is rasterised
    vec3 right_step; // the direction's change from a pixel to the next on the right
    int map_index;
    vec3 down_step; // and to the next below
    int base_kind; // PLANE, CYLINDER or an ellipsoid
    vec3 to_sun; // in the map's frame, for 1 m
    float widest_spacing_m; // between nodes where they are farthest apart
    vec3 east; // the frame's axes in the world: on a plane east, up, south; else east, off the axis, along it
    float height_unit_m; // metres for a unit of height
    vec3 up;
    float base_height;
    vec3 south;
    float height_tolerance; // how near a height counts as met
    float lowest; // heights
    float highest;
    float rounding_nodes; // what rounding may have cost a place
    float rounding_height; // and a height
    vec2 spacing_m; // between columns and between rows
    ivec2 size; // columns, rows
    ivec2 level_axis; // (1, 0) or (0, 1): along which the levels lie in their layer
    int top_level; // the number of levels above the data
    int is_float; // texels are bits of floats
    // What follows describes a curved base.
    float semi_major_m; // of the ellipse of a meridian
    float squared_eccentricity;
    float sine_latitude; // of the map's middle
    float cosine_latitude;
    vec2 middle_node;
    float axis_distance_m; // of the map's middle
    float smallest_radius_m; // of curvature
    vec2 nodes_per_unit; // for a radian of longitude along u, of latitude along v (cylinder: for a metre)
    float curvature_change; // of a meridian's radius over a radian of latitude, as a fraction of it
    float shell_constant; // the surface through the highest height, as a quadric: constant, squares and linear terms, each
                          // off the axis and along it
    vec2 shell_squares;
    vec2 shell_linear;
    vec2 base_squares; // the base as such a quadric
    vec2 base_linear;
    float node_normals_below; // nodes that a pixel covers, below which normals are those between the nodes'
    int marks_tiles; // the tiles that are read are marked
    float error_m; // metres towards the sun that lead out of the map from what is drawn in its place, for 1 m of depth
} terrain;

#include "terrain/kinds.glsl"

// Members of the block that every read of the map needs, read once: a loop fetches a member of a block in every iteration.
struct Map {
    ivec2 last; // column and row
    int top; // levels above the data
    ivec2 spread; // texels between the coarser levels, at the data's size
    ivec2 beside; // where their corners begin, beside the data's
    bool is_float;
    float pixel; // nodes that one covers at a depth of 1 m
};
Map map;

void read_map() {
    ivec2 spread = terrain.level_axis * (1 << terrain.top_level);
    ivec2 beside = (ivec2(1) - terrain.level_axis) * terrain.size;
    map = Map(terrain.size - 1, terrain.top_level, spread, beside, terrain.is_float != 0, terrain.pixel_nodes);
}

// Surfaces that a ray may hit; numbered as src/papers/terrain/hit.rs does.
const int SKY = 0;
const int BASE = 1;
const int TERRAIN = 2;
const int WALL_WEST = 3;
const int WALL_EAST = 4;
const int WALL_NORTH = 5;
const int WALL_SOUTH = 6;
const int INSIDE = 7;

const float NO_DEPTH = 1.0e30;

// Where a ray ends.
struct Hit {
    float depth; // metres along the view's axis
    vec2 place; // u and v, nodes
    float surface; // which surface + 8 x level + 256 x map + 4096 x subsegments that were tried
};

// Of a ray whose loops the driver ended: some give a shader 65,535 iterations of all its loops together and then leave every
// loop without a word. No map has so many levels.
const Hit UNFINISHED = Hit(NO_DEPTH, vec2(0.0), 8.0 * 31.0);
// The light where a ray to the sun was.
const float UNKNOWN_LIGHT = 2.0;

// The range of the fraction of a subsegment that is over the map, and the surface at its near end.
struct Clip {
    float near;
    float far;
    int surface;
};

float surface_code(int surface, int shift, int segments) {
    return float(surface + 8 * shift + 4096 * min(segments, 4095)) + 256.0 * float(terrain.map_index);
}

ivec2 last_texel(int shift) {
    return map.last >> shift;
}

// The smallest number of levels above the data whose texels are as large as the extent, in nodes.
int shift_for(float extent) {
    int exponent = ((floatBitsToInt(extent) + 0x7fffff) >> 23) - 127;
    return clamp(exponent, 0, map.top);
}

// The north-west corner of the cell of a level around a place in nodes, and where the place lies in it, 0 to 1. A coarser
// level's texel stands in the middle of the nodes that it covers.
vec4 cell_at(int shift, vec2 place) {
    float size = exp2(-float(shift));
    vec2 texel = clamp(place * size + (0.5 * size - 0.5), vec2(0.0), vec2(last_texel(shift)));
    vec2 corner = min(floor(texel), vec2(max(last_texel(shift) - 1, 0)));
    return vec4(corner, texel - corner);
}

vec3 direction_of(vec2 pixel) {
    return terrain.corner_direction + pixel.x * terrain.right_step + pixel.y * terrain.down_step;
}
