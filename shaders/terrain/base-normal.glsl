#include "terrain/kinds.glsl"

// The base's normal below a point of the world `height_m` over it.
vec3 up_at(vec3 point, float height_m) {
    vec3 from_center = point - light.base_center;
    float along = dot(from_center, light.base_axis);
    vec3 across = from_center - along * light.base_axis;
    vec2 squares = light.base_radii * light.base_radii;
    float radius = max(length(across), 1.0e-20);
    if (is_kind(light.base_kind, PLANE, radius)) {
        return vec3(0.0, 1.0, 0.0);
    }
    vec2 up = vec2(radius, 0.0);
    if (!is_kind(light.base_kind, CYLINDER, radius)) {
        // The point is (N + h) cos, (N b^2 / a^2 + h) sin of the latitude, whose radius of curvature N changes little with it.
        up = vec2(radius, along) / squares;
        for (int i = 0; i < 4; i++) {
            up = normalize(up);
            float n = squares.x / sqrt(dot(squares, up * up));
            up = vec2(radius, along) / (vec2(n, n * squares.y / squares.x) + height_m);
        }
    }
    return normalize(up.x / radius * across + up.y * light.base_axis);
}
