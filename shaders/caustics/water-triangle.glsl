// A triangle of the refined water (section 6.3).

layout(std430, set = 0, binding = 4) readonly buffer Rays {
    Ray list[];
} rays;

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

// Invocations of each pass whose loops the driver left before their end, of all frames since the host last looked.
layout(std430, set = 0, binding = 9) buffer Unfinished {
    uint land;
    uint straddle;
} unfinished;

// The area vector in texels of the map, on the upper side.
vec3 face_of(Ray a, Ray b, Ray c) {
    vec3 face = 0.5 * cross(b.origin - a.origin, c.origin - a.origin);
    return face * (sign(dot(face, plane.up)) / plane.texel_area_m2);
}

// The least and greatest height that a beam may meet; the least is above the greatest where it meets nothing.
vec2 heights_met(Ray a, Ray b, Ray c) {
    float size = float(plane.map_size);
    float top = min(plane.half_height, max(a.origin.y, max(b.origin.y, c.origin.y)) - plane.middle);
    float bottom = -plane.half_height;
    for (int i = 0; i < 2; i++) {
        vec2 top_a = place_at(a.origin, a.slope, top);
        vec2 top_b = place_at(b.origin, b.slope, top);
        vec2 top_c = place_at(c.origin, c.slope, top);
        vec2 end_a = place_at(a.origin, a.slope, bottom);
        vec2 end_b = place_at(b.origin, b.slope, bottom);
        vec2 end_c = place_at(c.origin, c.slope, bottom);
        vec2 first = min(min(top_a, min(top_b, top_c)), min(end_a, min(end_b, end_c)));
        vec2 last = max(max(top_a, max(top_b, top_c)), max(end_a, max(end_b, end_c)));
        if (any(greaterThanEqual(first, vec2(size))) || any(lessThan(last, vec2(0.0)))) {
            return vec2(1.0, -1.0);
        }
        vec2 range = heights_within(first, last);
        top = min(top, range.y);
        bottom = max(bottom, range.x);
        if (top < bottom) {
            return vec2(1.0, -1.0);
        }
    }
    return vec2(bottom, top);
}
