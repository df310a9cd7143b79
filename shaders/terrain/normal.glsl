// The pass `normal` of one pixel: the normal of the surface that the ray met, interpolated at the level that was used, and
// the height there.

layout(set = 0, binding = 2) uniform texture2D depth;

// North is -z, east +x; the map may be turned about the vertical.
vec3 turned(vec3 normal) {
    float c = land.turn.x;
    float s = land.turn.y;
    return vec3(c * normal.x - s * normal.z, normal.y, s * normal.x + c * normal.z);
}

int surface_of(vec4 hit) {
    return int(hit.w) & 7;
}

// Whether this map's pass answers for the pixel.
bool is_ours(vec4 hit) {
    return int(hit.w) >> 8 == int(land.turn.w);
}

vec4 normal_of(ivec2 pixel, vec4 hit) {
    int surface = surface_of(hit);
    int shift = (int(hit.w) >> 3) & 31;
    vec3 direction = land.corner.xyz + float(pixel.x) * land.across.xyz + float(pixel.y) * land.down.xyz;
    Cell cell = cell_at(shift, hit.yz);
    vec2 slope = vec2(mix(cell.corners.y - cell.corners.x, cell.corners.w - cell.corners.z, cell.part.y),
                      mix(cell.corners.z - cell.corners.x, cell.corners.w - cell.corners.y, cell.part.x));
    slope *= exp2(-float(shift)) * land.bounds.w / land.margin.zw;
    vec3 normal = vec3(0.0, 1.0, 0.0);
    if (surface == TERRAIN) {
        normal = vec3(-slope.x, 1.0, -slope.y);
    }
    if (surface == WALL_WEST || surface == WALL_EAST) {
        normal = vec3(surface == WALL_EAST ? 1.0 : -1.0, 0.0, 0.0);
    }
    if (surface == WALL_NORTH || surface == WALL_SOUTH) {
        normal = vec3(0.0, 0.0, surface == WALL_SOUTH ? 1.0 : -1.0);
    }
    if (surface == INSIDE) {
        normal = -direction * vec3(land.margin.z, land.margin.w, land.bounds.w);
        normal = normal.xzy;
    }
    float above_base_m = (land.eye.z + hit.x * direction.z - land.bounds.z) * land.bounds.w;
    if (surface == SKY) {
        above_base_m = 0.0;
    }
    return vec4(turned(normalize(normal)), above_base_m);
}
