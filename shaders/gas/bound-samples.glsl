// The greatest and the least sample among those that a box touches, by the including file's `sample_at`.

// Samples of a box, more of which a driver might end the loop over: then all of the volume stand for them.
const uint MOST_SAMPLES = 30000u;

struct Extremes {
    float least;
    float greatest;
    bool are_known;
};

// Of the samples from `low` on, `size` along each axis, among those of a table of `all`.
Extremes extremes(uint v, ivec3 low, uvec3 size, uvec3 all) {
    Extremes found = Extremes(1.0e30, -1.0e30, false);
    uint count = size.x * size.y * size.z;
    bool is_short = size.x < MOST_SAMPLES && size.y < MOST_SAMPLES && size.z < MOST_SAMPLES
        && float(size.x) * float(size.y) * float(size.z) < float(MOST_SAMPLES);
    uint end = is_short ? count : 0u;
    uint i = 0u;
    for (; i < end; i++) {
        uint row = i / size.x;
        uvec3 at = uvec3(low) + uvec3(i - row * size.x, row % size.y, row / size.y);
        float value = sample_at(v, (at.z * all.y + at.y) * all.x + at.x);
        found.least = min(found.least, value);
        found.greatest = max(found.greatest, value);
    }
    found.are_known = is_short && i == end && end > 0u;
    return found;
}
