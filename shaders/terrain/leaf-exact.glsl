// `--lod exact`: the last segment crosses at most three cells of the data; in each the bilinear surface (eq. 7) along the
// ray is a quadratic, solved stably.

int finest_shift(float depth_m) {
    return 0;
}

float surface_at(int shift, vec2 place) {
    return bilinear(cell_at(0, place));
}

bool is_leaf(Segment segment, int shift) {
    return shift == 0;
}

// Where a line that moves by `way` from `from` inside a cell first touches the cell's surface, as a part of `way`; -1
// where it does not.
float touch(Cell cell, vec3 from, vec3 way) {
    float a = cell.corners.x;
    float b = cell.corners.y - a;
    float c = cell.corners.z - a;
    float e = cell.corners.w - cell.corners.y - c;
    float qa = -e * way.x * way.y;
    float qb = way.z - b * way.x - c * way.y - e * (from.x * way.y + from.y * way.x);
    float qc = from.z - (a + b * from.x + c * from.y + e * from.x * from.y);
    float discriminant = qb * qb - 4.0 * qa * qc;
    float root = sqrt(max(discriminant, 0.0));
    // The smaller positive root of a function that begins above zero, without cancellation.
    float denominator = qb < 0.0 ? root - qb : -2.0 * qa;
    float numerator = qb < 0.0 ? 2.0 * qc : qb + root;
    float part = numerator / (denominator > 0.0 ? denominator : 1.0);
    bool is_met = discriminant >= 0.0 && denominator > 0.0 && part <= 1.0;
    if (qc <= 0.0) {
        part = 0.0;
    }
    if (qc > 0.0 && !is_met) {
        part = qa + qb + qc <= 0.0 ? 1.0 : -1.0;
    }
    return part;
}

// The part of the segment at which a coordinate crosses a border between cells; 1 where it crosses none.
float crossing(float from, float to) {
    float border = max(floor(from), floor(to));
    bool crosses = floor(from) != floor(to) && from != to;
    return crosses ? clamp((border - from) / (to - from), 0.0, 1.0) : 1.0;
}

float intersect(Segment segment) {
    vec3 whole = segment.far - segment.near;
    float u = crossing(segment.near.x, segment.far.x);
    float v = crossing(segment.near.y, segment.far.y);
    float ends[4] = float[4](0.0, min(u, v), max(u, v), 1.0);
    float result = -1.0;
    for (int i = 0; i < 3; i++) {
        float size = ends[i + 1] - ends[i];
        if (result < 0.0 && size > 0.0) {
            vec3 from = segment.near + ends[i] * whole;
            Cell cell = cell_at(0, from.xy + 0.5 * size * whole.xy);
            float part = touch(cell, vec3(from.xy - cell.corner, from.z), size * whole);
            result = part >= 0.0 ? ends[i] + part * size : -1.0;
        }
    }
    return result;
}
