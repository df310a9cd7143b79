// The pixels that a triangle may touch: it is cut at the hither plane and projected, and the box of the pixels around
// it is drawn, so that no pixel is missed however thin the triangle. A box instead of the triangle enlarged by half a
// pixel: its corners are whole pixels, and no sliver can turn inside out; pixels beside the triangle leave the fragment
// stage at once.

#include "gas/frame.glsl"
#include "gas/band.glsl"
#include "gas/mesh.glsl"

struct Footprint {
    vec4 ab; // the polygon's corners, pixels
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

Footprint footprint_of(uint triangle) {
    uvec3 corner = triangles[triangle].vertices;
    uint object = triangles[triangle].object;
    vec3 offset = objects[object].offset_m;
    vec3 points[3];
    points[0] = to_view(vertices[corner.x].position + offset);
    points[1] = to_view(vertices[corner.y].position + offset);
    points[2] = to_view(vertices[corner.z].position + offset);
    float hither = frame.hither_m;
    vec2 polygon[4];
    uint count = 0u;
    for (uint i = 0u; i < 3u; i++) {
        vec3 from = points[i];
        vec3 to = points[i == 2u ? 0u : i + 1u];
        if (from.z >= hither) {
            polygon[count] = to_pixel(from);
            count++;
            if (to.z < hither) {
                polygon[count] = to_pixel(cut(from, to));
                count++;
            }
        } else if (to.z >= hither) {
            polygon[count] = to_pixel(cut(to, from));
            count++;
        }
    }
    Footprint seen;
    seen.corners = 0u;
    seen.ab = vec4(0.0);
    seen.cd = vec4(0.0);
    seen.box = vec4(0.0);
    if (count < 3u) {
        return seen;
    }
    vec2 low = min(polygon[0], min(polygon[1], polygon[2]));
    vec2 high = max(polygon[0], max(polygon[1], polygon[2]));
    vec2 last = polygon[2];
    if (count == 4u) {
        last = polygon[3];
        low = min(low, last);
        high = max(high, last);
    }
    low = max(floor(low), vec2(0.0, band.first_row));
    high = min(ceil(high), vec2(frame.size.x, band.end_row));
    bool faces_away = false;
    if (objects[object].is_two_sided == 0u) {
        vec2 a = polygon[1] - polygon[0];
        vec2 b = polygon[2] - polygon[0];
        vec2 c = last - polygon[0];
        // Rows go down: counter-clockwise triangles have negative areas.
        faces_away = a.x * b.y - a.y * b.x + b.x * c.y - b.y * c.x >= 0.0;
    }
    if (low.x >= high.x || low.y >= high.y || faces_away) {
        return seen;
    }
    seen.corners = count;
    seen.ab = vec4(polygon[0], polygon[1]);
    seen.cd = vec4(polygon[2], last);
    seen.box = vec4(low, high);
    return seen;
}

vec2 box_corner(vec4 box, uint index) {
    vec2 pixel = vec2((index & 1u) == 0u ? box.x : box.z, (index & 2u) == 0u ? box.y : box.w);
    return 2.0 * pixel / vec2(frame.size) - 1.0;
}
