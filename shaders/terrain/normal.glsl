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

// The slopes of a cell's nodes, interpolated: without the steps that those of a bilinear surface have at a cell's borders. The
// paper's eq. 7 has those steps; where a cell is larger than a pixel they are seen. A node's slope is that of the line through its
// neighbours, of the line to the only one at a border: twelve nodes for all four.
vec2 slope_between_nodes(int shift, vec2 place) {
    vec4 cell = cell_at(shift, place);
    ivec2 a = ivec2(cell.xy);
    ivec2 b = min(a + 1, last_texel(shift));
    ivec2 low = max(a - 1, ivec2(0));
    ivec2 high = min(b + 1, last_texel(shift));
    vec4 at = vec4(highest_at(shift, a), highest_at(shift, ivec2(b.x, a.y)), highest_at(shift, ivec2(a.x, b.y)),
                   highest_at(shift, b));
    vec2 west = vec2(highest_at(shift, ivec2(low.x, a.y)), highest_at(shift, ivec2(low.x, b.y)));
    vec2 east = vec2(highest_at(shift, ivec2(high.x, a.y)), highest_at(shift, ivec2(high.x, b.y)));
    vec2 north = vec2(highest_at(shift, ivec2(a.x, low.y)), highest_at(shift, ivec2(b.x, low.y)));
    vec2 south = vec2(highest_at(shift, ivec2(a.x, high.y)), highest_at(shift, ivec2(b.x, high.y)));
    vec2 to_a = vec2(max(b - low, ivec2(1)));
    vec2 to_b = vec2(max(high - a, ivec2(1)));
    vec2 north_west = vec2(at.y - west.x, at.z - north.x) / to_a;
    vec2 north_east = vec2(east.x - at.x, at.w - north.y) / vec2(to_b.x, to_a.y);
    vec2 south_west = vec2(at.w - west.y, south.x - at.x) / vec2(to_a.x, to_b.y);
    vec2 south_east = vec2(east.y - at.z, south.y - at.y) / to_b;
    return mix(mix(north_west, north_east, cell.z), mix(south_west, south_east, cell.z), cell.w);
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
