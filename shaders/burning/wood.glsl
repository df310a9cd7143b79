// The rings of a tree around a vertical axis beside the object, as a factor of the albedo: ours, the dissertation's
// objects have textures that it does not name.

#include "burning/lattice.glsl"

float wood_hash(ivec3 at) {
    return mixed(uint(at.x) * 0x8da6b343u ^ uint(at.y) * 0xd8163841u ^ uint(at.z) * 0xcb1ab31fu);
}

float wood_noise(vec3 at) {
    ivec3 cell = ivec3(floor(at));
    vec3 t = at - vec3(cell);
    t = t * t * (3.0 - 2.0 * t);
    float sum = 0.0;
    for (int i = 0; i < 8; i++) {
        ivec3 corner = ivec3(i & 1, (i >> 1) & 1, i >> 2);
        vec3 weight = mix(1.0 - t, t, vec3(corner));
        sum += weight.x * weight.y * weight.z * wood_hash(cell + corner);
    }
    return sum * (1.0 / 65535.0);
}

float wood(vec3 rest) {
    // Slow along the axis, so that the grain runs up.
    vec3 along = rest * vec3(3.0, 0.8, 3.0);
    float bend = 0.12 * wood_noise(along * 2.0);
    float ring = fract((length(rest.xz - vec2(0.35, -0.8)) + bend) * 16.0);
    float late = smoothstep(0.45, 0.95, ring) * (1.0 - smoothstep(0.95, 1.0, ring));
    float fibre = wood_noise(rest * vec3(160.0, 9.0, 160.0));
    return (1.0 - 0.5 * late) * (0.8 + 0.35 * fibre);
}
