#version 450

// The least that a fragment can do: for fill and blend rates.

layout(location = 0) out vec4 color;

void main() {
    color = vec4(0.25, 0.5, 0.125, 0.5);
}
