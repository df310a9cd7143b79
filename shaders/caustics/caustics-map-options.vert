#version 450
#pragma variants PAIRS=all,kept

// As caustics-map.vert (PAIRS=all) and culled.vert (PAIRS=kept), with an intensity of each vertex: the light that passes the faces
// around it over the area that they light on this plane (eq. 4-18 for the fan of faces, a ray's Jacobian by differences).
// Interpolated over the faces it adds up to the same flux as the faces' own intensities: a face lights its area times the mean of
// its corners, and each corner hands its fan's light out by area.

#include "caustics/ray.glsl"

layout(std430, set = 0, binding = 3) readonly buffer Rays {
    Ray list[];
} rays;

#include "caustics/caustics-map-options.glsl"
#include "caustics/cell.glsl"

#ifdef PAIRS_KEPT
layout(std430, set = 0, binding = 4) readonly buffer Cells {
    Cell list[];
} cells;

layout(location = 3) flat out vec3 accepted; // lowest height of the plane's cell, first no longer accepted, and the plane's
#endif

layout(location = 0) out vec4 surface; // point of the water that the ray left, and 1 for a ray that lights this plane
layout(location = 1) out vec3 weight;
layout(location = 2) out float vertex_intensity;

vec2 place_on_plane(Ray ray, float height) {
    return ray.origin.xz + ray.slope * (ray.origin.y - height);
}

// Steps to the six neighbours around a vertex, in order; the diagonals of the cells run from +x to +z.
ivec2 neighbour(int i) {
    int place = i % 3;
    ivec2 step = place == 0 ? ivec2(1, 0) : (place == 1 ? ivec2(0, 1) : ivec2(-1, 1));
    return i % 6 < 3 ? step : -step;
}

// The level map and its culling place a triangle alike, bit for bit.
invariant gl_Position;

void main() {
    int columns = int(plane.columns);
    ivec2 size = ivec2(columns, int(plane.rows));
#ifdef PAIRS_KEPT
    int at = int(gl_VertexIndex) / (size.x * size.y);
    int vertex = int(gl_VertexIndex) - at * size.x * size.y;
    Cell cell = cells.list[at];
    accepted = vec3(cell.lower, cell.upper, cell.height);
    float height = cell.height;
#else
    int vertex = int(gl_VertexIndex);
    float height = plane.height;
#endif
    Ray ray = rays.list[vertex];
    float descent = ray.origin.y - height;
    float lit = descent > 0.0 ? ray.enters : 0.0;
    vec2 place = place_on_plane(ray, height);
    float transmitted = exp(-plane.absorption_per_m * (max(descent, 0.0) * ray.secant));
    surface = vec4(ray.origin, lit);
    weight = ray.incident * (ray.secant * transmitted);

    float flux = 0.0;
    float area = 0.0;
    if (plane.by_vertex == 1u) {
        ivec2 node = ivec2(vertex % columns, vertex / columns);
        for (int i = 0; i < 6; i++) {
            ivec2 first = node + neighbour(i);
            ivec2 second = node + neighbour(i + 1);
            if (all(greaterThanEqual(min(first, second), ivec2(0))) && all(lessThan(max(first, second), size))) {
                Ray b = rays.list[first.y * columns + first.x];
                Ray c = rays.list[second.y * columns + second.x];
                vec3 face = cross(b.origin - ray.origin, c.origin - ray.origin);
                face *= sign(dot(face, plane.up));
                if (min(b.enters, c.enters) > 0.0 && min(b.origin.y, c.origin.y) > height) {
                    flux += max(-dot(face, ray.incident + b.incident + c.incident) / 3.0, 0.0);
                    vec2 to_b = place_on_plane(b, height) - place;
                    vec2 to_c = place_on_plane(c, height) - place;
                    area += abs(to_b.x * to_c.y - to_b.y * to_c.x);
                }
            }
        }
    }
    vertex_intensity = area > 0.0 ? flux / area * ray.secant * transmitted : 0.0;
    gl_Position = vec4((place - plane.center) * plane.to_clip, 0.5, 1.0);
}
