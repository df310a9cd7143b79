#version 450

// A polygon object under the terrain's light and haze. Faces are lit on both sides.

#include "terrain/light.glsl"

layout(location = 0) in vec3 facing;

layout(location = 0) out vec4 picture;

const vec3 PAINT = vec3(0.55, 0.12, 0.08);

void main() {
    vec3 direction = view_direction(floor(gl_FragCoord.xy));
    vec3 normal = facing / max(length(facing), 1.0e-20);
    normal = dot(normal, direction) > 0.0 ? -normal : normal;
    picture = vec4(encoded(lit_color(PAINT, normal, 1.0, length(direction) / gl_FragCoord.w)), 1.0);
}
