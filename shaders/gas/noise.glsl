// Noise and turbulence of "An Image Synthesizer" (reference 16, 1985): a pseudo-random gradient at every lattice point,
// blended by 3 t^2 - 2 t^3; the value at the lattice points is 0, which leaves no frequencies below the lattice's. The
// gradients come from an integer hash of the point, so that host and device agree to the bit on them.

// Of a lattice point's hash the product of its gradient and an offset, before what all have in common: each component is 10 bits
// h of the hash as h / 511.5 - 1. The bits stay where they are, y and z of the offset come divided by 2^10 and 2^20.
float raw_slope(uint mixed, float x, float y, float z) {
    uint h = scramble(mixed);
    return float(int(h & 0x3ffu)) * x + float(int(h & 0xffc00u)) * y + float(int(h & 0x3ff00000u)) * z;
}

// The mean of the corners' slopes by their weights. That of the offsets themselves is t - s along each axis, so that the -1 of all
// gradients together, and the division, come last.
float noise(vec3 p) {
    vec3 low = floor(p);
    ivec3 cell = ivec3(low);
    vec3 t = p - low;
    vec3 s = t * t * (3.0 - 2.0 * t);
    vec3 a = t * vec3(1.0, 1.0 / 1024.0, 1.0 / 1048576.0);
    vec3 b = (t - 1.0) * vec3(1.0, 1.0 / 1024.0, 1.0 / 1048576.0);
    uint x0 = uint(cell.x) * 0x8da6b343u;
    uint x1 = x0 + 0x8da6b343u;
    uint y0 = uint(cell.y) * 0xd8163841u;
    uint y1 = y0 + 0xd8163841u;
    uint z = uint(cell.z) * 0xcb1ab31fu;
    uint z0 = z ^ frame.noise_seed;
    uint z1 = (z + 0xcb1ab31fu) ^ frame.noise_seed;
    float x00 = mix(raw_slope(x0 ^ y0 ^ z0, a.x, a.y, a.z), raw_slope(x1 ^ y0 ^ z0, b.x, a.y, a.z), s.x);
    float x10 = mix(raw_slope(x0 ^ y1 ^ z0, a.x, b.y, a.z), raw_slope(x1 ^ y1 ^ z0, b.x, b.y, a.z), s.x);
    float x01 = mix(raw_slope(x0 ^ y0 ^ z1, a.x, a.y, b.z), raw_slope(x1 ^ y0 ^ z1, b.x, a.y, b.z), s.x);
    float x11 = mix(raw_slope(x0 ^ y1 ^ z1, a.x, b.y, b.z), raw_slope(x1 ^ y1 ^ z1, b.x, b.y, b.z), s.x);
    vec3 offset = t - s;
    return mix(mix(x00, x10, s.y), mix(x01, x11, s.y), s.z) * (1.0 / 511.5) - (offset.x + offset.y + offset.z);
}

// Noise, or turbulence: its octaves are the scene's, so that the gas is the same from everywhere.
float fractal(vec3 p, bool is_noise) {
    float sum = 0.0;
    float frequency = 1.0;
    float scale = 1.0;
    uint count = is_noise ? min(octaves, 1u) : octaves;
    uint octave = 0u;
    do {
        float value = noise(p * frequency);
        sum += is_noise ? value : abs(value) * scale;
        frequency *= 2.0;
        scale *= 0.5;
        if (octave < count) {
            octave++;
        }
    } while (octave < count);
    is_cut = is_cut || octave < count;
    return count > 0u ? sum : 0.0;
}
