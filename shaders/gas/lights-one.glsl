// A scene with one light, whose numbers are read once, see volumes-one.glsl.

#include "gas/light.glsl"

const uint light_count = 1u;

Light light_in_hand;

void read_lights() {
    light_in_hand = lights[0];
}

void take_light(uint l) {}

#include "gas/light-rays.glsl"
