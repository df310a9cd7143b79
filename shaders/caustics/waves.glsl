// The water's surface: a sum of sine waves, height = level + sum A sin(k . x - omega t + phi). The thesis leaves the wave function
// to the program; it is its controlled variable (section 5.2). The host takes omega t off the phases: in single precision it
// would lose them in late frames.

struct Wave {
    vec2 vector; // k along x and z, rad/m
    float phase_rad; // of the frame
    float amplitude_m;
};

// A uniform block and not a buffer: of a buffer a CPU loads each number for each invocation anew.
layout(set = 0, binding = 0) uniform Waves {
    vec4 list[64]; // a wave each
} waves;

Wave wave_of(uint i) {
    vec4 wave = waves.list[i];
    return Wave(wave.xy, wave.z, wave.w);
}

// Height above the level in x, slopes along x and z in y and z.
vec3 wave_at(vec2 place, uint count) {
    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < count; i++) {
        Wave wave = wave_of(i);
        float angle = dot(wave.vector, place) + wave.phase_rad;
        sum.x += wave.amplitude_m * sin(angle);
        sum.yz += wave.amplitude_m * cos(angle) * wave.vector;
    }
    return sum;
}
