// Depth levels of a box (section 4.7.2): equal ones, from the top down.

layout(std430, set = 0, binding = 7) readonly buffer Bounds {
    float list[]; // first height of each level that it no longer holds, metres from the box's centre, and the box's lowest
} bounds;

// The level of a height that the box holds, which is so many levels under the top.
uint level_of(float height, float place, uint count) {
    uint level = min(uint(max(place, 0.0)), count - 1u);
    // The product may round across a boundary; the boundaries decide.
    if (height >= bounds.list[level]) {
        return max(level, 1u) - 1u;
    }
    return height < bounds.list[level + 1u] ? min(level + 1u, count - 1u) : level;
}
