#version 450

// An accepted grid point, handed to the geometry stage.

layout(location = 0) in vec3 position;

layout(location = 0) out vec3 point_m;

void main() {
    point_m = position;
}
