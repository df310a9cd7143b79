#version 450

// Points from a storage buffer, one for each instance; their colour comes from a vertex buffer.

struct Sprite {
    vec3 position; // normalised device coordinates
    float radius_px;
};

layout(set = 0, binding = 0, std430) readonly buffer Sprites {
    Sprite sprites[];
};

layout(location = 0) in vec4 tint;

layout(location = 0) out vec4 colour;
layout(location = 1) flat out uint sprite_index;

void main() {
    Sprite sprite = sprites[gl_InstanceIndex];
    colour = tint;
    sprite_index = uint(gl_InstanceIndex);
    gl_PointSize = 2.0 * sprite.radius_px;
    gl_Position = vec4(sprite.position, 1.0);
}
