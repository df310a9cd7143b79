// The scene as seen from above the water (chapter 1, section 2.4): what is refracted at the surface comes from the colour and the
// depth texture of the underwater scene, what is reflected from the sky, weighted by Fresnel's equations. The includer declares the
// constants `water` and the function `surface_at`: the water's height above its level and its slopes.

#include "caustics/refraction.glsl"
#include "caustics/surface.glsl"

layout(set = 0, binding = 1) uniform texture2D underwater_color;
layout(set = 0, binding = 2) uniform texture2D underwater_depth;
layout(set = 0, binding = 3) uniform sampler nearest;

layout(set = 0, binding = 4) uniform View {
    mat4 inverse_view_projection; // of the viewer
    mat4 underwater_view_projection; // of the textures' camera
    mat4 underwater_inverse;
    vec3 eye; // of the viewer, metres
    float level_m; // height of the flat water
    vec3 underwater_eye; // of the textures' camera, metres
    vec2 picture_size; // pixels
    vec2 texture_size; // texels
} view;

layout(location = 0) out vec4 color;

const vec3 DEEP_WATER = vec3(0.004, 0.030, 0.055); // light scattered back by deep water, as the cast's background
const int SURFACE_STEPS = 5; // Newton's method converges in three on waves of moderate slope
const int SCENE_STEPS = 64;
const int REFINEMENTS = 8;
const float SAME_SURFACE = 0.02; // what neighbouring texels see may lie this fraction of the camera's distance apart

vec3 sky(vec3 direction) {
    float height = clamp(direction.y, 0.0, 1.0);
    return mix(vec3(0.75, 0.85, 0.95), vec3(0.18, 0.36, 0.70), sqrt(height));
}

// Unpolarised reflectance of a dielectric.
float fresnel(float cos_incident, float cos_refracted, float eta) {
    float parallel = (cos_incident - eta * cos_refracted) / (cos_incident + eta * cos_refracted);
    float perpendicular = (eta * cos_incident - cos_refracted) / (eta * cos_incident + cos_refracted);
    return 0.5 * (parallel * parallel + perpendicular * perpendicular);
}

vec3 unproject(mat4 inverse, vec2 ndc, float depth) {
    vec4 point = inverse * vec4(ndc, depth, 1.0);
    return point.xyz / point.w;
}

// Position of a point of the world in the underwater textures, texels.
vec2 place_of(vec3 point) {
    vec4 clip = view.underwater_view_projection * vec4(point, 1.0);
    vec2 uv = 0.5 * clip.xy / max(clip.w, 1.0e-6) + 0.5;
    return clamp(uv * view.texture_size, vec2(0.0), view.texture_size - 1.0);
}

// The point of the world that the underwater camera sees in a texel.
vec3 seen_at(ivec2 texel, float depth) {
    vec2 there = (vec2(texel) + 0.5) / view.texture_size * 2.0 - 1.0;
    return unproject(view.underwater_inverse, there, depth);
}

// Distance of a point behind the surface that the underwater camera sees in its direction, metres; negative in front of it, and
// where nothing is seen.
float depth_behind(vec3 point) {
    ivec2 texel = ivec2(place_of(point));
    float depth = texelFetch(sampler2D(underwater_depth, nearest), texel, 0).r;
    if (depth >= 1.0) {
        return -1.0;
    }
    return distance(point, view.underwater_eye) - distance(seen_at(texel, depth), view.underwater_eye);
}

// Light from a point: interpolated between the four nearest texels, but for those that see another surface.
vec3 light_from(vec3 point) {
    vec2 place = place_of(point);
    vec2 base = floor(place - 0.5);
    vec2 fraction = place - 0.5 - base;
    float near_m = SAME_SURFACE * distance(point, view.underwater_eye);
    vec3 light = vec3(0.0);
    float total = 0.0;
    for (int i = 0; i < 4; i++) {
        vec2 corner = vec2(float(i & 1), float(i >> 1));
        vec2 weights = mix(1.0 - fraction, fraction, corner);
        ivec2 texel = ivec2(clamp(base + corner, vec2(0.0), view.texture_size - 1.0));
        float depth = texelFetch(sampler2D(underwater_depth, nearest), texel, 0).r;
        float weight = distance(point, seen_at(texel, depth)) <= near_m ? weights.x * weights.y : 0.0;
        light += weight * texelFetch(sampler2D(underwater_color, nearest), texel, 0).rgb;
        total += weight;
    }
    // What a ray came closest to is not where it ends: the texel in its direction stands for it.
    return total > 0.0 ? light / total : texelFetch(sampler2D(underwater_color, nearest), ivec2(place), 0).rgb;
}

void main() {
    vec2 ndc = 2.0 * gl_FragCoord.xy / view.picture_size - 1.0;
    vec3 ray = normalize(unproject(view.inverse_view_projection, ndc, 1.0) - view.eye);
    if (ray.y > -1.0e-3) {
        color = vec4(sky(ray), 1.0);
        return;
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
        color = vec4(sky(mirrored), 1.0);
        return;
    }

    // What the refracted ray hits: followed through the depth texture until it runs behind what is seen there. Far behind means
    // that it passes behind an object, which is no hit.
    float reach = max(water.floor_depth_m + surface.y - view.level_m, 0.0) / max(-refracted.y, 0.05) * 1.05;
    float stride = reach / float(SCENE_STEPS);
    float travel = 0.0;
    float nearer = 0.0;
    bool hit = false;
    // A ray that passes behind an object may end where the textures never look; what it came closest to then stands for it.
    float closest = 1.0e30;
    float closest_travel = -1.0;
    for (int i = 1; i <= SCENE_STEPS; i++) {
        travel = stride * float(i);
        float behind = depth_behind(surface + refracted * travel);
        if (behind > 0.0 && behind < 2.0 * stride) {
            hit = true;
            break;
        }
        if (behind > 0.0 && behind < closest) {
            closest = behind;
            closest_travel = travel;
        }
        nearer = travel;
    }
    if (!hit) {
        travel = closest_travel;
    } else {
        float farther = travel;
        for (int i = 0; i < REFINEMENTS; i++) {
            travel = 0.5 * (nearer + farther);
            if (depth_behind(surface + refracted * travel) > 0.0) {
                farther = travel;
            } else {
                nearer = travel;
            }
        }
        travel = farther;
    }
    vec3 below = DEEP_WATER;
    if (travel >= 0.0) {
        vec3 lit = light_from(surface + refracted * travel);
        below = mix(DEEP_WATER, lit, exp(-water.absorption_per_m * travel));
    }
    float reflectance = fresnel(-dot(ray, normal), -dot(refracted, normal), water.eta);
    color = vec4(mix(below, sky(mirrored), reflectance), 1.0);
}
