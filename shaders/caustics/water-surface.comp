#version 450

// The vertices of the water's regular mesh (section 4.3) with their analytic normals, under waves.

#include "caustics/surface.glsl"
#include "caustics/waves.glsl"

layout(local_size_x = 64) in;

#include "common/elements.glsl"

struct WaterVertex {
    vec4 position; // homogeneous point, metres
    vec4 normal; // homogeneous unit direction
};

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
} surface;

void main() {
    uint index = element(64u);
    if (index >= surface.columns * surface.rows) {
        return;
    }
    vec2 place = surface.corner + surface.cell * vec2(float(index % surface.columns), float(index / surface.columns));
    vec3 wave = wave_at(place, surface.wave_count);
    water.vertices[index].position = vec4(place.x, surface.level_m + wave.x, place.y, 1.0);
    water.vertices[index].normal = vec4(surface_normal(wave.yz), 0.0);
}
