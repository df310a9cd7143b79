// Ratio tracking of the ray towards a light (J. Novak and others, 2014): as delta tracking, but a particle that the ray meets
// takes the fraction that is real, so that the mean is the transparency itself. What is nearly used up goes on by lot.

// Below which a ray goes on by lot.
const float BY_LOT = 0.1;

// From where `light_way` is. Where it is cut, that and `way_draws` stand after the last whole part.
float transmittance_to(uint l, vec3 point) {
    LightRay to_light = ray_to_light(point);
    uint draws = way_draws;
    do {
        take_volume(light_way.volume);
        vec2 segment = intersect(volume_segment(point, to_light.direction), vec2(0.0, to_light.distance_m));
        if (light_way.at_m < segment.x) {
            light_way.at_m = segment.x;
        }
        bool is_over = segment.x >= segment.y || light_way.passed <= 0.0;
        do {
            if (light_way.parts >= MOST_MADE) {
                is_cut = true; // for good: no dispatch gets it further
            }
            if (!is_over) {
                LightWay next = light_way;
                vec3 place = point + to_light.direction * next.at_m;
                Flight flight = through(Flight(0.0, segment.y - next.at_m), place, to_light.direction);
                float free_m = free_way(flight);
                next.at_m += min(free_m, flight.clear_m);
                bool is_end = free_m >= flight.clear_m && next.at_m >= segment.y;
                if (free_m < flight.clear_m) {
                    float extinction = in_hand.tau_per_m * volume_density(point + to_light.direction * next.at_m);
                    next.passed *= max(1.0 - extinction / flight.bound, 0.0);
                    if (next.passed < BY_LOT) {
                        next.passed = drawn() * BY_LOT < next.passed ? BY_LOT : 0.0;
                    }
                    is_end = next.passed <= 0.0;
                }
                next.parts++;
                if (!is_cut) {
                    light_way = next;
                    draws = way_draws;
                    is_over = is_end;
                }
            }
        } while (all(bvec3(!is_over, !is_cut, made < MOST_MADE)));
        if (!is_over) {
            is_cut = true;
        }
        if (!is_cut) {
            light_way = LightWay(light_way.passed, -1.0, light_way.volume + 1u, 0u);
        }
    } while (all(bvec2(light_way.volume < volume_count, !is_cut)));
    if (light_way.volume < volume_count) {
        is_cut = true;
    }
    way_draws = draws;
    float passed = light_way.passed;
    if (!is_cut) {
        light_way = NEW_LIGHT_WAY;
    }
    return passed;
}
