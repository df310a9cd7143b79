// Stretches of particles over the whole height of a column of cells. One that is too long for a loop is narrowed to the
// cells near a height, by a reach beyond which particles do not count.

// True where particles that count were left out: too many are within that reach as well.
bool is_crowded = false;
// True where a stretch was narrowed.
bool is_narrowed = false;

uvec2 stretch_near(ivec2 cell, ivec2 aside, float height_m, float reach_m, uint most) {
    int highest = int(flow.counts.y) - 1;
    uvec2 stretch = stretch_of(cell, aside, 0, highest);
    if (stretch.y - stretch.x > most) {
        is_narrowed = true;
        int low = cell_of(vec3(0.0, max(height_m - reach_m, 0.0), 0.0)).y;
        int high = cell_of(vec3(0.0, max(height_m + reach_m, 0.0), 0.0)).y;
        stretch = stretch_of(cell, aside, min(low, highest), min(high, highest));
    }
    // Of too many the highest.
    uint first = max(stretch.x, max(stretch.y, most) - most);
    is_crowded = is_crowded || first > stretch.x;
    return uvec2(first, stretch.y);
}
