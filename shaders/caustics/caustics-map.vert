#version 450

// Intersections of the rays of the illumination volumes with one reference plane (section 4.4, figure 4-15 step 2.1). The same for
// every variant, so that their times differ by method alone.

layout(location = 0) in vec3 origin;
layout(location = 1) in float enters;
layout(location = 2) in vec2 slope;
layout(location = 3) in float secant;
layout(location = 4) in vec3 incident;

#include "caustics/plane.glsl"

layout(location = 0) out vec4 surface; // point of the water that the ray left, and 1 for a ray that lights this plane
layout(location = 1) out vec3 weight;

// The level map and its culling place a triangle alike, bit for bit.
invariant gl_Position;

void main() {
    float descent = origin.y - plane.height;
    float lit = descent > 0.0 ? enters : 0.0;
    vec2 place = origin.xz + slope * descent - plane.center;
    // Eq. 4-17: d is the distance along the ray, descent / cos(theta_t). Behind the water it would grow without bound, and reach
    // the texels next to the edge that the triangle's other vertices span.
    float transmitted = exp(-plane.absorption_per_m * (max(descent, 0.0) * secant));
    surface = vec4(origin, lit);
    weight = incident * (secant * transmitted);
    gl_Position = vec4(place * plane.to_clip, 0.5, 1.0);
}
