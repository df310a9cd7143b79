// Section "Combining A-buffer and volume rendering techniques" and reference 2 (Carpenter): what a triangle leaves in a
// pixel. Coverage is the area of the triangle inside the pixel, cut exactly; the mask has a bit for each of 4 x 8
// sub-pixels whose centre lies inside. Both come from the triangle's edges, not from the rasteriser's samples. A sliver
// that misses every centre takes the nearest sub-pixel at the opacity of its coverage. Depths are those of the corners
// of the piece inside the pixel; the text's light attenuations are a buffer of their own, filled for visible fragments
// by light-attenuation.

#include "gas/facet.glsl"

const uint FULL = 0xffffffffu;

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
float depth_at(Facet facet, vec2 pixel) {
    float slope = dot(facet.facing, ray_direction(pixel));
    float depth = abs(slope) > 1.0e-12 ? facet.height / slope : facet.range.x;
    return clamp(depth, facet.range.x, facet.range.y);
}

// The piece of a triangle that is inside a pixel.
struct Piece {
    vec4 corners_inside; // distances of the pixel's corners from the nearest edge
    uint mask;
    bool is_beside; // it is empty
    float area;
    vec2 center; // sum of its corners: those of the pixel that are inside, and the ends of the edges' segments in it
    float corner_count;
    vec2 depths; // nearest and farthest
};

// Those of 4 sub-pixels that are not negative.
uint signs_of(vec4 sides) {
    uvec4 bits = uvec4(greaterThanEqual(sides, vec4(0.0))) * uvec4(1u, 2u, 4u, 8u);
    return (bits.x | bits.y) | (bits.z | bits.w);
}

// The sub-pixels that are not on the right of an edge.
uint left_of(vec2 low, vec2 high) {
    vec2 edge = high - low;
    vec4 across = edge.y * (vec4(0.125, 0.375, 0.625, 0.875) - low.x);
    vec4 upper = edge.x * (vec4(0.0625, 0.1875, 0.3125, 0.4375) - low.y);
    vec4 lower = edge.x * (vec4(0.5625, 0.6875, 0.8125, 0.9375) - low.y);
    uint top = signs_of(upper.x - across) | signs_of(upper.y - across) << 4u | signs_of(upper.z - across) << 8u
        | signs_of(upper.w - across) << 12u;
    uint bottom = signs_of(lower.x - across) | signs_of(lower.y - across) << 4u | signs_of(lower.z - across) << 8u
        | signs_of(lower.w - across) << 12u;
    return top | bottom << 16u;
}

void cut_by_edge(inout Piece piece, vec2 a, vec2 b, bool is_positive) {
    if (a == b) {
        return; // an edge of no length
    }
    bool forwards = a.x < b.x || (a.x == b.x && a.y < b.y);
    vec2 low = forwards ? a : b;
    vec2 high = forwards ? b : a;
    float inwards = forwards == is_positive ? 1.0 : -1.0;
    vec4 sides = inwards * vec4(side_of(low, high, vec2(0.0, 0.0)), side_of(low, high, vec2(1.0, 0.0)),
        side_of(low, high, vec2(0.0, 1.0)), side_of(low, high, vec2(1.0, 1.0)));
    piece.is_beside = piece.is_beside || max(max(sides.x, sides.y), max(sides.z, sides.w)) < 0.0;
    piece.corners_inside = min(piece.corners_inside, sides);
    if (min(min(sides.x, sides.y), min(sides.z, sides.w)) <= 0.0) {
        // A point on the edge belongs to the triangle on one side of it.
        uint left = left_of(low, high);
        piece.mask &= inwards > 0.0 ? left : ~left;
    }
}

void add_corner(inout Piece piece, Facet facet, vec2 origin, vec2 place) {
    float depth = depth_at(facet, origin + place);
    piece.depths = vec2(min(piece.depths.x, depth), max(piece.depths.y, depth));
    piece.center += place;
    piece.corner_count += 1.0;
}

void add_edge(inout Piece piece, Facet facet, vec2 origin, vec2 a, vec2 b) {
    if (a == b) {
        return;
    }
    piece.area += area_under(a, b);
    vec2 segment = segment_inside(a, b);
    if (segment.x <= segment.y) {
        add_corner(piece, facet, origin, clamp(mix(a, b, segment.x), vec2(0.0), vec2(1.0)));
        add_corner(piece, facet, origin, clamp(mix(a, b, segment.y), vec2(0.0), vec2(1.0)));
    }
}

const Piece WHOLE = Piece(vec4(1.0), FULL, false, 0.0, vec2(0.0), 0.0, vec2(1.0e30, 0.0));

#include "gas/opacity-{OPACITY}.glsl"

struct Fragment {
    bool is_there;
    Link link;
    Surface surface;
    Color color;
};

