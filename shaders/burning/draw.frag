#version 450

// Two-sided Lambert and ambient light on the charring surface, with the glow of its combustion-ready edge.

#include "burning/constants.glsl"
#include "burning/view.glsl"
#include "burning/wood.glsl"

layout(location = 0) in vec3 place;
layout(location = 1) in vec3 rest_place;
layout(location = 2) in vec4 normal;
layout(location = 3) in vec4 color;

layout(location = 0) out vec4 shaded;

const vec3 EMBERS = vec3(1.0, 0.35, 0.05);

void main() {
    vec3 n = normalize(normal.xyz);
    if (view.mode.x == NORMALS) {
        shaded = vec4(0.5 + 0.5 * n, 1.0);
        return;
    }
    vec3 to_eye = view.eye.xyz - place;
    if (dot(n, to_eye) < 0.0) {
        n = -n;
    }
    vec3 albedo = color.rgb;
    if (view.mode.x == LIT && constants.choices.w == 1u) {
        albedo *= mix(wood(rest_place), 1.0, normal.w);
    }
    float light = view.to_light.w + (1.0 - view.to_light.w) * max(dot(n, view.to_light.xyz), 0.0);
    shaded = vec4(albedo * light + color.a * EMBERS, 1.0);
}
