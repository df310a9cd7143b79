#version 450

#pragma variants SIMULATION=free,sph

// A polygon object where it is nearer than the lava: the depth texture of eq. 7.1 holds the nearest splat's depth plus
// epsilon. The sky lights it from above and the lava's orange from below; faces are lit on both sides.
// Beside a fluid it and the ground are lit by the sky as the crust is, and by the lava where it is.

#extension GL_EXT_samplerless_texture_functions : require

#include "lava/scene.glsl"
#include "lava/object.glsl"
#include "common/tone.glsl"
#include "lava/sky.glsl"
#include "lava/encoding.glsl"

layout(set = 0, binding = 1) uniform texture2D visibility;

layout(location = 0) in vec3 facing;
layout(location = 1) in vec3 world_m;
layout(location = 2) in float eye_depth_m;
#ifdef SIMULATION_SPH
layout(location = 3) in vec3 to_front;
layout(location = 4) in vec3 to_back;
#endif

layout(location = 0) out vec4 color;

const float OF_THE_GLOW = 0.4;

void main() {
    vec3 face = cross(dFdx(world_m), dFdy(world_m));
    float nearest = texelFetch(visibility, ivec2(gl_FragCoord.xy), 0).r;
    if ((eye_depth_m + scene.epsilon_m) * scene.depth_per_m >= nearest) {
        discard;
    }
    vec3 normal = facing / max(length(facing), 1.0e-20);
    // By the face: at an outline a vertex normal may point away from an eye that sees the face.
    float side = dot(face, world_m - object.eye_m) > 0.0 ? -1.0 : 1.0;
    bool is_front = side * dot(normal, face) >= 0.0;
    normal = is_front ? normal : -normal;
#ifdef SIMULATION_SPH
    vec3 daylight = object.paint * sky_on(normal);
    vec3 glow = object.paint * (is_front ? to_front : to_back);
    // A black body's light is linear, exposed and encoded as the lava's is.
    daylight = scene.daylight * mix(daylight, decoded(daylight), scene.is_blackbody);
    vec3 lit = toned(daylight + glow, object.exposure, object.knee);
    color = vec4(mix(lit, encoded(lit), scene.is_blackbody), 1.0);
#else
    vec3 lit = object.paint * mix(OF_THE_GLOW * scene.glow, scene.daylight * SKY, 0.5 + 0.5 * normal.y);
    color = vec4(toned(lit, object.exposure, object.knee), 1.0);
#endif
}
