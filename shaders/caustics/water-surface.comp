#version 450

// The water's regular mesh (section 4.3): a sum of sine waves, height = level + sum A sin(k . x - omega t + phi), and its
// analytic normal. The thesis leaves the wave function to the program; it is its controlled variable (section 5.2).

layout(local_size_x = 64) in;

struct Wave {
    vec4 vector; // k along x and z in rad/m, omega in rad/s, phase in rad
    vec4 amplitude; // metres, in x
};

struct WaterVertex {
    vec4 position; // metres
    vec4 normal; // unit
};

layout(std430, set = 0, binding = 0) readonly buffer Waves {
    Wave list[];
} waves;

layout(std430, set = 0, binding = 1) buffer Water {
    WaterVertex vertices[];
} water;

layout(push_constant) uniform Surface {
    vec2 corner; // x and z of the first vertex, metres
    vec2 cell; // cell size along x and z, metres
    uint columns; // vertices along x
    uint rows; // vertices along z
    uint wave_count;
    float level_m;
    float time_s;
} surface;

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= surface.columns * surface.rows) {
        return;
    }
    vec2 place = surface.corner + surface.cell * vec2(float(index % surface.columns), float(index / surface.columns));
    float height = surface.level_m;
    vec2 slope = vec2(0.0);
    for (uint i = 0u; i < surface.wave_count; i++) {
        Wave wave = waves.list[i];
        float angle = dot(wave.vector.xy, place) - wave.vector.z * surface.time_s + wave.vector.w;
        height += wave.amplitude.x * sin(angle);
        slope += wave.amplitude.x * cos(angle) * wave.vector.xy;
    }
    water.vertices[index].position = vec4(place.x, height, place.y, 1.0);
    water.vertices[index].normal = vec4(normalize(vec3(-slope.x, 1.0, -slope.y)), 0.0);
}
