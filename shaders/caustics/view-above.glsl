// The scene as seen from above the water (chapter 1, section 2.4): what is refracted at the surface comes from the underwater scene,
// what is reflected from the sky, weighted by Fresnel's equations. The includer declares the constants `water` and the function
// `surface_at`: the water's height above its level and its slopes.

#include "caustics/refraction.glsl"
#include "caustics/surface.glsl"
#include "caustics/fresnel.glsl"
#include "caustics/view.glsl"

layout(location = 0) out vec4 color; // alpha 0 where a ray did not end

const int SURFACE_STEPS = 5; // Newton's method converges in three on waves of moderate slope

vec3 sky(vec3 direction) {
    float height = clamp(direction.y, 0.0, 1.0);
    return mix(vec3(0.75, 0.85, 0.95), vec3(0.18, 0.36, 0.70), sqrt(height));
}

float certain = 1.0;

// Light that comes along a ray from above; `certain` becomes 0 where it did not end.
vec3 seen_along(vec3 ray) {
    if (ray.y > -1.0e-3) {
        return sky(ray);
    }

    // Ray parameter t at the waves, metres.
    float t = (view.level_m - view.eye.y) / ray.y;
    vec3 wave = vec3(0.0);
    for (int i = 0; i < SURFACE_STEPS; i++) {
        vec3 point = view.eye + ray * t;
        wave = surface_at(point.xz);
        float above = point.y - view.level_m - wave.x;
        float rate = min(ray.y - dot(wave.yz, ray.xz), -0.02);
        t -= above / rate;
    }
    vec3 surface = view.eye + ray * t;
    // Far waves are smaller than a pixel; their slopes would be noise.
    vec3 normal = surface_normal(wave.yz / (1.0 + 0.002 * t * t));
    vec3 mirrored = reflect(ray, normal);
    vec3 refracted;
    if (!refract_ray(ray, normal, water.eta, refracted)) {
        return sky(mirrored);
    }
    vec3 below = DEEP_WATER;
    Hit hit = first_hit(surface, refracted, view.node_count, view.most_steps);
    certain = hit.is_certain ? certain : 0.0;
    if (hit.distance_m > 0.0) {
        vec3 lit = light_from(surface + refracted * hit.distance_m, hit.normal);
        below = mix(DEEP_WATER, lit, exp(-water.absorption_per_m * hit.distance_m));
    }
    float reflectance = fresnel(-dot(ray, normal), -dot(refracted, normal), water.eta);
    return mix(below, sky(mirrored), reflectance);
}

void main() {
    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < view.samples; i++) {
        // A picture holds no more than 1; a brighter sample would hide an edge.
        sum += min(seen_along(ray_through(sample_place(gl_FragCoord.xy, i))), vec3(1.0));
    }
    color = vec4(sum / float(view.samples), certain);
}
