// The solid of the volume in hand, cut by lines.

const uint BOX = 0u;
const uint SPHERE = 1u;
const uint FRUSTUM = 2u;
const vec2 EMPTY_SEGMENT = vec2(1.0, -1.0);

// Where the line is inside |p| <= 1 along one axis.
vec2 slab_segment(float origin, float direction) {
    if (abs(direction) < 1.0e-12) {
        return abs(origin) <= 1.0 ? vec2(-1.0e30, 1.0e30) : EMPTY_SEGMENT;
    }
    float a = (-1.0 - origin) / direction;
    float b = (1.0 - origin) / direction;
    return vec2(min(a, b), max(a, b));
}

vec2 intersect(vec2 a, vec2 b) {
    return vec2(max(a.x, b.x), min(a.y, b.y));
}

vec2 box_segment(vec3 origin, vec3 direction) {
    vec2 xy = intersect(slab_segment(origin.x, direction.x), slab_segment(origin.y, direction.y));
    return intersect(xy, slab_segment(origin.z, direction.z));
}

// Where a t^2 + 2 b t + c <= 0 for a > 0.
vec2 quadratic_segment(float a, float b, float c) {
    float under = b * b - a * c;
    if (under < 0.0) {
        return EMPTY_SEGMENT;
    }
    // The root of larger size first: the other has no cancellation then.
    float q = -(b + (b >= 0.0 ? sqrt(under) : -sqrt(under)));
    float first = q / a;
    float second = q != 0.0 ? c / q : first;
    return vec2(min(first, second), max(first, second));
}

// x^2 + z^2 <= (m + n y)^2 between y = -1 and 1, where m + n y is not negative.
vec2 frustum_segment(vec3 o, vec3 d, vec2 radii) {
    vec2 slab = slab_segment(o.y, d.y);
    if (slab.x > slab.y) {
        return EMPTY_SEGMENT;
    }
    float n = 0.5 * (radii.y - radii.x);
    float radius = 0.5 * (radii.x + radii.y) + n * o.y; // at the origin
    float slope = n * d.y;
    float a = dot(d.xz, d.xz) - slope * slope;
    float b = dot(o.xz, d.xz) - radius * slope;
    float c = dot(o.xz, o.xz) - radius * radius;
    // Along the side of the cone, whatever the unit of length.
    float all = dot(d.xz, d.xz) + slope * slope;
    if (abs(a) <= 1.0e-7 * all) {
        if (abs(b) <= 1.0e-7 * sqrt(all)) {
            return c <= 0.0 ? slab : EMPTY_SEGMENT;
        }
        float t = -0.5 * c / b;
        return intersect(slab, b > 0.0 ? vec2(-1.0e30, t) : vec2(t, 1.0e30));
    }
    if (a > 0.0) {
        return intersect(slab, quadratic_segment(a, b, c));
    }
    // Steeper than the cone: inside before the first root and after the second, of which the slab holds one.
    vec2 outside = quadratic_segment(-a, -b, -c);
    if (outside.x > outside.y) {
        return slab;
    }
    vec2 before = intersect(slab, vec2(-1.0e30, outside.x));
    return before.x < before.y ? before : intersect(slab, vec2(outside.y, 1.0e30));
}

// Where the line origin + t direction is inside the solid; empty (x > y) where it misses it.
vec2 volume_segment(vec3 origin, vec3 direction) {
    vec3 scale = 1.0 / in_hand.half_extent_m;
    vec3 o = (origin - in_hand.center) * scale;
    vec3 d = direction * scale;
    uint shape = in_hand.shape;
    if (shape == BOX) {
        return box_segment(o, d);
    }
    if (shape == SPHERE) {
        return quadratic_segment(dot(d, d), dot(o, d), dot(o, o) - 1.0);
    }
    return frustum_segment(o, d, in_hand.radii);
}

// Where the line is inside the box around the solid, which is the box of its tables.
vec2 bounds_segment(vec3 origin, vec3 direction) {
    vec3 scale = 1.0 / in_hand.half_extent_m;
    return box_segment((origin - in_hand.center) * scale, direction * scale);
}

// How far inside the solid a point is: 0 on the boundary, 1 in the middle, negative outside.
float inwardness(vec3 point) {
    vec3 q = (point - in_hand.center) / in_hand.half_extent_m;
    uint shape = in_hand.shape;
    if (shape == BOX) {
        vec3 inside = 1.0 - abs(q);
        return min(inside.x, min(inside.y, inside.z));
    }
    if (shape == SPHERE) {
        return 1.0 - length(q);
    }
    vec2 radii = in_hand.radii;
    float radius = mix(radii.x, radii.y, clamp(0.5 * q.y + 0.5, 0.0, 1.0));
    return min(1.0 - abs(q.y), radius - length(q.xz));
}
