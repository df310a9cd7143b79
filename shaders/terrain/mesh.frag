#version 450

#extension GL_EXT_samplerless_texture_functions : require

#include "terrain/terrain.glsl"
#include "terrain/levels.glsl"
#include "terrain/mesh.glsl"
#include "terrain/geodesy.glsl"

layout(location = 0) out vec4 depth;

void main() {
    float depth_m = 1.0 / gl_FragCoord.w;
    vec3 direction = direction_of(floor(gl_FragCoord.xy));
    vec3 point = terrain.eye + depth_m * direction;
    vec2 place = point.xy;
    if (!is_kind(terrain.base_kind, PLANE, depth_m)) {
        place = map_coordinates(point, point.x).xy;
    }
    depth = vec4(depth_m, clamp(place, vec2(0.0), vec2(terrain.size - 1)), surface_code(mesh.surface, 0, 0));
}
