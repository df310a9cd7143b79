// The finished picture: rays of several places in a pixel meet the receivers, and the light from where they do is found in the
// colour and depth textures of the underwater scene. So an outline is the geometry's own, and no pixel shows another surface's light.

layout(set = 0, binding = 1) uniform texture2D underwater_color;
layout(set = 0, binding = 2) uniform texture2D underwater_depth;
layout(set = 0, binding = 3) uniform sampler nearest;

layout(set = 0, binding = 4) uniform View {
    mat4 inverse_view_projection; // of the viewer
    mat4 underwater_view_projection; // of the textures' camera
    mat4 underwater_inverse;
    vec3 eye; // of the viewer, metres
    float level_m; // height of the flat water
    vec3 underwater_eye; // of the textures' camera, metres
    uint samples; // a pixel
    vec2 picture_size; // pixels
    vec2 texture_size; // texels
    uint node_count; // of the receivers' tree
    uint most_steps; // of a ray in it
} view;

#include "common/triangle-tree.glsl"

const vec3 DEEP_WATER = vec3(0.004, 0.030, 0.055); // light scattered back by deep water, as the cast's background
const float SAME_PLANE = 0.003; // distance of a texel's point from the face that is seen, as a fraction of the camera's distance
const float SAME_PLACE = 0.05; // and from the point itself
const int RINGS = 16; // of texels around a point that the textures' camera does not see

vec3 unproject(mat4 inverse, vec2 ndc, float depth) {
    vec4 point = inverse * vec4(ndc, depth, 1.0);
    return point.xyz / point.w;
}

// Place of sample `index` in the pixel of `fragment`, pixels: the golden ratio's multiples along y spread any number of them.
vec2 sample_place(vec2 fragment, uint index) {
    float along = (float(index) + 0.5) / float(view.samples);
    return floor(fragment) + vec2(along, fract(0.5 + 0.61803399 * float(index)));
}

vec3 ray_through(vec2 place) {
    vec2 ndc = 2.0 * place / view.picture_size - 1.0;
    return normalize(unproject(view.inverse_view_projection, ndc, 1.0) - view.eye);
}

// Position of a point of the world in the underwater textures, texels.
vec2 texture_place(vec3 point) {
    vec4 clip = view.underwater_view_projection * vec4(point, 1.0);
    vec2 uv = 0.5 * clip.xy / max(clip.w, 1.0e-6) + 0.5;
    return clamp(uv * view.texture_size, vec2(0.0), view.texture_size - 1.0);
}

ivec2 inside_texture(vec2 texel) {
    return ivec2(clamp(texel, vec2(0.0), view.texture_size - 1.0));
}

// True where a texel shows the face through `point` with this normal.
bool shows(ivec2 texel, vec3 point, vec3 normal, float reach) {
    float depth = texelFetch(sampler2D(underwater_depth, nearest), texel, 0).r;
    if (depth >= 1.0) {
        return false;
    }
    vec2 ndc = (vec2(texel) + 0.5) / view.texture_size * 2.0 - 1.0;
    vec3 apart = unproject(view.underwater_inverse, ndc, depth) - point;
    float distance_m = distance(point, view.underwater_eye);
    return abs(dot(apart, normal)) <= SAME_PLANE * distance_m && length(apart) <= reach * distance_m;
}

vec3 color_of(ivec2 texel) {
    return texelFetch(sampler2D(underwater_color, nearest), texel, 0).rgb;
}

// Light from a point that the textures' camera does not see: that of the nearest texels which show the same face, or its
// continuation. What waves bring into view from behind an edge is a few pixels wide.
vec3 light_nearby(vec2 place, vec3 point, vec3 normal) {
    for (int ring = 1; ring <= RINGS; ring++) {
        float radius = 0.5 * float(ring) * (1.0 + 0.25 * float(ring));
        vec3 light = vec3(0.0);
        float total = 0.0;
        for (int i = 0; i < 8; i++) {
            float angle = 0.78539816 * float(i);
            ivec2 texel = inside_texture(place + radius * vec2(cos(angle), sin(angle)));
            float weight = shows(texel, point, normal, 4.0 * SAME_PLACE) ? 1.0 : 0.0;
            light += weight * color_of(texel);
            total += weight;
        }
        if (total > 0.0) {
            return light / total;
        }
    }
    return color_of(inside_texture(place));
}

// Light from a point of a face: interpolated between those of the four nearest texels that show the face.
vec3 light_from(vec3 point, vec3 normal) {
    vec2 place = texture_place(point);
    vec2 base = floor(place - 0.5);
    vec2 fraction = place - 0.5 - base;
    vec3 light = vec3(0.0);
    float total = 0.0;
    for (int i = 0; i < 4; i++) {
        vec2 corner = vec2(float(i & 1), float(i >> 1));
        vec2 weights = mix(1.0 - fraction, fraction, corner);
        ivec2 texel = inside_texture(base + corner);
        float weight = shows(texel, point, normal, SAME_PLACE) ? weights.x * weights.y : 0.0;
        light += weight * color_of(texel);
        total += weight;
    }
    return total > 1.0e-3 ? light / total : light_nearby(place, point, normal);
}
