// The density functions of the section on modelling and animating the gases. Each moves the point through the solid
// texture's space, along a helix as the frames go on, and makes a density of the turbulence there.

#include "gas/densest.glsl"
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

float interpolated_offset(float at) {
    float low = floor(at);
    uint first = uint(int(low) & int(OFFSET_SIZE - 1u));
    return mix(offsets[first], offsets[(first + 1u) & (OFFSET_SIZE - 1u)], at - low);
}

// The density function of the volume in hand, wherever its solid ends. Each takes noise or turbulence up to three times,
// one after the other, at points that follow from what it took before; all share one place in the code where it is taken,
// or a compiler that inlines makes dozens of copies.
//
// - clouds: the text's transparency is 1 - pow(sin + 1, power) / 2, which leaves 0..1 for any power but 1; 1 - pow((sin
//   + 1) / 2, power) is equal to it there.
// - fog (chess_fog): of the text's `direction.y = pnt.x + cyl.y` we read pnt.y, or the fog would not vary with height;
//   frame / FULL_FOG is taken in floats; and as the section says, no fog is before the front, and behind it the fog
//   thickens.
// - steam (figure 6): it rises, so that its point in the texture falls, swirls about the vertical, and thins with its
//   height.
// - hypertexture (reference 17): a soft sphere whose surface the turbulence moves.
float gas_density(vec3 world) {
    uint kind = in_hand.density_function;
    float opaque = in_hand.opaque;
    float power = in_hand.power;
    if (kind == CONSTANT) {
        return opaque;
    }
    float number = frame.number;
    vec3 p = world * in_hand.texture_scale_per_m + in_hand.texture_offset;
    float factor = opaque;
    float thickness = 1.0;
    uint last = kind == CLOUDS ? 2u : (kind == FOG || kind == STEAM ? 1u : 0u);
    float value = 0.0;
    uint i = 0u;
    bool is_clear = false;
    bool is_whole = false;
    do {
        bool is_last = i == last;
        value = fractal(p, kind == CLOUDS && !is_last);
        if (!is_last && kind == CLOUDS) {
            p += i == 0u ? vec3(value, 0.0, 0.0) : vec3(0.0, value, 0.0);
        } else if (!is_last && kind == FOG) {
            float front = in_hand.front_x_m + in_hand.front_per_frame_m * number
                + in_hand.front_turbulence_m * value + in_hand.front_table_m * interpolated_offset(p.z);
            is_clear = world.x > front;
            factor *= in_hand.front_full_frames > 0.0 ? min(number / in_hand.front_full_frames, 1.0) : 1.0;
            p += vec3(2.0 + value, 0.5 + value, -2.0 - value);
            p += vec3(-number * in_hand.along_per_frame, helix);
            thickness = clamp((front - world.x) / in_hand.front_depth_m, 0.0, 1.0);
        } else if (!is_last) {
            p += vec3(helix.x + value, value - number * in_hand.along_per_frame, helix.y + value);
        }
        if (is_last || is_clear) {
            is_whole = true;
        }
        i++;
    } while (all(bvec2(i <= last, !is_clear)));
    is_cut = is_cut || !is_whole;
    if (is_clear) {
        return 0.0;
    }
    if (kind == CLOUDS) {
        // A device's sine may be a little below -1.
        return opaque * pow(max(0.5 * (sin(value * in_hand.frequency) + 1.0), 0.0), power);
    }
    if (kind == HYPERTEXTURE) {
        vec3 q = (world - in_hand.center) / in_hand.half_extent_m;
        float radius = length(q) * (1.0 + in_hand.hypertexture_amplitude * value);
        return clamp((1.0 - radius) / in_hand.hypertexture_softness, 0.0, 1.0) * opaque;
    }
    float density = min(pow(value * factor, power), MOST_DENSITY);
    if (kind == FOG) {
        density *= thickness;
    } else if (kind == STEAM) {
        float height = (world.y - in_hand.center.y) / in_hand.half_extent_m.y * 0.5 + 0.5;
        density *= clamp(1.0 - height, 0.0, 1.0);
    }
    return density;
}
