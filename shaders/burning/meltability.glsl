// epsilon of the edges (table 3.1), by the corner of a finest triangle that they begin at. Where all have the same there
// is one number.

layout(set = 0, binding = 79, std430) readonly buffer Meltabilities {
    float meltabilities[];
};

// The sum of those of the two edges that meet in a corner of a triangle.
float meltabilities_at(uint triangle, uint corner) {
    uint after = 3u * triangle + corner;
    uint before = 3u * triangle + (corner + 2u) % 3u;
    return meltabilities[after * constants.level_stride] + meltabilities[before * constants.level_stride];
}
