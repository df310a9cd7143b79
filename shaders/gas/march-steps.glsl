// Section "Volume rendering". Each section is marched in increments of the step, the last one scaled, with a sample at a random
// point of each, or of each of its parts (Monte Carlo).
//
// - An increment adds T_before albedo (1 - exp(-tau rho dt)) sum(I_i phase), premultiplied. The text's sum adds I rho
//   dt: tau is missing there, and this is its exact integral for constant density.
// - Volumes that overlap are marched once, with their extinctions and emissions added.
// - The text's loops shade inside `if self_shadowing`, their indentation is lost: gas is shaded with and without
//   shadows, once, after all lights. Phase functions integrate to 1, and light is in units in which a white surface
//   that faces an irradiance of 1 shows 1, not 1 / pi: hence the phase's factor of pi.
// - Where bricks are skipped (empty-skipped.glsl), the march goes on with the increment that the brick ends in: what it
//   leaves out adds nothing, and samples keep their random numbers.
// - Solid (hypertexture) volumes: opacity is 1 - (1 - density)^(c step); the normal is from the density at the previous
//   point, at this one, and in two directions orthogonal to the ray.

const float SOLID_OPACITY = 0.99; // of which no more is marched

// In the order of the host's `Jitter`.
const uint RANDOM = 0u;
const uint BLUE_NOISE = 1u;
const uint MASK_SIDE = 64u;

layout(set = 0, binding = 21, std430) readonly buffer Jitter {
    uint ranks[]; // of the texels of a mask of blue noise, row by row
};

// Of the pixel in hand, and of the frame.
uint pixel_key = 0u;
uint frame_key = 0u;
float place_of_ray = -1.0; // of all its samples, where there is one

// By the mask all samples of a ray lie at one place of their parts, which goes on by the golden ratio from frame to frame:
// errors then depend on it alone, and differ from pixel to pixel as the mask does.
void take_pixel(uvec2 pixel, uint pixel_index) {
    pixel_key = pixel_index * 0x9e3779b9u;
    frame_key = scramble(frame.noise_seed + uint(frame.number));
    if (jitter_kind == BLUE_NOISE) {
        uvec2 texel = pixel % uvec2(MASK_SIDE);
        uint h = (ranks[texel.y * MASK_SIDE + texel.x] << 20u) + 0x80000u;
        h += uint(frame.number) * 0x9e3779b9u;
        place_of_ray = float(h >> 8u) / 16777216.0;
    }
}

// A number of 0 to 1 for a sample of the pixel.
float place_in_part(uint number) {
    uint h = scramble(pixel_key ^ scramble(number ^ frame_key));
    return place_of_ray >= 0.0 ? place_of_ray : float(h >> 8u) / 16777216.0;
}

// No part of an increment is left for another dispatch.
void take_up(uvec4 first, uvec4 second) {}

uvec4 first_left() {
    return uvec4(0u);
}

uvec4 second_left() {
    return uvec4(0u);
}

void read_scene() {
    read_counts();
    read_volumes();
    read_lights();
}

// Of all that is before it, the transparency at which a pixel's tracing ends.
bool ends_at(float transparency) {
    return transparency < frame.early_end;
}

