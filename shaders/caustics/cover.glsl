// The part of a texel that a triangle covers, by exact area (section 6.3). It joins ranges as the pyramid does.

// Least width of a triangle in texels: a thinner one has no area that can be told from rounding.
const float LEAST_WIDTH = 0.1;

// Widens a triangle that is thinner, along its longest side or where it is a point; its turn and its middle are kept, so that a border
// takes no more light than it gives.
void widen(inout vec2 p, inout vec2 q, inout vec2 r) {
    vec2 to_q = q - p;
    vec2 to_r = r - p;
    float longest = max(dot(to_q, to_q), max(dot(to_r, to_r), dot(r - q, r - q)));
    float twice_area = to_q.x * to_r.y - to_q.y * to_r.x;
    if (twice_area * twice_area >= LEAST_WIDTH * LEAST_WIDTH * longest && longest >= LEAST_WIDTH * LEAST_WIDTH) {
        return;
    }
    vec2 sum = p + q + r;
    // The side from p to q becomes the longest; the three go round as they went.
    for (int i = 0; i < 2; i++) {
        if (dot(q - p, q - p) < longest) {
            vec2 first = p;
            p = q;
            q = r;
            r = first;
        }
    }
    float along = sqrt(longest);
    vec2 direction = along > 1.0e-6 ? (q - p) / along : vec2(1.0, 0.0);
    vec2 across = vec2(-direction.y, direction.x);
    q = p + direction * max(along, LEAST_WIDTH);
    float width = dot(r - p, across);
    r += across * ((width < 0.0 ? min(width, -LEAST_WIDTH) : max(width, LEAST_WIDTH)) - width);
    vec2 back = (sum - (p + q + r)) / 3.0;
    p += back;
    q += back;
    r += back;
}

// Signed, positive for a triangle that turns from x to y.
float area_of(vec2 p, vec2 q, vec2 r) {
    return 0.5 * ((q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x));
}

// The part of a side that lies in a row of texels.
struct Side {
    float left; // x at its left end
    float width; // to its right end
    float down; // how far it goes down, times the light
    float bend; // down / (2 width), 0 for a side that stands
};

Side side_in_row(vec2 a, vec2 b, float y, float light) {
    float rise = b.y - a.y;
    float run = abs(rise) > 1.0e-6 ? (b.x - a.x) / rise : 0.0;
    float from = clamp(a.y, y, y + 1.0);
    float to = clamp(b.y, y, y + 1.0);
    float low = min(a.x, b.x);
    float high = max(a.x, b.x);
    float x_from = clamp(a.x + (from - a.y) * run, low, high);
    float x_to = clamp(a.x + (to - a.y) * run, low, high);
    float width = abs(x_to - x_from);
    float down = (to - from) * light;
    return Side(min(x_from, x_to), width, down, width > 1.0e-4 ? 0.5 * down / width : 0.0);
}

// Signed area between that part and a line down at x, of what lies left of the line.
float left_of(Side side, float x) {
    float within = clamp(x - side.left, 0.0, side.width);
    return within * within * side.bend + max(x - side.left - side.width, 0.0) * side.down;
}

// The sides of a triangle in a row.
struct Row {
    Side p;
    Side q;
    Side r;
};

// The light left of x in the row: of the sign opposite to the area's, where `light` is not divided by it.
float left_of(Row row, float x) {
    return left_of(row.p, x) + left_of(row.q, x) + left_of(row.r, x);
}

// The least and greatest x of the sides that pass a row; the least is above the greatest where none does.
vec2 ends_of(Side side) {
    return side.down != 0.0 ? vec2(side.left, side.left + side.width) : vec2(1.0e6, -1.0e6);
}

vec2 ends_of(Row row) {
    return joined(ends_of(row.p), joined(ends_of(row.q), ends_of(row.r)));
}
