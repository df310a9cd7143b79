#version 450

// Section "Combining A-buffer and volume rendering techniques" and reference 2 (Carpenter): what a triangle leaves in a
// pixel. Coverage is the area of the triangle inside the pixel, cut exactly; the mask has a bit for each of 4 x 8
// sub-pixels whose centre lies inside. Both come from the triangle's edges, not from the rasteriser's samples. A sliver
// that misses every centre takes the nearest sub-pixel at the opacity of its coverage. Depths are those of the corners
// of the piece inside the pixel; the text's light attenuations are a buffer of their own, filled for visible fragments
// by light-attenuation.

#include "gas/frame.glsl"
#include "gas/counts.glsl"
#include "gas/band.glsl"
#include "gas/mesh.glsl"
#include "gas/loops.glsl"
#include "gas/volume.glsl"
#include "gas/density.glsl"
#include "gas/lists.glsl"

layout(set = 0, binding = 7, std430) buffer Heads {
    uint heads[]; // of each pixel's list
};

layout(set = 0, binding = 8, std430) buffer Links {
    Link links[];
};

layout(set = 0, binding = 9, std430) buffer Surfaces {
    Surface surfaces[];
};

layout(set = 0, binding = 10, std430) buffer Colors {
    Color colors[];
};

layout(set = 0, binding = 11, std430) buffer Counters {
    uint fragment_count; // that the band wants, beyond the capacity as well
    uint section_count;
    uint most_fragments; // in a band before
    uint most_sections;
};

layout(location = 0) flat in vec4 corners_ab;
layout(location = 1) flat in vec4 corners_cd;
layout(location = 2) flat in uvec2 identity; // triangle, number of corners

const uint FULL = 0xffffffffu;

vec2 corner_of(uint index) {
    if (index == 0u) {
        return corners_ab.xy;
    }
    if (index == 1u) {
        return corners_ab.zw;
    }
    return index == 2u ? corners_cd.xy : corners_cd.zw;
}

// Twice the area of edge and point, positive on the left of from -> to. It is computed in one direction for both
// triangles of an edge, so that a point is inside exactly one of them.
float side_of(vec2 low, vec2 high, vec2 point) {
    vec2 edge = high - low;
    vec2 offset = point - low;
    return edge.x * offset.y - edge.y * offset.x;
}

// Mean of y between 0 and 1 along a straight line from y0 to y1.
float mean_within(float y0, float y1) {
    float low = min(y0, y1);
    float high = max(y0, y1);
    if (low >= 1.0) {
        return 1.0;
    }
    if (high <= 0.0) {
        return 0.0;
    }
    float first = max(low, 0.0);
    float last = min(high, 1.0);
    float length = high - low;
    if (length < 1.0e-6) {
        return last;
    }
    return (max(high - 1.0, 0.0) + (last - first) * 0.5 * (first + last)) / length;
}

// Area between an edge and the side y = 0, inside the pixel; positive for edges to the left.
float area_under(vec2 from, vec2 to) {
    float x0 = clamp(from.x, 0.0, 1.0);
    float x1 = clamp(to.x, 0.0, 1.0);
    if (x0 == x1) {
        return 0.0;
    }
    float slope = (to.y - from.y) / (to.x - from.x);
    return (x0 - x1) * mean_within(from.y + (x0 - from.x) * slope, from.y + (x1 - from.x) * slope);
}

// The segment of an edge that lies inside the pixel, as fractions of the edge; empty (x > y) where none does.
vec2 segment_inside(vec2 from, vec2 to) {
    vec2 edge = to - from;
    vec2 segment = vec2(0.0, 1.0);
    for (uint axis = 0u; axis < 2u; axis++) {
        float start = axis == 0u ? from.x : from.y;
        float along = axis == 0u ? edge.x : edge.y;
        if (abs(along) < 1.0e-12) {
            if (start < 0.0 || start > 1.0) {
                return vec2(1.0, 0.0);
            }
        } else {
            float a = -start / along;
            float b = (1.0 - start) / along;
            segment = vec2(max(segment.x, min(a, b)), min(segment.y, max(a, b)));
        }
    }
    return segment;
}

// Depth under a place of the picture: where its ray meets the triangle's plane, but no nearer or farther than its
// corners.
float depth_at(vec2 pixel, vec3 normal, float height, vec2 range) {
    float slope = dot(normal, ray_direction(pixel));
    float depth = abs(slope) > 1.0e-12 ? height / slope : range.x;
    return clamp(depth, range.x, range.y);
}

