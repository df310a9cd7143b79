#version 450

layout(location = 0) out vec4 shaded;

void main() {
    shaded = vec4(0.9, 0.9, 0.85, 1.0);
}
