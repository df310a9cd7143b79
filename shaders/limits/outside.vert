#version 450

// A vertex outside the picture: what it takes is the stage alone.

void main() {
    gl_Position = vec4(3.0, 3.0, 0.5, 1.0);
}
