// Bounds of the density functions, from what they are made of. Noise is a mean of eight products of a gradient, whose
// components are 1 at most, and an offset, by weights s and 1 - s along each axis: at most (1 - s) t + s (1 - t), which is
// 1 / 2 at most, for each axis. Octaves of turbulence halve, so that it lies between 0 and 3. The random numbers of the
// fog's front are 1 at most.

const float MOST_TURBULENCE = 3.0;

const uint CONSTANT = 0u;
const uint CLOUDS = 2u;
const uint FOG = 3u;
const uint STEAM = 4u;
const uint HYPERTEXTURE = 5u;

// The greatest density between two corners of a box, in units of half the volume's box from its middle.
float gas_bound(uint v, vec3 low, vec3 high) {
    uint kind = in_hand.density_function;
    float opaque = in_hand.opaque;
    if (kind == CONSTANT || kind == CLOUDS) {
        return opaque;
    }
    if (kind == HYPERTEXTURE) {
        // Turbulence makes the radius larger only.
        vec3 nearest = max(max(low, -high), 0.0);
        return opaque * clamp((1.0 - length(nearest)) / in_hand.hypertexture_softness, 0.0, 1.0);
    }
    float thickness = 1.0;
    if (kind == FOG) {
        float front = in_hand.front_x_m + in_hand.front_per_frame_m * frame.number
            + max(in_hand.front_turbulence_m, 0.0) * MOST_TURBULENCE + max(in_hand.front_table_m, 0.0);
        float from = in_hand.center.x + low.x * in_hand.half_extent_m.x;
        thickness = clamp((front - from) / in_hand.front_depth_m, 0.0, 1.0);
        thickness *= in_hand.front_full_frames > 0.0 && frame.number <= 0.0 ? 0.0 : 1.0;
    } else if (kind == STEAM) {
        thickness = clamp(0.5 - 0.5 * low.y, 0.0, 1.0);
    }
    return thickness > 0.0 ? pow(MOST_TURBULENCE * opaque, in_hand.power) * thickness : 0.0;
}
