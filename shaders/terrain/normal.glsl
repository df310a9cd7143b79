// The pass `normal` of one pixel: the normal of the surface that the ray met, interpolated at the level that was used, and
// the height there above the base in metres.

layout(set = 0, binding = 2) uniform texture2D depth;

#include "terrain/geodesy.glsl"

// Whether this map's pass answers for the pixel.
bool is_ours(vec4 hit) {
    return ((int(hit.w) >> 8) & 15) == terrain.map_index;
}

// East, up and south where the map is at `place`, as directions of the map's frame, and metres between nodes there.
struct Local {
    vec3 east;
    vec3 up;
    vec3 south;
    vec2 spacing_m;
};

Local local_at(vec2 place, float height_m) {
    Local local = Local(vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0), vec3(0.0, 0.0, 1.0), terrain.spacing_m);
    float away = max(abs(place.x), abs(place.y));
    if (!is_kind(terrain.base_kind, PLANE, away)) {
        float half_longitude = 0.5 * (place.x - terrain.middle_node.x) / terrain.nodes_per_unit.x;
        float s = 2.0 * sine(half_longitude) * cosine(half_longitude);
        float c = 1.0 - 2.0 * sine(half_longitude) * sine(half_longitude);
        local.east = vec3(c, -s, 0.0);
        local.up = vec3(s, c, 0.0);
        float across_m = (terrain.axis_distance_m + height_m) / terrain.nodes_per_unit.x;
        local.spacing_m = vec2(across_m, 1.0 / abs(terrain.nodes_per_unit.y));
        if (!is_kind(terrain.base_kind, CYLINDER, away)) {
            Meridian foot = meridian_at((place.y - terrain.middle_node.y) / terrain.nodes_per_unit.y);
            local.up = vec3(foot.c * s, foot.c * c, foot.s);
            local.south = vec3(foot.s * s, foot.s * c, -foot.c);
            vec2 radii = vec2((foot.cross_radius + height_m) * max(foot.c, 1.0e-6), foot.radius + height_m);
            local.spacing_m = radii / abs(terrain.nodes_per_unit);
        }
    }
    return local;
}

// The slope at a node of a level: that of the line through its neighbours, of the line to the only one at a border.
vec2 slope_at_node(int shift, ivec2 node) {
    ivec2 low = max(node - 1, ivec2(0));
    ivec2 high = min(node + 1, last_texel(shift));
    vec2 rise = vec2(highest_at(shift, ivec2(high.x, node.y)) - highest_at(shift, ivec2(low.x, node.y)),
                     highest_at(shift, ivec2(node.x, high.y)) - highest_at(shift, ivec2(node.x, low.y)));
    return rise / vec2(max(high - low, ivec2(1)));
}

// The slopes of a cell's nodes, interpolated: without the steps that those of a bilinear surface have at a cell's borders. The
// paper's eq. 7 has those steps; where a cell is larger than a pixel they are seen.
vec2 slope_between_nodes(int shift, vec2 place) {
    vec4 cell = cell_at(shift, place);
    ivec2 a = ivec2(cell.xy);
    ivec2 b = min(a + 1, last_texel(shift));
    vec2 north = mix(slope_at_node(shift, a), slope_at_node(shift, ivec2(b.x, a.y)), cell.z);
    vec2 south = mix(slope_at_node(shift, ivec2(a.x, b.y)), slope_at_node(shift, b), cell.z);
    return mix(north, south, cell.w);
}

vec4 normal_of(ivec2 pixel, vec4 hit) {
    read_map();
    int surface = int(hit.w) & 7;
    int shift = (int(hit.w) >> 3) & 31;
    float height_m = (height_at(shift, hit.yz) - terrain.base_height) * terrain.height_unit_m;
    Local local = local_at(hit.yz, height_m);
    vec3 direction = direction_of(vec2(pixel));
    vec3 normal = local.up;
    if (surface == TERRAIN) {
        vec2 slope = slope_at(shift, hit.yz);
        if (hit.x * map.pixel < terrain.node_normals_below) {
            slope = slope_between_nodes(shift, hit.yz);
        }
        slope *= exp2(-float(shift)) * terrain.height_unit_m / local.spacing_m;
        normal = local.up - slope.x * local.east - slope.y * local.south;
    }
    if (surface == WALL_WEST || surface == WALL_EAST) {
        normal = surface == WALL_EAST ? local.east : -local.east;
    }
    if (surface == WALL_NORTH || surface == WALL_SOUTH) {
        normal = surface == WALL_SOUTH ? local.south : -local.south;
    }
    if (surface == INSIDE) {
        vec3 scale_m = vec3(terrain.spacing_m, terrain.height_unit_m);
        normal = terrain.base_kind == PLANE ? -(direction * scale_m).xzy : -direction;
    }
    vec3 turned = normal.x * terrain.east + normal.y * terrain.up + normal.z * terrain.south;
    return vec4(normalize(turned), surface <= BASE ? 0.0 : height_m);
}
