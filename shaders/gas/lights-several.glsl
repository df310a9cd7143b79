// A scene with any number of lights, whose numbers are read when one is taken in hand.

#include "gas/light.glsl"

uint light_count = 0u;
Light light_in_hand;

void read_lights() {
    light_count = counts.lights;
}

void take_light(uint l) {
    light_in_hand = lights[l];
}

#include "gas/light-rays.glsl"
