// The fragment structure, split over three buffers: what the lists are walked by, and what shading needs.

struct Link {
    uint next; // fragment, section with the bit SECTION, or NONE
    uint mask; // bit 4 row + column of a sub-pixel, rows from the top
    float near_m; // depths
    float far_m;
};

struct Surface {
    uint normal; // octahedral, 16 bits each way
    uint object;
    uint triangle;
    float coverage; // area of the triangle inside the pixel, pixels
};

struct Color {
    uint red_green; // half floats, linear RGB
    uint blue_opacity; // a half float; opacity in steps of 1/65535, so that opaque is exactly 1
};

// A section of gas, which the volume rendering adds to a pixel's list; of a full mask. It is two vectors: its depths, near and
// far, the increments of its march, a whole number, and what is next, a fragment or NONE; and its colour, premultiplied linear
// RGB, and transparency.

// What `sort` finds of a pixel, and what `volume` counts.
struct Pixel {
    uint first_section; // slots that are reserved for its sections
    uint section_count; // those that `volume` has made, once it is done with the pixel
    float end_m; // depth at which its tracing ends
    uint evaluations; // of the density
};

// As they stand in their buffers, which are read and written as vectors: each member by itself costs as much as all of them where
// a processor does many threads in step.
uvec4 link_words(Link link) {
    return uvec4(link.next, link.mask, floatBitsToUint(link.near_m), floatBitsToUint(link.far_m));
}

uvec4 surface_words(Surface surface) {
    return uvec4(surface.normal, surface.object, surface.triangle, floatBitsToUint(surface.coverage));
}

uvec2 color_words(Color color) {
    return uvec2(color.red_green, color.blue_opacity);
}

Pixel pixel_of_words(uvec4 words) {
    return Pixel(words.x, words.y, uintBitsToFloat(words.z), words.w);
}

Link link_of(uvec4 words) {
    return Link(words.x, words.y, uintBitsToFloat(words.z), uintBitsToFloat(words.w));
}

const uint SECTION = 0x80000000u; // in a link: what follows is a section, not a fragment

bool is_section(uint node) {
    return (node & SECTION) != 0u; // also of the list's end
}

float mean_depth(Link link) {
    return 0.5 * (link.near_m + link.far_m);
}

float opacity_of(Color color) {
    return float(color.blue_opacity >> 16u) / 65535.0;
}

vec3 color_of(Color color) {
    return vec3(unpackHalf2x16(color.red_green), unpackHalf2x16(color.blue_opacity & 0xffffu).x);
}

// Octahedral.
uint pack_normal(vec3 n) {
    vec3 s = n / (abs(n.x) + abs(n.y) + abs(n.z));
    vec2 folded = s.z >= 0.0
        ? s.xy
        : (1.0 - abs(s.yx)) * vec2(s.x >= 0.0 ? 1.0 : -1.0, s.y >= 0.0 ? 1.0 : -1.0);
    return packSnorm2x16(folded);
}

vec3 unpack_normal(uint packed_normal) {
    vec2 folded = unpackSnorm2x16(packed_normal);
    float z = 1.0 - abs(folded.x) - abs(folded.y);
    float t = max(-z, 0.0);
    vec2 xy = folded + vec2(folded.x >= 0.0 ? -t : t, folded.y >= 0.0 ? -t : t);
    return normalize(vec3(xy, z));
}

// Carpenter's estimate where the depth ranges of neighbouring fragments of two objects overlap: the fraction of the
// front one's area in which it is behind the other. 0 without an overlap.
float fraction_behind(Link front, Link back) {
    float thickness = (front.far_m - front.near_m) + (back.far_m - back.near_m);
    if (back.near_m >= front.far_m || thickness <= 0.0) {
        return 0.0;
    }
    return 1.0 - clamp((back.far_m - front.near_m) / thickness, 0.0, 1.0);
}
