#version 450

// Round sprites with depth of their own into two targets.

struct Light {
    vec3 direction;
    float power;
};

layout(set = 1, binding = 0, std140) uniform Scene {
    mat4 view_projection;
    Light lights[2];
    float weights[3];
    vec3 ambient;
    int light_count;
} scene;

layout(set = 1, binding = 1) uniform texture2D palette;
layout(set = 1, binding = 2) uniform sampler nearest;

layout(location = 0) in vec4 colour;
layout(location = 1) flat in uint sprite_index;

layout(location = 0) out vec4 radiance;
layout(location = 1) out uvec2 identity;

vec3 shade(vec3 normal) {
    vec3 sum = scene.ambient;
    for (int i = 0; i < scene.light_count; i++) {
        sum += scene.lights[i].power * max(dot(normal, scene.lights[i].direction), 0.0);
    }
    return sum * scene.weights[sprite_index % 3u];
}

void main() {
    vec2 disc = 2.0 * gl_PointCoord - 1.0;
    float height = 1.0 - dot(disc, disc);
    if (height < 0.0) {
        discard;
    }
    vec3 normal = mat3(scene.view_projection) * vec3(disc, sqrt(height));
    vec4 paint = texture(sampler2D(palette, nearest), colour.xy);
    radiance = vec4(shade(normal), 1.0) * paint;
    identity = uvec2(sprite_index, 1u);
    gl_FragDepth = gl_FragCoord.z - 0.01 * height;
}
