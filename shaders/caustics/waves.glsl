// The water's surface: a sum of sine waves, height = level + sum A sin(k . x - omega t + phi). The thesis leaves the wave function
// to the program; it is its controlled variable (section 5.2). The includer declares the buffer `waves` with the list of waves.

struct Wave {
    vec4 vector; // k along x and z in rad/m, omega in rad/s, phase in rad
    vec4 amplitude; // metres, in x
};

layout(std430, set = 0, binding = 0) readonly buffer Waves {
    Wave list[];
} waves;

// Height above the level in x, slopes along x and z in y and z.
vec3 wave_at(vec2 place, float time_s, uint count) {
    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < count; i++) {
        Wave wave = waves.list[i];
        float angle = dot(wave.vector.xy, place) - wave.vector.z * time_s + wave.vector.w;
        sum.x += wave.amplitude.x * sin(angle);
        sum.yz += wave.amplitude.x * cos(angle) * wave.vector.xy;
    }
    return sum;
}
