// The density functions of the section on modelling and animating the gases. Each moves the point through the solid texture's
// space, along a helix as the frames go on, and makes a density of the turbulence there.

#include "gas/noise.glsl"

// The random numbers of the fog's front (extern float offset[OFFSET_SIZE]).
layout(set = 0, binding = 3, std430) readonly buffer Offsets {
    float offsets[];
};

const uint OFFSET_SIZE = 64u;

const uint CONSTANT = 0u;
const uint TURBULENCE = 1u;
const uint CLOUDS = 2u;
const uint FOG = 3u;
const uint STEAM = 4u;
const uint HYPERTEXTURE = 5u;

// theta = (frame_num mod SWIRL_FRAMES) SWIRL with SWIRL = 2 pi / SWIRL_FRAMES: the text prints a product for the remainder.
vec2 swirl(uint v) {
    float frames = volumes[v].motion.y;
    if (frames <= 0.0) {
        return vec2(0.0);
    }
    float number = frame.sampling.x;
    float theta = 6.2831853 * (number - frames * floor(number / frames)) / frames;
    return vec2(volumes[v].motion.z * cos(theta), volumes[v].motion.w * sin(theta));
}

float interpolated_offset(float at) {
    float low = floor(at);
    uint first = uint(int(low) & int(OFFSET_SIZE - 1u));
    return mix(offsets[first], offsets[(first + 1u) & (OFFSET_SIZE - 1u)], at - low);
}

float cloud_density(uint v, vec3 texture_point) {
    vec3 p = texture_point;
    p.x += noise(p);
    p.y += noise(p);
    // The text's transparency is 1 - pow(sin + 1, power) / 2, which leaves 0..1 for any power but 1; this is equal to it there.
    float wave = 0.5 * (sin(turbulence(p) * volumes[v].gas.w) + 1.0);
    return volumes[v].gas.y * pow(wave, volumes[v].gas.z);
}

// chess_fog. Of the text's `direction.y = pnt.x + cyl.y` we read pnt.y, or the fog would not vary with height; frame / FULL_FOG is
// taken in floats; and as the section says, nothing is in front of the front, and behind it the fog thickens.
float fog_density(uint v, vec3 texture_point, vec3 world) {
    float number = frame.sampling.x;
    float disturbance = turbulence(texture_point);
    float table = interpolated_offset(texture_point.z);
    float front = volumes[v].front.x + volumes[v].front.y * number + volumes[v].detail.x * disturbance
        + volumes[v].detail.y * table;
    if (world.x > front) {
        return 0.0;
    }
    vec3 p = texture_point + vec3(2.0 + disturbance, 0.5 + disturbance, -2.0 - disturbance);
    vec2 cylinder = swirl(v);
    vec3 moved = vec3(p.x - number * volumes[v].motion.x, p.y + cylinder.x, p.z + cylinder.y);
    float thickening = clamp((front - world.x) / volumes[v].front.z, 0.0, 1.0);
    float factor = volumes[v].front.w > 0.0 ? min(number / volumes[v].front.w, 1.0) : 1.0;
    return pow(turbulence(moved) * volumes[v].gas.y * factor, volumes[v].gas.z) * thickening;
}

// Figure 6: the gas rises, so that its texture's point falls, swirls about the vertical, and thins as it moves from its source.
float steam_density(uint v, vec3 texture_point, vec3 world) {
    vec2 ellipse = swirl(v);
    float disturbance = turbulence(texture_point);
    vec3 p = texture_point + vec3(disturbance);
    p.y -= frame.sampling.x * volumes[v].motion.x;
    p.xz += ellipse;
    float height = (world.y - volumes[v].center.y) / volumes[v].half_extent.y * 0.5 + 0.5;
    return pow(turbulence(p) * volumes[v].gas.y, volumes[v].gas.z) * clamp(1.0 - height, 0.0, 1.0);
}

// Reference 17: a soft sphere whose surface the turbulence moves.
float hypertexture_density(uint v, vec3 texture_point, vec3 world) {
    vec3 q = (world - volumes[v].center.xyz) / volumes[v].half_extent.xyz;
    float radius = length(q) * (1.0 + volumes[v].detail.x * turbulence(texture_point));
    return clamp((1.0 - radius) / volumes[v].detail.y, 0.0, 1.0) * volumes[v].gas.y;
}

// The density function of a gas, wherever its solid ends.
float gas_density(uint v, vec3 world) {
    vec3 p = world * volumes[v].placement.w + volumes[v].placement.xyz;
    switch (uint(volumes[v].gas.x)) {
        case CONSTANT:
            return volumes[v].gas.y;
        case TURBULENCE:
            return pow(turbulence(p) * volumes[v].gas.y, volumes[v].gas.z);
        case CLOUDS:
            return cloud_density(v, p);
        case FOG:
            return fog_density(v, p, world);
        case STEAM:
            return steam_density(v, p, world);
        case HYPERTEXTURE:
            return hypertexture_density(v, p, world);
        default:
            return 0.0;
    }
}

// Density inside the solid, faded towards its boundary so that the boundary cannot be seen. Of a hypertexture solid it is the
// extinction that makes opacity = 1 - (1 - density)^(c step), so that gas and solid share one march: -ln(1 - density).
float volume_density(uint v, vec3 world) {
    float inside = inwardness(v, world);
    if (inside < -1.0e-4) {
        return 0.0;
    }
    float density = gas_density(v, world);
    float falloff = volumes[v].half_extent.w;
    if (falloff > 0.0) {
        float t = clamp(inside / falloff, 0.0, 1.0);
        density *= t * t * (3.0 - 2.0 * t);
    }
    return volumes[v].profile.z > 0.0 ? -log(1.0 - clamp(density, 0.0, 0.9999)) : density;
}
