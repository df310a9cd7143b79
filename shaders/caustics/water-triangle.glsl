// A triangle of the refined water (section 6.3).

layout(std430, set = 0, binding = 7) readonly buffer Indices {
    uint list[]; // three a water triangle
} indices;

// A triangle of the water that does not land whole, and the least and greatest height that its light may meet, of box space.
struct Straddler {
    uint triangle;
    float bottom;
    float top;
};

layout(std430, set = 0, binding = 8) buffer Straddling {
    uint count;
    Straddler list[];
} straddling;

// The area vector in texels of the map, on the upper side.
vec3 face_of(Ray a, Ray b, Ray c) {
    vec3 face = 0.5 * cross(b.origin - a.origin, c.origin - a.origin);
    return face * (sign(dot(face, plane.up)) / plane.texel_area_m2);
}

// The places of four rays at a height, and between which they lie.
void around(Ray a, Ray b, Ray c, Ray d, float height, inout vec2 low, inout vec2 high) {
    vec2 at_a = place_at(a.origin, a.slope, height);
    vec2 at_b = place_at(b.origin, b.slope, height);
    vec2 at_c = place_at(c.origin, c.slope, height);
    vec2 at_d = place_at(d.origin, d.slope, height);
    low = min(low, min(min(at_a, at_b), min(at_c, at_d)));
    high = max(high, max(max(at_a, at_b), max(at_c, at_d)));
}

// The least and greatest height that the beam of a cell may meet; the least is above the greatest where it meets nothing.
vec2 heights_met(Ray a, Ray b, Ray c, Ray d) {
    float size = float(plane.map_size);
    float top = min(plane.half_height, max(max(a.origin.y, b.origin.y), max(c.origin.y, d.origin.y)) - plane.middle);
    float bottom = -plane.half_height;
    for (int i = 0; i < 2; i++) {
        vec2 low = vec2(1.0e30);
        vec2 high = vec2(-1.0e30);
        around(a, b, c, d, top, low, high);
        around(a, b, c, d, bottom, low, high);
        if (any(greaterThanEqual(low, vec2(size))) || any(lessThan(high, vec2(0.0)))) {
            return vec2(1.0, -1.0);
        }
        vec2 range = heights_within(low, high);
        top = min(top, range.y);
        bottom = max(bottom, least_near(range));
        if (top < bottom) {
            return vec2(1.0, -1.0);
        }
    }
    return vec2(bottom, top);
}
