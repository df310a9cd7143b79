// Ratio tracking of the ray towards a light (J. Novak and others, 2014): as delta tracking, but a particle that the ray meets
// takes the fraction that is real, so that the mean is the transparency itself. What is nearly used up goes on by lot.

// Below which a ray goes on by lot.
const float BY_LOT = 0.1;

float transmittance_to(uint l, vec3 point) {
    LightRay to_light = ray_to_light(point);
    float passed = 1.0;
    uint v = 0u;
    for (; v < volume_count; v++) {
        take_volume(v);
        vec2 segment = intersect(volume_segment(point, to_light.direction), vec2(0.0, to_light.distance_m));
        float at_m = segment.x;
        bool is_over = segment.x >= segment.y || passed <= 0.0;
        uint parts = 0u;
        while (!is_over && !is_cut && parts < MOST_MADE) {
            vec3 place = point + to_light.direction * at_m;
            Flight flight = through(Flight(0.0, segment.y - at_m), place, to_light.direction);
            float free_m = free_way(flight);
            at_m += min(free_m, flight.clear_m);
            is_over = free_m >= flight.clear_m && at_m >= segment.y;
            if (free_m < flight.clear_m) {
                float extinction = in_hand.tau_per_m * volume_density(point + to_light.direction * at_m);
                passed *= max(1.0 - extinction / flight.bound, 0.0);
                if (passed < BY_LOT) {
                    passed = drawn() * BY_LOT < passed ? BY_LOT : 0.0;
                }
                is_over = passed <= 0.0;
            }
            parts++;
        }
        is_cut = is_cut || !is_over;
    }
    is_cut = is_cut || v < volume_count;
    return passed;
}
