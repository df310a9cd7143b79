#version 450

// The ground, which fades into the background, with the ash that has come down on it.

#include "burning/constants.glsl"
#include "burning/view.glsl"
#include "burning/ash.glsl"
#include "burning/fading.glsl"
#include "burning/noise.glsl"
#include "burning/light-flames.glsl"

layout(set = 0, binding = 71, std430) readonly buffer Ash {
    uint ash[];
};

layout(location = 0) in vec3 position;

layout(location = 0) out vec4 shaded;

const vec3 GROUND = vec3(0.15, 0.14, 0.13);
const vec3 ASH_COLOR = vec3(0.42, 0.41, 0.4);

// Parts of triangles over a cell, by a quadratic B-spline of the 3 x 3 cells around.
float ash_at(vec2 xz) {
    vec2 at = ash_coordinates(xz);
    ivec2 middle = ivec2(floor(at));
    vec2 t = at - vec2(middle);
    vec2 weights[3] = vec2[3](0.5 * (1.0 - t) * (1.0 - t), 0.5 + t * (1.0 - t), 0.5 * t * t);
    float sum = 0.0;
    for (int i = 0; i < 9; i++) {
        ivec2 cell = middle + ivec2(i % 3, i / 3) - 1;
        if (all(greaterThanEqual(cell, ivec2(0))) && all(lessThan(cell, ivec2(ASH_CELLS)))) {
            sum += weights[i % 3].x * weights[i / 3].y * float(ash[cell.y * ASH_CELLS + cell.x]);
        }
    }
    return sum;
}

void main() {
    float cell_width = 2.0 * ASH_HALF_WIDTH / float(ASH_CELLS);
    // How many times the triangles that came down would cover the cell, about.
    float layers = 0.43 / float(ASH_PARTS) * ash_at(position.xz) * constants.mean_edge * constants.mean_edge / (cell_width * cell_width);
    float grain = 0.6 + 0.8 * noise(position.xz * 160.0);
    float covered = 1.0 - exp(-0.5 * layers * grain);
    vec3 ground = GROUND * (0.9 + 0.2 * noise(position.xz * 24.0));
    float light = view.ambient + (1.0 - view.ambient) * view.to_light.y;
    float alpha = 1.0 - smoothstep(FADES_FROM, FADES_TO, length(position.xz));
    vec3 albedo = mix(ground, ASH_COLOR * (0.7 + 0.3 * grain), covered);
    shaded = vec4(shone_on(albedo, light, position, vec3(0.0, 1.0, 0.0)) * alpha, alpha);
}
