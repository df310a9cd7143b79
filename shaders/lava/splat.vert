#version 450

// Position of a splat, handed to the geometry stage (section 7.1).

layout(location = 0) in vec2 place;

layout(location = 0) out vec2 place_m;

void main() {
    place_m = place;
}
