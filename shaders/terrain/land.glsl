// The map and how the camera sees it: eq. 9 to 11. Heights are the map's own numbers (16-bit steps or metres), which the
// host's matrix accounts for, so that no texel needs decoding on the way.

layout(set = 0, binding = 0, std140) uniform Land {
    vec4 eye; // u and v in nodes, h; nodes that a pixel covers at a depth of 1 m
    vec4 corner; // direction to the middle of pixel (0, 0), for 1 m of depth
    vec4 across; // its change from a pixel to the next on the right
    vec4 down; // and to the next below
    vec4 bounds; // lowest and highest height; height of the base; metres for a unit of height
    vec4 margin; // what rounding may have cost: nodes, height; metres between columns and rows
    vec4 turn; // cosine and sine of the map's turn about the vertical; near plane of what is rasterised; the map's number
    ivec4 size; // columns, rows, the number of levels above the data, 2 to that power
    ivec4 form; // axis along which the levels lie (0, 1); whether texels are bits of floats; unused
} land;

layout(set = 0, binding = 1) uniform utexture2DArray levels;

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
    float surface; // which surface + 8 x level + 256 x map
};

Hit miss() {
    return Hit(NO_DEPTH, vec2(0.0), float(SKY));
}

float surface_code(int surface, int shift) {
    return float(surface + 8 * shift) + 256.0 * land.turn.w;
}

// The value of a texel `shift` levels above the data. Layer 0 holds the data, `layer` the coarser levels, each beginning at
// its padded width.
float value_in(int layer, int shift, ivec2 texel) {
    int here = shift == 0 ? 0 : layer;
    ivec2 origin = land.form.xy * (shift == 0 ? 0 : land.size.w >> shift);
    uint bits = texelFetch(levels, ivec3(origin + texel, here), 0).x;
    return land.form.z != 0 ? uintBitsToFloat(bits) : float(bits);
}

float highest_at(int shift, ivec2 texel) {
    return value_in(1, shift, texel);
}

ivec2 last_texel(int shift) {
    return (land.size.xy - 1) >> shift;
}

// A cell of a level: its four corner values and where the place lies in it, 0 to 1.
struct Cell {
    vec4 corners; // north-west, north-east, south-west, south-east
    vec2 corner; // the north-west corner, texels of the level
    vec2 part;
};

// The cell around a place in nodes. A coarser level's texel stands in the middle of the nodes that it covers.
Cell cell_at(int shift, vec2 place) {
    float size = exp2(-float(shift));
    vec2 texel = clamp(place * size + (0.5 * size - 0.5), vec2(0.0), vec2(last_texel(shift)));
    ivec2 a = min(ivec2(texel), max(last_texel(shift) - 1, 0));
    ivec2 b = min(a + 1, last_texel(shift));
    vec4 corners = vec4(highest_at(shift, a), highest_at(shift, ivec2(b.x, a.y)), highest_at(shift, ivec2(a.x, b.y)),
                        highest_at(shift, b));
    return Cell(corners, vec2(a), texel - vec2(a));
}

// Eq. 7.
float bilinear(Cell cell) {
    vec2 ends = mix(cell.corners.xz, cell.corners.yw, cell.part.x);
    return mix(ends.x, ends.y, cell.part.y);
}
