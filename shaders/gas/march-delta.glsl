// Delta tracking, in place of increments (ours; E. Woodcock and others, 1965). Gas is filled up with fictitious particles to
// the bounds of its bricks, so that the way to the next particle is exponentially distributed; a particle that it meets is
// real with the probability density over bound, and sends the light there to the eye, or else the way goes on. The mean of
// many ways is the integral itself, without a step's error: light comes from the element with the probability T tau rho dt.
// Of a section as many ways are followed as an increment has samples; its light and its transparency are their means, and
// those of a pixel's sections are independent, so that the mean of their products is the product of their means.

#include "gas/random.glsl"

// A way that a dispatch does not follow to its end, and the next one goes on with.
struct Way {
    float at_m;
    uint draws; // of its numbers
    uint parts;
    bool is_met; // by a real particle, whose lights it asks
    uint light; // the next one
    vec3 emission; // of those before it
};

const Way NEW_WAY = Way(0.0, 0u, 0u, false, 0u, vec3(0.0));

Way way = NEW_WAY;

void take_up(uvec4 first, uvec4 second) {
    uint parts = first.z & 0x1ffffu;
    bool is_met = (first.z & 0x800000u) != 0u;
    way = Way(uintBitsToFloat(first.x), first.y, parts, is_met, first.z >> 20u & 7u, uintBitsToFloat(second.xyz));
    if (is_met) {
        light_way = LightWay(uintBitsToFloat(first.w), uintBitsToFloat(second.w), first.z >> 17u & 7u, parts);
    }
}

uvec4 first_left() {
    uint numbers = way.parts;
    if (way.is_met) {
        numbers = light_way.parts | light_way.volume << 17u | way.light << 20u | 0x800000u;
    }
    return uvec4(floatBitsToUint(way.at_m), way.draws, numbers, floatBitsToUint(light_way.passed));
}

uvec4 second_left() {
    return floatBitsToUint(vec4(way.emission, light_way.at_m));
}

void take_pixel(uvec2 pixel, uint pixel_index) {}

void read_scene() {
    read_counts();
    read_volumes();
    read_lights();
}

// Only what nothing shines through ends a pixel: an end at a small transparency would be a bias.
bool ends_at(float transparency) {
    return transparency <= 0.0;
}

// One section of a pixel, from the ways on that `begun` has, whose light and transparency are means so far.
Gas march(uint pixel_index, vec3 ray, vec2 segments[MAX_VOLUMES], vec2 extent, float before, uint first_number, Gas begun) {
    float scale = length(ray);
    vec3 direction = ray / scale;
    vec3 side = normalize(cross(direction, abs(direction.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0)));
    Frames frames = Frames(direction, side, cross(side, direction));
    vec3 entry = frame.eye + ray * extent.x;
    float middle = 0.5 * (extent.x + extent.y);
    float length_m = (extent.y - extent.x) * scale;
    bool is_in[MAX_VOLUMES];
    float apart = 1.0e30; // of the densities by which a solid's normal is found
    uint v = 0u;
    for (; v < volume_count; v++) {
        take_volume(v);
        is_in[v] = segments[v].x <= middle && middle <= segments[v].y;
        apart = is_in[v] ? min(apart, 0.25 * in_hand.step_m) : apart;
    }
    is_cut = is_cut || v < volume_count;
    Gas gas = begun;
    gas.evaluations = 0u;
    do {
        begin_way(pixel_index, first_number + gas.increments, way.draws);
        vec3 color = vec3(0.0);
        float transparency = 1.0;
        bool is_over = false;
        do {
            if (way.parts >= MOST_MADE) {
                is_cut = true; // for good: no dispatch gets it further
            }
            vec3 point = entry + direction * way.at_m;
            float at_m = way.at_m;
            float bound = 0.0;
            bool is_real = way.is_met;
            bool has_particle = is_real;
            if (!is_real) {
                Flight flight = Flight(0.0, length_m - at_m);
                for (v = 0u; v < volume_count; v++) {
                    if (is_in[v]) {
                        take_volume(v);
                        flight = through(flight, point, direction);
                    }
                }
                is_cut = is_cut || v < volume_count;
                float free_m = free_way(flight);
                at_m += min(free_m, flight.clear_m);
                is_over = free_m >= flight.clear_m && at_m >= length_m;
                has_particle = free_m < flight.clear_m;
                bound = flight.bound;
            }
            uint evaluations = 0u;
            if (has_particle) {
                point = entry + direction * at_m;
                float densities[MAX_VOLUMES];
                float previous[MAX_VOLUMES];
                float asides[MAX_VOLUMES];
                float aboves[MAX_VOLUMES];
                float extinction = 0.0;
                float densest = 0.0;
                for (v = 0u; v < volume_count; v++) {
                    densities[v] = 0.0;
                    if (is_in[v]) {
                        take_volume(v);
                        densities[v] = volume_density(point);
                        evaluations++;
                        densest = max(densest, densities[v]);
                        extinction += in_hand.tau_per_m * densities[v];
                    }
                }
                is_cut = is_cut || v < volume_count;
                is_real = way.is_met || drawn() * bound < extinction;
                if (is_real) {
                    if (!is_cut && !way.is_met) {
                        way = Way(at_m, way_draws, 0u, true, 0u, vec3(0.0));
                    }
                    for (v = 0u; v < volume_count; v++) {
                        take_volume(v);
                        if (densities[v] > 0.0 && in_hand.is_solid != 0u) {
                            // Behind, beside and above.
                            uint place = 0u;
                            do {
                                vec3 offset = -direction * apart;
                                if (place > 0u) {
                                    offset = (place == 1u ? frames.side : frames.up) * (0.25 * in_hand.step_m);
                                }
                                float density = volume_density(point + offset);
                                if (place == 0u) {
                                    previous[v] = density;
                                } else if (place == 1u) {
                                    asides[v] = density;
                                } else {
                                    aboves[v] = density;
                                }
                                if (place < 3u) {
                                    place++;
                                }
                            } while (place < 3u);
                            is_cut = is_cut || place < 3u;
                            evaluations += 3u;
                        }
                    }
                    is_cut = is_cut || v < volume_count;
                    uint l = way.light;
                    vec3 emission = l == 0u ? own_emission(point, densities) : way.emission;
                    do {
                        emission += emission_by(l, point, frames, densest, apart, densities, previous, asides, aboves);
                        if (way.is_met) {
                            way.draws = way_draws;
                        }
                        if (!is_cut) {
                            l++;
                            way.light = l;
                            way.emission = emission;
                        }
                    } while (all(bvec2(l < light_count, !is_cut)));
                    is_cut = is_cut || l < light_count;
                    color = emission / extinction;
                    transparency = 0.0;
                    is_over = true;
                }
            }
            if (!is_cut) {
                gas.evaluations += evaluations;
                if (!is_real) {
                    way = Way(at_m, way_draws, way.parts + 1u, false, 0u, vec3(0.0));
                }
            }
        } while (all(bvec3(!is_over, !is_cut, made < MOST_MADE)));
        is_cut = is_cut || !is_over;
        if (!is_cut) {
            way = NEW_WAY;
            gas.increments++;
            float part = 1.0 / float(gas.increments);
            gas.color = mix(gas.color, color, part);
            gas.transparency = mix(gas.transparency, transparency, part);
            gas.is_done = gas.increments >= sample_count;
        }
    } while (all(bvec3(!gas.is_done, !is_cut, made < MOST_MADE)));
    return gas;
}
