// A pixel's fragments as shading knows them.

layout(set = 0, binding = 6, std430) readonly buffer Objects {
    uvec4 object_words[]; // six of each Object, see object.glsl
};

#include "gas/nodes.glsl"

layout(set = 0, binding = 9, std430) readonly buffer Surfaces {
    uvec4 surfaces[]; // each a Surface
};

layout(set = 0, binding = 10, std430) readonly buffer Colors {
    uvec2 colors[]; // each a Color
};

layout(set = 0, binding = 12, std430) readonly buffer Pixels {
    uvec4 pixels[]; // each a Pixel
};

layout(set = 0, binding = 14, std430) readonly buffer Attenuations {
    float attenuations[];
};

layout(set = 0, binding = 17, rgba32f) uniform writeonly image2D radiance;

const uint FULL = 0xffffffffu;

// Read as vectors, as links are.
Surface surface_at(uint fragment) {
    uvec4 surface = surfaces[fragment];
    return Surface(surface.x, surface.y, surface.z, uintBitsToFloat(surface.w));
}

Color color_at(uint fragment) {
    uvec2 color = colors[fragment];
    return Color(color.x, color.y);
}

// Of an object, as far as shading asks for it.
struct Material {
    vec3 checker_color;
    float checker_edge_m;
    vec3 offset_m;
    float highlight_strength;
    float highlight_exponent;
    float fade_m;
};

Material material_of(uint object) {
    vec4 checkers = uintBitsToFloat(object_words[6u * object + 1u]);
    vec4 place = uintBitsToFloat(object_words[6u * object + 2u]);
    vec4 ends = uintBitsToFloat(object_words[6u * object + 3u]);
    return Material(checkers.xyz, checkers.w, place.xyz, place.w, ends.x, ends.w);
}

// The fragment's own, less what fades before the opaque surfaces that end the pixel's tracing.
float seen_opacity(Color color, float fade_m, float depth_m, float end_m) {
    float t = fade_m > 0.0 ? clamp((end_m - depth_m) / fade_m, 0.0, 1.0) : 1.0;
    return opacity_of(color) * (t * t * (3.0 - 2.0 * t));
}

#include "gas/checkers.glsl"
