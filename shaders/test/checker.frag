#version 450

// A chessboard of squares of 8 texels; every other one is left out.

layout(location = 0) out vec4 target;

void main() {
    uvec2 square = uvec2(gl_FragCoord.xy) / uvec2(8u);
    if ((square.x + square.y) % 2u == 1u) {
        discard;
    }
    target = vec4(1.0);
}
