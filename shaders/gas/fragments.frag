#version 450

// Section "Combining A-buffer and volume rendering techniques" and reference 2 (Carpenter): what a triangle leaves in a pixel. Coverage is the
// area of the triangle inside the pixel, cut exactly; the mask has a bit for each of 4 x 8 sub-pixels whose middle lies inside. Both
// come from the triangle's edges, not from the rasteriser's samples. A sliver that misses every middle takes the nearest sub-pixel at the
// opacity of its coverage. Depths are those of the corners of the piece inside the pixel; the text's light attenuations are a buffer
// of their own, filled for visible fragments by light-attenuation.

#include "gas/frame.glsl"
#include "gas/mesh.glsl"
#include "gas/volume.glsl"
#include "gas/density.glsl"
#include "gas/lists.glsl"

layout(set = 0, binding = 7, std430) buffer Heads {
    uint heads[]; // of each pixel's list
};

layout(set = 0, binding = 8, std430) buffer Links {
    uvec4 links[];
};

layout(set = 0, binding = 9, std430) buffer Surfaces {
    uvec4 surfaces[];
};

layout(set = 0, binding = 10, std430) buffer Colors {
    uvec2 colors[];
};

layout(set = 0, binding = 11, std430) buffer Counters {
    uint counters[]; // fragments, sections; the most of both in a frame
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

// Twice the area of edge and point, positive on the left of from -> to. It is computed in one direction for both triangles of an
// edge, so that a point is inside exactly one of them; `tie` is what a point on the edge belongs to.
float side_of(vec2 from, vec2 to, vec2 point) {
    bool forwards = from.x < to.x || (from.x == to.x && from.y < to.y);
    vec2 low = forwards ? from : to;
    vec2 high = forwards ? to : from;
    vec2 edge = high - low;
    vec2 way = point - low;
    float area = edge.x * way.y - edge.y * way.x;
    return forwards ? area : -area;
}

bool is_inside(vec2 from, vec2 to, vec2 point) {
    float side = side_of(from, to, point);
    bool forwards = from.x < to.x || (from.x == to.x && from.y < to.y);
    return side > 0.0 || (side == 0.0 && forwards);
}

// The world's point under a place of the picture: where the ray meets the triangle's plane, but no nearer or farther than its corners.
float depth_at(vec2 pixel, vec3 normal, float height, vec2 range) {
    float slope = dot(normal, ray_direction(pixel));
    float depth = abs(slope) > 1.0e-12 ? height / slope : range.x;
    return clamp(depth, range.x, range.y);
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec2 origin = vec2(pixel);
    uint count = identity.y;

    // The polygon relative to the pixel's corner, counter-clockwise in its coordinates.
    vec2 polygon[8];
    float area = 0.0;
    for (uint i = 0u; i < count; i++) {
        vec2 next = corner_of(i + 1u == count ? 0u : i + 1u) - corner_of(0u);
        vec2 here = corner_of(i) - corner_of(0u);
        area += here.x * next.y - here.y * next.x;
    }
    for (uint i = 0u; i < count; i++) {
        polygon[i] = corner_of(area >= 0.0 ? i : count - 1u - i) - origin;
    }

    uint mask = 0u;
    bool is_full = true;
    for (uint i = 0u; i < count; i++) {
        vec2 from = polygon[i];
        vec2 to = polygon[i + 1u == count ? 0u : i + 1u];
        float a = side_of(from, to, vec2(0.0, 0.0));
        float b = side_of(from, to, vec2(1.0, 0.0));
        float c = side_of(from, to, vec2(0.0, 1.0));
        float d = side_of(from, to, vec2(1.0, 1.0));
        if (max(max(a, b), max(c, d)) < 0.0) {
            return; // the pixel lies beside this edge
        }
        is_full = is_full && min(min(a, b), min(c, d)) > 0.0;
    }

    vec2 piece[8];
    uint piece_count = 4u;
    float coverage = 1.0;
    vec2 middle = vec2(0.5);
    if (is_full) {
        mask = FULL;
        piece[0] = vec2(0.0, 0.0);
        piece[1] = vec2(1.0, 0.0);
        piece[2] = vec2(1.0, 1.0);
        piece[3] = vec2(0.0, 1.0);
    } else {
        for (uint bit = 0u; bit < 32u; bit++) {
            vec2 point = vec2((float(bit & 3u) + 0.5) / 4.0, (float(bit >> 2u) + 0.5) / 8.0);
            bool inside = true;
            for (uint i = 0u; i < count; i++) {
                if (!is_inside(polygon[i], polygon[i + 1u == count ? 0u : i + 1u], point)) {
                    inside = false;
                }
            }
            mask |= inside ? 1u << bit : 0u;
        }
        // Sutherland and Hodgman against the pixel's four sides: 0 <= x, x <= 1, 0 <= y, y <= 1.
        piece_count = count;
        for (uint i = 0u; i < count; i++) {
            piece[i] = polygon[i];
        }
        for (uint side = 0u; side < 4u; side++) {
            vec2 before[8];
            for (uint i = 0u; i < piece_count; i++) {
                before[i] = piece[i];
            }
            uint before_count = piece_count;
            piece_count = 0u;
            for (uint i = 0u; i < before_count; i++) {
                vec2 from = before[i];
                vec2 to = before[i + 1u == before_count ? 0u : i + 1u];
                float from_in = side == 0u ? from.x : (side == 1u ? 1.0 - from.x : (side == 2u ? from.y : 1.0 - from.y));
                float to_in = side == 0u ? to.x : (side == 1u ? 1.0 - to.x : (side == 2u ? to.y : 1.0 - to.y));
                if (from_in >= 0.0 && piece_count < 8u) {
                    piece[piece_count] = from;
                    piece_count++;
                }
                if ((from_in >= 0.0) != (to_in >= 0.0) && piece_count < 8u) {
                    piece[piece_count] = mix(from, to, from_in / (from_in - to_in));
                    piece_count++;
                }
            }
        }
        if (piece_count < 3u) {
            return;
        }
        float twice = 0.0;
        middle = vec2(0.0);
        for (uint i = 0u; i < piece_count; i++) {
            vec2 here = piece[i];
            vec2 next = piece[i + 1u == piece_count ? 0u : i + 1u];
            twice += here.x * next.y - here.y * next.x;
            middle += here;
        }
        coverage = clamp(0.5 * twice, 0.0, 1.0);
        if (coverage <= 0.0) {
            return;
        }
        middle = clamp(middle / float(piece_count), vec2(0.0), vec2(1.0));
    }

    uvec4 corner = triangles[identity.x];
    Object object = objects[corner.w];
    vec3 eye = frame.eye.xyz - object.offset.xyz; // in the object's space
    vec3 p0 = vertices[corner.x].position.xyz;
    vec3 p1 = vertices[corner.y].position.xyz;
    vec3 p2 = vertices[corner.z].position.xyz;
    vec3 facing = cross(p1 - p0, p2 - p0);
    vec3 depths = vec3(dot(p0 - eye, frame.forward.xyz), dot(p1 - eye, frame.forward.xyz), dot(p2 - eye, frame.forward.xyz));
    vec2 range = vec2(min(depths.x, min(depths.y, depths.z)), max(depths.x, max(depths.y, depths.z)));
    range = max(range, vec2(frame.eye.w));
    float height = dot(facing, p0 - eye);
    float near = 1.0e30;
    float far = 0.0;
    for (uint i = 0u; i < piece_count; i++) {
        float depth = depth_at(origin + piece[i], facing, height, range);
        near = min(near, depth);
        far = max(far, depth);
    }
    if (near > frame.forward.w) {
        return;
    }

    // The point that is shaded, as shares of the corners.
    vec2 at = origin + middle;
    vec3 point = eye + ray_direction(at) * depth_at(at, facing, height, range);
    float twice_area = dot(facing, facing);
    float share_1 = clamp(dot(cross(point - p0, p2 - p0), facing) / max(twice_area, 1.0e-30), 0.0, 1.0);
    float share_2 = clamp(dot(cross(p1 - p0, point - p0), facing) / max(twice_area, 1.0e-30), 0.0, 1.0 - share_1);
    vec3 normal = vertices[corner.x].normal.xyz * (1.0 - share_1 - share_2) + vertices[corner.y].normal.xyz * share_1
        + vertices[corner.z].normal.xyz * share_2;
    if (dot(normal, normal) < 1.0e-12) {
        normal = facing;
    }

    vec3 color = object.color.xyz;
    if (object.second.w > 0.0) {
        // Half a square up, so that boards that lie on a border of squares have one colour.
        vec3 square = floor(point / object.second.w + vec3(0.0, 0.5, 0.0));
        float parity = mod(square.x + square.y + square.z, 2.0);
        color = parity < 0.5 ? color : object.second.xyz;
    }
    float opacity = object.color.w;
    if (object.detail.z >= 0.0) {
        // Surface-defined gases: the solid texture is the surface's transparency.
        opacity *= clamp(gas_density(uint(object.detail.z), point + object.offset.xyz), 0.0, 1.0);
    }
    if (mask == 0u) {
        opacity *= min(coverage * 32.0, 1.0);
        uvec2 nearest = min(uvec2(middle * vec2(4.0, 8.0)), uvec2(3u, 7u));
        mask = 1u << (nearest.y * 4u + nearest.x);
    }

    uint packed_opacity = uint(round(clamp(opacity, 0.0, 1.0) * 65535.0));
    if (packed_opacity == 0u) {
        return; // a hole in a surface-defined gas
    }
    uint slot = atomicAdd(counters[0], 1u);
    if (slot >= frame.limits.x) {
        return; // counted: the host grows the buffers and repeats the run
    }
    uint next = atomicExchange(heads[uint(pixel.y) * frame.counts.x + uint(pixel.x)], slot);
    links[slot] = uvec4(next, mask, floatBitsToUint(near), floatBitsToUint(far));
    surfaces[slot] = uvec4(pack_normal(normalize(normal)), corner.w, identity.x, floatBitsToUint(coverage));
    colors[slot] = uvec2(packHalf2x16(color.xy), packHalf2x16(vec2(color.z, 0.0)) | (packed_opacity << 16u));
}
