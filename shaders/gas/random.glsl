// Ways through gas that is filled up to the bounds of its bricks, and their random numbers. Where bounds lie so far above the
// density that a part of a way is shorter than the last bit of the way so far, it never ends: whoever follows a way gives it up
// after MOST_MADE parts, for not every device ends a loop by itself.

#include "gas/bricks.glsl"

uint way_key = 0u;
uint way_draws = 0u;

// The numbers of a way follow from its pixel and its number, whichever dispatch follows it; so many of them were drawn before.
void begin_way(uint pixel_index, uint number, uint draws) {
    way_key = scramble(pixel_index * 0x9e3779b9u ^ scramble(number ^ scramble(frame.noise_seed + uint(frame.number))));
    way_draws = draws;
}

// Between 0 and 1, neither of them.
float drawn() {
    way_draws++;
    return (float(scramble(way_key ^ scramble(way_draws * 0x9e3779b9u)) >> 9u) + 0.5) / 8388608.0;
}

// The next part of a way.
struct Flight {
    float bound; // of the extinction in it, per metre
    float clear_m; // its length
};

// A bound holds for so many bricks beyond its own, see bricks.comp: the way goes on inside the next one.
const float BEYOND = 5.0e-4;

// The part of a way that the volume in hand is in as well.
Flight through(Flight flight, vec3 point, vec3 direction) {
    vec3 scale = bricks_a_metre();
    vec3 at = (point - in_hand.center) * scale + 0.5 * float(brick_count);
    ivec3 brick = brick_of(at);
    vec3 along = direction * scale;
    float most = max(abs(along.x), max(abs(along.y), abs(along.z)));
    float clear_m = max(way_through(brick, at, along), 0.0) + BEYOND / most;
    made++;
    float bound = flight.bound + in_hand.tau_per_m * brick_bounds[brick_at(index_in_hand, brick)];
    return Flight(bound, min(flight.clear_m, clear_m));
}

// Metres to the next particle.
float free_way(Flight flight) {
    float depth = -log(drawn());
    return depth < flight.bound * flight.clear_m ? depth / flight.bound : 1.0e30;
}

// A way to the light in hand that a dispatch has not followed to its end, and the next one goes on with.
struct LightWay {
    float passed;
    float at_m; // in the volume; negative before it
    uint volume;
    uint parts; // in the volume
};

const LightWay NEW_LIGHT_WAY = LightWay(1.0, -1.0, 0u, 0u);

LightWay light_way = NEW_LIGHT_WAY;
