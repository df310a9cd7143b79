// From a point of a surface to the one that a neighbouring pixel shows, in its plane: `facing` is normal to it.

vec3 footprint_along(vec3 facing, vec3 ray, float depth, vec3 ray_per_pixel) {
    float slope = dot(facing, ray);
    // The plane's points have dot(facing, ray) depth in common.
    float change = abs(slope) > 1.0e-12 ? -dot(facing, ray_per_pixel) / slope : 0.0;
    return depth * (ray_per_pixel + change * ray);
}