// Where the ray of a place of the picture meets the triangle's plane, from the eye.
vec3 in_plane(vec2 pixel, vec3 normal, float height) {
    vec3 ray = ray_direction(pixel);
    float slope = dot(normal, ray);
    return abs(slope) > 1.0e-12 ? ray * (height / slope) : ray * frame.yon_m;
}

// Mean of 1 in even and -1 in odd intervals of length 1, over a width around a place.
float mean_side(float place, float width) {
    float side = mod(floor(place), 2.0) < 0.5 ? 1.0 : -1.0;
    // Its integral goes up and down between 0 and 1.
    float low = 1.0 - abs(mod(place - 0.5 * width, 2.0) - 1.0);
    float high = 1.0 - abs(mod(place + 0.5 * width, 2.0) - 1.0);
    return width < 1.0e-3 ? side : clamp((high - low) / width, -1.0, 1.0);
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec2 origin = vec2(pixel);
    uint count = identity.y;
    float signed_area = 0.0;
    for (uint i = 1u; i + 1u < count; i++) {
        vec2 a = corner_of(i) - corner_of(0u);
        vec2 b = corner_of(i + 1u) - corner_of(0u);
        signed_area += a.x * b.y - a.y * b.x;
    }

    // Mask, and the distances of the pixel's corners from the nearest edge.
    uint mask = FULL;
    vec4 corners_inside = vec4(1.0);
    for (uint i = 0u; i < count; i++) {
        vec2 a = corner_of(i) - origin;
        vec2 b = corner_of(i + 1u == count ? 0u : i + 1u) - origin;
        bool forwards = a.x < b.x || (a.x == b.x && a.y < b.y);
        vec2 low = forwards ? a : b;
        vec2 high = forwards ? b : a;
        float inwards = forwards == (signed_area >= 0.0) ? 1.0 : -1.0;
        vec4 sides = inwards * vec4(side_of(low, high, vec2(0.0, 0.0)), side_of(low, high, vec2(1.0, 0.0)),
            side_of(low, high, vec2(0.0, 1.0)), side_of(low, high, vec2(1.0, 1.0)));
        if (max(max(sides.x, sides.y), max(sides.z, sides.w)) < 0.0) {
            return; // the pixel lies beside this edge
        }
        corners_inside = min(corners_inside, sides);
        if (min(min(sides.x, sides.y), min(sides.z, sides.w)) <= 0.0) {
            uint inside = 0u;
            for (uint bit = 0u; bit < 32u; bit++) {
                vec2 point = vec2((float(bit & 3u) + 0.5) / 4.0, (float(bit >> 2u) + 0.5) / 8.0);
                float side = inwards * side_of(low, high, point);
                // A point on the edge belongs to the triangle on one side of it.
                if (side > 0.0 || (side == 0.0 && inwards > 0.0)) {
                    inside |= 1u << bit;
                }
            }
            mask &= inside;
        }
    }
    bool is_full = min(min(corners_inside.x, corners_inside.y), min(corners_inside.z, corners_inside.w)) > 0.0;

    uvec3 corner = triangles[identity.x].vertices;
    uint object_index = triangles[identity.x].object;
    Object object = objects[object_index];
    vec3 eye = frame.eye - object.offset_m; // in the object's space
    vec3 p0 = vertices[corner.x].position;
    vec3 p1 = vertices[corner.y].position;
    vec3 p2 = vertices[corner.z].position;
    vec3 facing = cross(p1 - p0, p2 - p0);
    vec3 depths = vec3(dot(p0 - eye, frame.forward), dot(p1 - eye, frame.forward), dot(p2 - eye, frame.forward));
    vec2 range = vec2(min(depths.x, min(depths.y, depths.z)), max(depths.x, max(depths.y, depths.z)));
    range = max(range, vec2(frame.hither_m));
    float height = dot(facing, p0 - eye);

    // The piece inside the pixel: its corners are those of the pixel that are inside, and the ends of the edges'
    // segments in it.
    float near = 1.0e30;
    float far = 0.0;
    vec2 center = vec2(0.0);
    float corner_count = 0.0;
    for (uint i = 0u; i < 4u; i++) {
        float inside = i < 2u ? (i == 0u ? corners_inside.x : corners_inside.y)
            : (i == 2u ? corners_inside.z : corners_inside.w);
        if (inside >= 0.0) {
            vec2 position = vec2(float(i & 1u), float(i >> 1u));
            float depth = depth_at(origin + position, facing, height, range);
            near = min(near, depth);
            far = max(far, depth);
            center += position;
            corner_count += 1.0;
        }
    }
    float coverage = 1.0;
    if (!is_full) {
        float area = 0.0;
        for (uint i = 0u; i < count; i++) {
            vec2 a = corner_of(i) - origin;
            vec2 b = corner_of(i + 1u == count ? 0u : i + 1u) - origin;
            area += area_under(a, b);
            vec2 segment = segment_inside(a, b);
            if (segment.x <= segment.y) {
                for (uint end = 0u; end < 2u; end++) {
                    vec2 position = clamp(mix(a, b, end == 0u ? segment.x : segment.y), vec2(0.0), vec2(1.0));
                    float depth = depth_at(origin + position, facing, height, range);
                    near = min(near, depth);
                    far = max(far, depth);
                    center += position;
                    corner_count += 1.0;
                }
            }
        }
        coverage = clamp(signed_area >= 0.0 ? area : -area, 0.0, 1.0);
        if (coverage <= 0.0 || corner_count == 0.0) {
            return;
        }
    }
    center /= corner_count;
    if (near > frame.yon_m) {
        return;
    }

    // The point that is shaded, and its barycentric weights.
    vec2 at = origin + center;
    vec3 point = eye + ray_direction(at) * depth_at(at, facing, height, range);
    float twice_area = dot(facing, facing);
    float weight_1 = clamp(dot(cross(point - p0, p2 - p0), facing) / max(twice_area, 1.0e-30), 0.0, 1.0);
    float weight_2 = clamp(dot(cross(p1 - p0, point - p0), facing) / max(twice_area, 1.0e-30), 0.0, 1.0 - weight_1);
    vec3 normal = vertices[corner.x].normal * (1.0 - weight_1 - weight_2) + vertices[corner.y].normal * weight_1
        + vertices[corner.z].normal * weight_2;
    if (dot(normal, normal) < 1.0e-12) {
        normal = facing;
    }

    vec3 color = object.color;
    if (object.checker_edge_m > 0.0) {
        // Half a square up, so that boards that lie on a border of squares have one colour.
        vec3 at_square = point / object.checker_edge_m + vec3(0.0, 0.5, 0.0);
        vec3 across = (in_plane(at + vec2(0.5, 0.0), facing, height) - in_plane(at - vec2(0.5, 0.0), facing, height));
        vec3 along = (in_plane(at + vec2(0.0, 0.5), facing, height) - in_plane(at - vec2(0.0, 0.5), facing, height));
        vec3 width = min((abs(across) + abs(along)) / object.checker_edge_m, vec3(1.0e3));
        vec3 sides = vec3(mean_side(at_square.x, width.x), mean_side(at_square.y, width.y),
            mean_side(at_square.z, width.z));
        color = mix(object.checker_color, color, 0.5 + 0.5 * sides.x * sides.y * sides.z);
    }
    float opacity = object.opacity;
    if (object.solid_texture >= 0) {
        // Surface-defined gases: the solid texture is the surface's transparency.
        opacity *= clamp(gas_density(uint(object.solid_texture), point + object.offset_m), 0.0, 1.0);
        if (object.ends_m.x > 0.0) {
            vec2 t = clamp((object.ends_m - abs(point.xz)) / max(object.fade_m, 1.0e-3), 0.0, 1.0);
            opacity *= t.x * t.x * (3.0 - 2.0 * t.x) * t.y * t.y * (3.0 - 2.0 * t.y);
        }
        // What fades before the opaque surface behind it must not be one.
        opacity = object.fade_m > 0.0 ? min(opacity, 0.9999) : opacity;
    }
    if (mask == 0u) {
        // Never opaque: it does not cover the sub-pixel whole, so that no tracing may end at it.
        opacity *= min(coverage * 32.0, 0.99);
        uvec2 nearest = min(uvec2(center * vec2(4.0, 8.0)), uvec2(3u, 7u));
        mask = 1u << (nearest.y * 4u + nearest.x);
    }

    uint packed_opacity = uint(round(clamp(opacity, 0.0, 1.0) * 65535.0));
    if (packed_opacity == 0u) {
        return; // a hole in a surface-defined gas
    }
    uint slot = atomicAdd(fragment_count, 1u);
    if (slot >= frame.fragment_capacity) {
        return; // counted: the host grows the buffers and repeats the run
    }
    uint next = atomicExchange(heads[list_of(uvec2(pixel))], slot);
    links[slot] = Link(next, mask, near, far);
    surfaces[slot] = Surface(pack_normal(normalize(normal)), object_index, band.first_triangle + identity.x,
        coverage);
    colors[slot] = Color(packHalf2x16(color.xy), packHalf2x16(vec2(color.z, 0.0)) | (packed_opacity << 16u));
}