// The point that is shaded, with what the triangle's object is there.
Fragment shaded(Facet facet, vec2 at, float depth, uint mask, float coverage, vec2 depths, vec2 center) {
    vec3 point = facet.eye + ray_direction(at) * depth;
    float twice_area = dot(facet.facing, facet.facing);
    float weight_1 = clamp(dot(cross(point - facet.p0, facet.p2 - facet.p0), facet.facing) / max(twice_area, 1.0e-30),
        0.0, 1.0);
    float weight_2 = clamp(dot(cross(facet.p1 - facet.p0, point - facet.p0), facet.facing) / max(twice_area, 1.0e-30),
        0.0, 1.0 - weight_1);
    vec3 normal = normal_of(facet.corner.x) * (1.0 - weight_1 - weight_2)
        + normal_of(facet.corner.y) * weight_1 + normal_of(facet.corner.z) * weight_2;
    if (dot(normal, normal) < 1.0e-12) {
        normal = facet.facing;
    }

    vec3 color = objects[facet.object].color;
    float opacity = gas_opacity(facet, at, depth, normal, objects[facet.object].opacity);
    uint covered = mask;
    if (mask == 0u) {
        // Never opaque: it does not cover the sub-pixel whole, so that no tracing may end at it.
        opacity *= min(coverage * 32.0, 0.99);
        uvec2 nearest = min(uvec2(center * vec2(4.0, 8.0)), uvec2(3u, 7u));
        covered = 1u << (nearest.y * 4u + nearest.x);
    }

    uint packed_opacity = uint(round(clamp(opacity, 0.0, 1.0) * 65535.0));
    Fragment fragment;
    fragment.is_there = packed_opacity != 0u; // else a hole in a surface-defined gas
    fragment.link = Link(NONE, covered, depths.x, depths.y);
    fragment.surface = Surface(pack_normal(normalize(normal)), facet.object, band.first_triangle + facet.triangle,
        coverage);
    fragment.color = Color(packHalf2x16(color.xy), packHalf2x16(vec2(color.z, 0.0)) | (packed_opacity << 16u));
    return fragment;
}

// Those of a polygon from one of its edges on.
struct Corners {
    vec2 from;
    vec2 to;
    vec2 next;
    vec2 last;
};

// What a triangle whose polygon has these corners leaves in a pixel.
Fragment fragment_of(Facet facet, vec4 ab, vec4 cd, vec2 origin) {
    bool is_positive = signed_area(ab, cd) >= 0.0;
    vec2 a = ab.xy - origin;
    vec2 b = ab.zw - origin;
    vec2 c = cd.xy - origin;
    vec2 d = cd.zw - origin;
    Piece piece = WHOLE;
    // Edge by edge in a loop: few triangles have four, and a processor that does many pixels in step does what stands under a
    // condition also for none.
    uint count = c == d ? 3u : 4u;
    vec2 third = c == d ? a : d;
    Corners corners = Corners(a, b, c, third);
    uint i = 0u;
    do {
        cut_by_edge(piece, corners.from, corners.to, is_positive);
        corners = Corners(corners.to, corners.next, corners.last, a);
        i++;
    } while (i < count);
    is_cut = is_cut || i < count;
    vec4 inside = piece.corners_inside;
    bool is_full = min(min(inside.x, inside.y), min(inside.z, inside.w)) > 0.0;
    if (inside.x >= 0.0) {
        add_corner(piece, facet, origin, vec2(0.0, 0.0));
    }
    if (inside.y >= 0.0) {
        add_corner(piece, facet, origin, vec2(1.0, 0.0));
    }
    if (inside.z >= 0.0) {
        add_corner(piece, facet, origin, vec2(0.0, 1.0));
    }
    if (inside.w >= 0.0) {
        add_corner(piece, facet, origin, vec2(1.0, 1.0));
    }
    count = is_full ? 0u : count;
    corners = Corners(a, b, c, third);
    i = 0u;
    do {
        if (i < count) {
            add_edge(piece, facet, origin, corners.from, corners.to);
        }
        corners = Corners(corners.to, corners.next, corners.last, a);
        i++;
    } while (i < count);
    is_cut = is_cut || i < count;
    float coverage = is_full ? 1.0 : clamp(is_positive ? piece.area : -piece.area, 0.0, 1.0);
    vec2 center = piece.center / max(piece.corner_count, 1.0);
    Fragment fragment = shaded(facet, origin + center, depth_at(facet, origin + center), piece.mask, coverage,
        piece.depths, center);
    fragment.is_there = fragment.is_there && !piece.is_beside && coverage > 0.0 && piece.corner_count > 0.0
        && piece.depths.x <= frame.yon_m;
    return fragment;
}
