// The fragment structure, split over three buffers: what the lists are walked by (links: next, mask, minimum and maximum depth), what
// shading needs (surfaces: normal, object, triangle, coverage; colors: colour and opacity).

// What the volume rendering adds to a pixel's list: a section of gas, with a full mask.
struct Section {
    uvec4 link; // depths of its ends and number of samples, as bits of floats; next
    vec4 color; // premultiplied; w: transparency
};

const uint SECTION = 0x80000000u; // in a link: what follows is a section, not a fragment

bool is_section(uint node) {
    return (node & SECTION) != 0u; // also of the list's end
}

float mean_depth(uvec4 link) {
    return 0.5 * (uintBitsToFloat(link.z) + uintBitsToFloat(link.w));
}

// Opacity lies in the upper half of the second word, in steps of 1/65535, so that opaque is exactly 1.
float opacity_of(uvec2 color) {
    return float(color.y >> 16u) / 65535.0;
}

vec3 color_of(uvec2 color) {
    return vec3(unpackHalf2x16(color.x), unpackHalf2x16(color.y & 0xffffu).x);
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

// Carpenter's estimate where the depth ranges of neighbouring fragments of two objects overlap: the share of the front one's area
// in which it is behind the other. 0 without an overlap.
float share_behind(uvec4 front, uvec4 back) {
    vec2 a = vec2(uintBitsToFloat(front.z), uintBitsToFloat(front.w));
    vec2 b = vec2(uintBitsToFloat(back.z), uintBitsToFloat(back.w));
    float thickness = (a.y - a.x) + (b.y - b.x);
    if (b.x >= a.y || thickness <= 0.0) {
        return 0.0;
    }
    return 1.0 - clamp((b.y - a.x) / thickness, 0.0, 1.0);
}
