// The map and how the camera sees it: eq. 9 to 11. Heights are the map's own numbers (16-bit steps or metres), so that no
// texel needs decoding on the way.

layout(set = 0, binding = 0, std140) uniform Land {
    vec4 eye; // in the map's frame; nodes that a pixel covers at a depth of 1 m
    vec4 corner; // direction to the middle of pixel (0, 0), for 1 m of depth
    vec4 across; // its change from a pixel to the next on the right
    vec4 down; // and to the next below
    vec4 bounds; // lowest and highest height; height of the base; metres for a unit of height
    vec4 margin; // what rounding may have cost: nodes, height; metres between columns and rows
    vec4 sundry; // how near a height counts as met; the map's number; near plane of what is rasterised; unused
    ivec4 size; // columns, rows, the number of levels above the data, 2 to that power
    ivec4 form; // axis along which the levels lie (0, 1); whether texels are bits of floats; base: 0 plane, 1 cylinder,
                // 2 ellipsoid
    vec4 curve; // of the ellipse of a meridian: semi-major axis, squared eccentricity; sine, cosine of the middle latitude
    vec4 middle; // of the map: distance from the axis; its place in nodes; smallest radius of curvature
    vec4 steps; // nodes for a radian along u, along v (cylinder: for a metre); latitude's share of changing curvature
    vec4 shell; // the surface through the highest height, as a quadric: squares off and along the axis; its constant
    vec4 slope; // linear terms of the shell off and along the axis, and of the base
    vec4 ground; // squares of the base off and along the axis
    vec4 east; // the frame's axes in the world: on a plane east, up, south; else east, off the axis, along it
    vec4 up;
    vec4 south;
    vec4 sun; // the way to the sun in the map's frame, for 1 m; metres between nodes where they are farthest apart
} land;

layout(set = 0, binding = 1) uniform utexture2DArray levels;

// What every look at the map needs of the block, read once: a member of a block is fetched anew in each turn of a loop.
struct Map {
    ivec2 last; // column and row
    int top; // levels above the data
    ivec2 spread; // texels between the coarser levels, at the data's size
    bool is_float;
    float pixel; // nodes that one covers at a depth of 1 m
};
Map map;

void read_map() {
    map = Map(land.size.xy - 1, land.size.z, land.form.xy * land.size.w, land.form.z != 0, land.eye.w);
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
    float surface; // which surface + 8 x level + 256 x map + 4096 x segments looked at
};

// The part of a segment that is over the map, and the surface at its near end.
struct Over {
    float near;
    float far;
    int surface;
};

// Where a last segment crosses the surface: the part of it over the map, -1 where it does not, and how high above the surface
// its near end is.
struct Crossing {
    float part;
    float above;
};

float surface_code(int surface, int shift, int segments) {
    return float(surface + 8 * shift + 4096 * min(segments, 4095)) + 256.0 * land.sundry.y;
}

// The value of a texel `shift` levels above the data. Layer 0 holds the data, `layer` the coarser levels, each beginning at
// its padded width.
float value_in(int layer, int shift, ivec2 texel) {
    int here = shift == 0 ? 0 : layer;
    ivec2 origin = shift == 0 ? ivec2(0) : map.spread >> shift;
    uint bits = texelFetch(levels, ivec3(origin + texel, here), 0).x;
    return map.is_float ? uintBitsToFloat(bits) : float(int(bits));
}

float highest_at(int shift, ivec2 texel) {
    return value_in(1, shift, texel);
}

ivec2 last_texel(int shift) {
    return map.last >> shift;
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
    return land.corner.xyz + pixel.x * land.across.xyz + pixel.y * land.down.xyz;
}
