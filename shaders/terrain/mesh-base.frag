#version 450

// The base under and around the triangle grids: what a ray meets there is a division.

#extension GL_EXT_samplerless_texture_functions : require

#include "terrain/land.glsl"

layout(location = 0) out vec4 depth;

void main() {
    vec2 pixel = floor(gl_FragCoord.xy);
    vec3 direction = land.corner.xyz + pixel.x * land.across.xyz + pixel.y * land.down.xyz;
    float above = land.eye.z - land.bounds.z;
    float base_m = above <= 0.0 ? 0.0 : (direction.z < 0.0 ? above / -direction.z : NO_DEPTH);
    depth = vec4(base_m, land.eye.xy + base_m * direction.xy, surface_code(base_m < NO_DEPTH ? BASE : SKY, 0));
    // Where the map lies in the base, the map is seen: the base counts as a little farther away.
    gl_FragDepth = 1.0 - land.turn.z / max(base_m * 1.0001, land.turn.z);
}
