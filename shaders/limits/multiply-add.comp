#version 450

// The device's rate of multiply-adds: eight independent chains of four components a thread, so that no chain waits for itself.

layout(local_size_x = 64) in;

layout(std430, set = 0, binding = 0) buffer Results {
    vec4 list[];
} results;

layout(push_constant) uniform Load {
    uint iterations;
    float factor;
} load;

void main() {
    uint thread = gl_GlobalInvocationID.x;
    vec4 seed = vec4(float(thread) * 1.0e-6) + vec4(0.1, 0.2, 0.3, 0.4);
    vec4 a = seed;
    vec4 b = seed + 1.0;
    vec4 c = seed + 2.0;
    vec4 d = seed + 3.0;
    vec4 e = seed + 4.0;
    vec4 f = seed + 5.0;
    vec4 g = seed + 6.0;
    vec4 h = seed + 7.0;
    for (uint i = 0u; i < load.iterations; i++) {
        a = fma(a, vec4(load.factor), seed);
        b = fma(b, vec4(load.factor), seed);
        c = fma(c, vec4(load.factor), seed);
        d = fma(d, vec4(load.factor), seed);
        e = fma(e, vec4(load.factor), seed);
        f = fma(f, vec4(load.factor), seed);
        g = fma(g, vec4(load.factor), seed);
        h = fma(h, vec4(load.factor), seed);
    }
    results.list[thread] = a + b + c + d + e + f + g + h;
}
