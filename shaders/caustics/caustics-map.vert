#version 450

// Where the rays of the illumination volumes pierce one reference plane (section 4.4, figure 4-15 step 2.1). The same for every
// variant, so that their times differ by method alone.

layout(location = 0) in vec4 origin;
layout(location = 1) in vec4 slope;
layout(location = 2) in vec4 incident;

#include "caustics/plane.glsl"

layout(location = 0) out vec4 surface; // where the ray left the water, and 1 for a ray that lights this plane
layout(location = 1) out vec3 weight;

void main() {
    float descent = origin.y - plane.height;
    float lit = descent > 0.0 ? origin.w : 0.0;
    vec2 place = origin.xz + slope.xy * descent - plane.center;
    // Eq. 4-17: d is the way along the ray, descent / cos(theta_t). Behind the water it would grow without bound, and reach
    // the texels next to the edge that the triangle's other vertices span.
    float transmitted = exp(-plane.absorption_per_m * (max(descent, 0.0) * slope.z));
    surface = vec4(origin.xyz, lit);
    weight = incident.xyz * (slope.z * transmitted);
    gl_Position = vec4(place * plane.to_clip, 0.5, 1.0);
}
