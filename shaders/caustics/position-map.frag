#version 450

// Position map in a pass of its own (section 4.2.2, figure 5-5).

layout(location = 0) in float height;

layout(location = 0) out float position;

void main() {
    position = height;
}
