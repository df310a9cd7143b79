#version 450

// A square of the ground below the object, as far as it can be seen.

#include "burning/constants.glsl"
#include "burning/view.glsl"
#include "burning/fading.glsl"

layout(location = 0) out vec3 position;

const float HALF_WIDTH = FADES_TO; // diagonals
// Depth by which the ground lies behind what lies on it in one plane: above what the rounding of both comes to.
const float BEHIND = 2.0e-6;

void main() {
    vec2 corner = vec2(gl_VertexIndex & 1, gl_VertexIndex >> 1) * 2.0 - 1.0;
    position = vec3(HALF_WIDTH * corner.x, constants.floor_y, HALF_WIDTH * corner.y);
    gl_Position = view.view_projection * vec4(position, 1.0);
    gl_Position.z += BEHIND * gl_Position.w;
}
