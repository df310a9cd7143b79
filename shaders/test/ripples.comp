#version 450
// Equation 1: h(x, t) = 1/2 + 1/2 sin(2 pi (x / L - t / T)).
layout(local_size_x = 64) in;
layout(set = 0, binding = 0, std430) buffer Heights {
    float heights[];
};
layout(push_constant, std430) uniform Wave {
    float wavelength_px;
    float phase_turns;
} wave;

void main() {
    uint column = gl_GlobalInvocationID.x;
    heights[column] = 0.5 + 0.5 * sin(6.2831853 * (float(column) / wave.wavelength_px - wave.phase_turns));
}
