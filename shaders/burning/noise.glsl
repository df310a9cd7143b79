// A smooth noise of the plane, 0 to 1: random values at whole places, blended by cubics.

#include "burning/lattice.glsl"

float lattice(ivec2 at) {
    return mixed(uint(at.x) * 0x8da6b343u ^ uint(at.y) * 0xd8163841u);
}

float noise(vec2 at) {
    ivec2 cell = ivec2(floor(at));
    vec2 t = at - vec2(cell);
    t = t * t * (3.0 - 2.0 * t);
    float low = mix(lattice(cell), lattice(cell + ivec2(1, 0)), t.x);
    float high = mix(lattice(cell + ivec2(0, 1)), lattice(cell + ivec2(1, 1)), t.x);
    return mix(low, high, t.y) * (1.0 / 65535.0);
}
