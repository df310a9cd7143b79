#version 450

// A polygon object under the terrain's light and haze, in its shadow. Faces are lit on both sides.

#extension GL_EXT_samplerless_texture_functions : require

#include "terrain/light.glsl"
#include "terrain/base-normal.glsl"

layout(set = 0, binding = 1) uniform texture2D shadow; // a single texel where none are thrown

layout(location = 0) in vec3 facing;

layout(location = 0) out vec4 picture;

const vec3 PAINT = vec3(0.55, 0.12, 0.08);

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float sunlit = texelFetch(shadow, min(pixel, textureSize(shadow, 0) - 1), 0).x;
    vec3 direction = view_direction(vec2(pixel));
    vec3 normal = facing / max(length(facing), 1.0e-20);
    // By the face: at an outline a vertex normal may point away from an eye that sees the face.
    vec3 place = direction / gl_FragCoord.w;
    vec3 face = cross(dFdx(place), dFdy(place));
    float side = dot(face, direction) > 0.0 ? -1.0 : 1.0;
    normal = side * dot(normal, face) < 0.0 ? -normal : normal;
    // Objects are low over the base beside its radius.
    vec3 up = up_at(light.eye + place, 0.0);
    picture = vec4(encoded(lit_color(PAINT, normal, up, sunlit, length(direction) / gl_FragCoord.w)), 1.0);
}
