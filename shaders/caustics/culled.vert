#version 450

// As caustics-map.vert, for the pairs of ray and plane that culling kept (section 6.1).

#include "caustics/ray.glsl"

layout(std430, set = 0, binding = 3) readonly buffer Rays {
    Ray list[];
} rays;

#include "caustics/culled.glsl"
#include "caustics/cell.glsl"

layout(std430, set = 0, binding = 2) readonly buffer Cells {
    Cell list[];
} cells;

layout(location = 0) out vec4 surface; // point of the water that the ray left, and 1 for a ray that lights this plane
layout(location = 1) out vec3 weight;
layout(location = 2) flat out vec2 accepted; // heights of the plane's cell: lowest, and first no longer accepted

// The level map and its culling place a triangle alike, bit for bit.
invariant gl_Position;

void main() {
    uint at = uint(gl_VertexIndex) / plane.vertices;
    Ray ray = rays.list[uint(gl_VertexIndex) - at * plane.vertices];
    Cell cell = cells.list[at];
    accepted = vec2(cell.lower, cell.upper);
    float descent = ray.origin.y - cell.height;
    float lit = descent > 0.0 ? ray.enters : 0.0;
    vec2 place = ray.origin.xz + ray.slope * descent - plane.center;
    float transmitted = exp(-plane.absorption_per_m * (max(descent, 0.0) * ray.secant));
    surface = vec4(ray.origin, lit);
    weight = ray.incident * (ray.secant * transmitted);
    gl_Position = vec4(place * plane.to_clip, 0.5, 1.0);
}