// One section of a pixel, from the increments on that `begun` has; the samples before it are counted so that every
// increment has its own random number.
Gas march(uint pixel_index, vec3 ray, vec2 segments[MAX_VOLUMES], vec2 extent, float before, uint first_number, Gas begun) {
    float scale = length(ray);
    vec3 direction = ray / scale;
    vec3 side = normalize(cross(direction, abs(direction.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0)));
    vec3 up = cross(side, direction);
    vec3 entry = frame.eye + ray * extent.x;
    float middle = 0.5 * (extent.x + extent.y);
    float step_m = 1.0e30;
    bool is_in[MAX_VOLUMES];
    float previous[MAX_VOLUMES]; // densities, for the normals of solids
    bool has_solid = false;
    uint v = 0u;
    for (; v < volume_count; v++) {
        previous[v] = 0.0;
        is_in[v] = segments[v].x <= middle && middle <= segments[v].y;
        if (is_in[v]) {
            take_volume(v);
            step_m = min(step_m, in_hand.step_m);
            has_solid = has_solid || in_hand.is_solid != 0u;
        }
    }
    is_cut = is_cut || v < volume_count;
    step_m /= float(sample_count);
    float early = has_solid ? max(frame.early_end, 1.0 - SOLID_OPACITY) : frame.early_end;
    float length_m = (extent.y - extent.x) * scale;
    Gas gas = begun;
    gas.evaluations = 0u;
    float previous_m = 0.0;
    // A solid's march begins with the density at its entry, or at the sample before, which nothing is added for.
    bool is_entry = has_solid;
    do {
        uint increments = is_entry && gas.increments > 0u ? gas.increments - 1u : gas.increments;
        float from = float(increments) * step_m;
        float increment = min(step_m, length_m - from);
        float at_m = from + increment * place_in_part(first_number + increments);
        if (is_entry && gas.increments == 0u) {
            at_m = 0.0;
        }
        vec3 point = entry + direction * at_m;
        float densities[MAX_VOLUMES];
        float asides[MAX_VOLUMES];
        float aboves[MAX_VOLUMES];
        float extinction = 0.0;
        float densest = 0.0;
        float clear_m = 1.0e30; // along which no volume has density
        uint evaluations = 0u;
        for (v = 0u; v < volume_count; v++) {
            densities[v] = 0.0;
            take_volume(v);
            float empty = is_in[v] ? empty_m(point, direction) : 1.0e30;
            clear_m = min(clear_m, empty);
            if (empty <= 0.0) {
                // At the point, and for a solid in two directions orthogonal to the ray.
                float apart = 0.25 * in_hand.step_m;
                uint count = in_hand.is_solid != 0u ? 3u : 1u;
                uint i = 0u;
                do {
                    vec3 offset = i == 0u ? vec3(0.0) : (i == 1u ? side : up) * apart;
                    float density = volume_density(point + offset);
                    if (i == 0u) {
                        densities[v] = density;
                    } else if (i == 1u) {
                        asides[v] = density;
                    } else {
                        aboves[v] = density;
                    }
                    if (i < count) {
                        i++;
                    }
                } while (i < count);
                is_cut = is_cut || i < count;
                evaluations += count;
                densest = max(densest, densities[v]);
                extinction += in_hand.tau_per_m * densities[v];
            }
        }
        is_cut = is_cut || v < volume_count;
        vec3 emission = vec3(0.0);
        if (extinction > 0.0 && !is_entry) {
            float since_m = max(at_m - previous_m, 1.0e-3 * step_m);
            Frames frames = Frames(direction, side, up);
            emission = emission_at(point, frames, densest, since_m, densities, previous, asides, aboves);
        }
        for (v = 0u; v < volume_count; v++) {
            previous[v] = densities[v];
        }
        is_cut = is_cut || v < volume_count;
        previous_m = at_m;
        // Nothing is kept of an increment that was not done to its end.
        if (!is_cut && is_entry) {
            gas.evaluations += gas.increments == 0u ? evaluations : 0u;
            is_entry = false;
        } else if (!is_cut) {
            if (extinction > 0.0) {
                float passed = exp(-extinction * increment);
                gas.color += emission / extinction * (gas.transparency * (1.0 - passed));
                gas.transparency *= passed;
            }
            gas.evaluations += evaluations;
            gas.increments++;
            if (clear_m > 0.0) {
                // On to the increment that the brick ends in; a solid's march goes on from the sample before that.
                uint skipped = uint(min(at_m + clear_m, length_m) / step_m);
                if (skipped > gas.increments) {
                    gas.increments = skipped;
                    from = float(skipped - 1u) * step_m;
                    float part = place_in_part(first_number + skipped - 1u);
                    previous_m = from + min(step_m, length_m - from) * part;
                }
            }
            gas.is_done = float(gas.increments) * step_m >= length_m || before * gas.transparency < early;
        }
    } while (all(bvec3(!gas.is_done, !is_cut, made < MOST_MADE)));
    return gas;
}
