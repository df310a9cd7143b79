// The pixels that a triangle may touch: it is cut at the hither plane and projected, and the box of the pixels around
// it is drawn, so that no pixel is missed however thin the triangle. A box instead of the triangle enlarged by half a
// pixel: its corners are whole pixels, and no sliver can turn inside out; pixels beside the triangle leave the fragment
// stage at once.

#include "gas/frame.glsl"
#include "gas/band.glsl"
#include "gas/mesh.glsl"

struct Footprint {
    vec4 ab; // the polygon's corners, pixels; of a triangle the last two are one
    vec4 cd;
    vec4 box; // pixels; empty where the triangle is not seen
    uint corners; // 3 or 4, and 0 where it is not seen
};

// Offsets from the middle of the picture times depth, and depth.
vec3 to_view(vec3 world) {
    vec3 offset = world - frame.eye;
    return vec3(dot(offset, frame.to_column), dot(offset, frame.to_row), dot(offset, frame.forward));
}

vec2 to_pixel(vec3 p) {
    return 0.5 * vec2(frame.size) + p.xy / p.z;
}

// Always from the end that is seen, so that two triangles cut their common edge at one point.
vec3 cut(vec3 seen, vec3 hidden) {
    float fraction = (frame.hither_m - seen.z) / (hidden.z - seen.z);
    return vec3(mix(seen.xy, hidden.xy, fraction), frame.hither_m);
}

// The corners of what the hither plane leaves of a triangle; none where it lies before it.
Footprint polygon_of(vec3 a, vec3 b, vec3 c) {
    float hither = frame.hither_m;
    bvec3 hidden = bvec3(a.z < hither, b.z < hither, c.z < hither);
    uint count = uint(hidden.x) + uint(hidden.y) + uint(hidden.z);
    // Turned so that one hidden corner is the last, and one seen corner the first.
    bool is_odd = count == 2u;
    bool from_b = is_odd ? !hidden.y : (count == 1u && hidden.x);
    bool from_c = is_odd ? !hidden.z : (count == 1u && hidden.y);
    vec3 p = from_b ? b : (from_c ? c : a);
    vec3 q = from_b ? c : (from_c ? a : b);
    vec3 r = from_b ? a : (from_c ? b : c);
    vec3 second = is_odd ? cut(p, q) : q;
    vec3 third = count == 0u ? r : (count == 1u ? cut(q, r) : cut(p, r));
    vec3 last = count == 1u ? cut(p, r) : third;
    Footprint seen;
    seen.corners = count == 3u ? 0u : (count == 1u ? 4u : 3u);
    seen.ab = vec4(to_pixel(p), to_pixel(second));
    seen.cd = vec4(to_pixel(third), to_pixel(last));
    seen.box = vec4(0.0);
    return seen;
}

// Twice the area of the polygon. Rows go down: of counter-clockwise triangles it is negative.
float signed_area(vec4 ab, vec4 cd) {
    vec2 a = ab.zw - ab.xy;
    vec2 b = cd.xy - ab.xy;
    vec2 c = cd.zw - ab.xy;
    return (a.x * b.y - a.y * b.x) + (b.x * c.y - b.y * c.x);
}

Footprint footprint_of(uint triangle) {
    Triangle drawn = triangle_at(triangle);
    uvec3 corner = drawn.vertices;
    uint object = drawn.object;
    vec3 offset = objects[object].offset_m;
    Footprint seen = polygon_of(to_view(position_of(corner.x) + offset),
        to_view(position_of(corner.y) + offset), to_view(position_of(corner.z) + offset));
    vec2 low = min(min(seen.ab.xy, seen.ab.zw), min(seen.cd.xy, seen.cd.zw));
    vec2 high = max(max(seen.ab.xy, seen.ab.zw), max(seen.cd.xy, seen.cd.zw));
    low = max(floor(low), vec2(0.0, band.first_row));
    high = min(ceil(high), vec2(frame.size.x, band.end_row));
    bool faces_away = objects[object].is_two_sided == 0u && signed_area(seen.ab, seen.cd) >= 0.0;
    if (seen.corners == 0u || !(low.x < high.x) || !(low.y < high.y) || faces_away) {
        seen.corners = 0u;
        return seen;
    }
    seen.box = vec4(low, high);
    return seen;
}

vec2 box_corner(vec4 box, uint index) {
    vec2 pixel = vec2((index & 1u) == 0u ? box.x : box.z, (index & 2u) == 0u ? box.y : box.w);
    return 2.0 * pixel / vec2(frame.size) - 1.0;
}
