#version 450

// Where a polygon object is seen, as the pass `depth` has it of the terrain: what rays to the sun start from. The surface counts
// as terrain of the finest level.

layout(location = 0) out vec4 hit;

void main() {
    hit = vec4(1.0 / gl_FragCoord.w, 0.0, 0.0, 2.0);
}
