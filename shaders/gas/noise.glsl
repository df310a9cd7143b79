// Noise and turbulence of "An Image Synthesizer" (reference 16, 1985): a pseudo-random gradient at every lattice point,
// blended by 3 t^2 - 2 t^3; the value at the lattice points is 0, which leaves no frequencies below the lattice's. The
// gradients come from an integer hash of the point, so that host and device agree to the bit on them.

vec3 lattice_gradient(ivec3 cell) {
    uint mixed = uint(cell.x) * 0x8da6b343u ^ uint(cell.y) * 0xd8163841u ^ uint(cell.z) * 0xcb1ab31fu;
    uint h = scramble(mixed ^ frame.noise_seed);
    return vec3(float(h & 1023u), float((h >> 10u) & 1023u), float((h >> 20u) & 1023u)) / 511.5 - 1.0;
}

float lattice_slope(ivec3 cell, ivec3 corner, vec3 from_cell) {
    return dot(lattice_gradient(cell + corner), from_cell - vec3(corner));
}

float noise(vec3 p) {
    vec3 low = floor(p);
    ivec3 cell = ivec3(low);
    vec3 t = p - low;
    vec3 s = t * t * (3.0 - 2.0 * t);
    float x00 = mix(lattice_slope(cell, ivec3(0, 0, 0), t), lattice_slope(cell, ivec3(1, 0, 0), t), s.x);
    float x10 = mix(lattice_slope(cell, ivec3(0, 1, 0), t), lattice_slope(cell, ivec3(1, 1, 0), t), s.x);
    float x01 = mix(lattice_slope(cell, ivec3(0, 0, 1), t), lattice_slope(cell, ivec3(1, 0, 1), t), s.x);
    float x11 = mix(lattice_slope(cell, ivec3(0, 1, 1), t), lattice_slope(cell, ivec3(1, 1, 1), t), s.x);
    return mix(mix(x00, x10, s.y), mix(x01, x11, s.y), s.z);
}

// Noise, or turbulence: its octaves are the scene's, so that the gas is the same from everywhere.
float fractal(vec3 p, bool is_noise) {
    float sum = 0.0;
    float frequency = 1.0;
    float scale = 1.0;
    uint count = is_noise ? min(counts.octaves, 1u) : counts.octaves;
    uint octave = 0u;
    for (; octave < count; octave++) {
        float value = noise(p * frequency);
        sum += is_noise ? value : abs(value) * scale;
        frequency *= 2.0;
        scale *= 0.5;
    }
    is_cut = is_cut || octave < count;
    return sum;
}
