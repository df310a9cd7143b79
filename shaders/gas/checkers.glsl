// Squares of two colours in all three dimensions, integrated over a pixel's footprint on the surface, direction by direction.

#include "gas/surface-footprint.glsl"

// Mean of 1 in even and -1 in odd intervals of length 1, over a width around a place.
float mean_side(float place, float width) {
    float side = mod(floor(place), 2.0) < 0.5 ? 1.0 : -1.0;
    // Its integral goes up and down between 0 and 1.
    float low = 1.0 - abs(mod(place - 0.5 * width, 2.0) - 1.0);
    float high = 1.0 - abs(mod(place + 0.5 * width, 2.0) - 1.0);
    return width < 1.0e-3 ? side : clamp((high - low) / width, -1.0, 1.0);
}

vec3 checkered(Material material, vec3 color, vec3 point, vec3 normal, vec3 ray) {
    float edge_m = material.checker_edge_m;
    if (edge_m <= 0.0) {
        return color;
    }
    // Half a square up, so that boards that lie on a border of squares have one colour.
    vec3 at = (point - material.offset_m) / edge_m + vec3(0.0, 0.5, 0.0);
    float depth = dot(point - frame.eye, frame.forward);
    vec3 across = footprint_along(normal, ray, depth, frame.ray_per_column);
    vec3 along = footprint_along(normal, ray, depth, frame.ray_per_row);
    vec3 width = min((abs(across) + abs(along)) / edge_m, vec3(1.0e3));
    vec3 sides = vec3(mean_side(at.x, width.x), mean_side(at.y, width.y), mean_side(at.z, width.z));
    return mix(material.checker_color, color, 0.5 + 0.5 * sides.x * sides.y * sides.z);
}
