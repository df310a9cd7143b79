// Bricks, which the box around each volume is divided into, `counts.bricks` along each axis. Each has the greatest density
// inside it, or 0 where a ray loses nothing that shows by leaving it out (bricks.comp).

layout(set = 0, binding = 30, std430) readonly buffer Bricks {
    float brick_bounds[]; // a table a volume; x runs fastest
};

uint brick_at(uint v, ivec3 brick) {
    int n = int(brick_count);
    return uint(((int(v) * n + brick.z) * n + brick.y) * n + brick.x);
}

// From metres off the volume's middle to bricks.
vec3 bricks_a_metre() {
    return 0.5 * float(brick_count) / in_hand.half_extent_m;
}

// The brick of a position that is counted in bricks; outside the box the nearest one.
ivec3 brick_of(vec3 at) {
    return clamp(ivec3(floor(at)), ivec3(0), ivec3(int(brick_count) - 1));
}

// Along one axis, where a way of `along` bricks a metre leaves the brick.
float way_out(float at, int brick, float along) {
    if (abs(along) < 1.0e-12) {
        return 1.0e30;
    }
    return (float(along > 0.0 ? brick + 1 : brick) - at) / along;
}

// Metres to the end of the brick that a point is in.
float way_through(ivec3 brick, vec3 at, vec3 along) {
    return min(way_out(at.x, brick.x, along.x), min(way_out(at.y, brick.y, along.y), way_out(at.z, brick.z, along.z)));
}
