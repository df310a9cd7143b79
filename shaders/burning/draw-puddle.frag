#version 450

#pragma variants LIGHT=sun,flames

// Wax on the ground, lit as the mesh is.

#include "burning/constants.glsl"
#include "burning/view.glsl"
#include "burning/light-{LIGHT}.glsl"

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in float thickness;

layout(location = 0) out vec4 shaded;

// At which the puddle ends, diagonals: a fraction of that of a film that sets, so that its rim runs between the cells.
const float RIM = 0.01;

void main() {
    if (thickness < RIM) {
        discard;
    }
    vec3 n = normalize(normal);
    float light = view.ambient + (1.0 - view.ambient) * max(dot(n, view.to_light), 0.0);
    vec3 half_way = normalize(view.to_light + normalize(view.eye - position));
    float gloss = 0.08 * pow(max(dot(n, half_way), 0.0), 40.0);
    shaded = vec4(shone_on(constants.albedo, light, position, n) + gloss, 1.0);
}
