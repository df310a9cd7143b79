#version 450

layout(push_constant, std430) uniform Paint {
    vec4 value;
} paint;

layout(location = 0) out vec4 target;

void main() {
    target = paint.value;
}
