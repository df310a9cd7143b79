// Light on the map's texels in units of 2^-18 of I_c, 64 bits a texel: sums of whole numbers are the same in any order (section 6.3).

layout(std430, set = 0, binding = 6) buffer Sums {
    uint list[]; // low and high word of each texel, row by row
} sums;

const float UNITS = 262144.0;

void add_light(ivec2 texel, float light) {
    uint at = 2u * uint(texel.y * int(plane.map_size) + texel.x);
    // A triangle's light in one texel: 16,383 texels' worth at the most.
    uint units = uint(min(light, 16383.0) * UNITS + 0.5);
    if (units > 0u) {
        uint before = atomicAdd(sums.list[at], units);
        if (before > 0xffffffffu - units) {
            atomicAdd(sums.list[at + 1u], 1u);
        }
    }
}

bool is_in_map(ivec2 texel) {
    return all(greaterThanEqual(texel, ivec2(0))) && all(lessThan(texel, ivec2(int(plane.map_size))));
}
