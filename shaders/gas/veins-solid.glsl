// The second colour of a surface, where its solid texture is dense: for visible fragments alone, as the paper textures.

#include "gas/volumes-several.glsl"
#include "gas/density-functions.glsl"
#include "gas/solid-texture.glsl"

vec3 veined(uint object, vec3 offset_m, vec3 color, vec3 point, vec3 normal, vec3 ray) {
    uvec4 veins = object_words[6u * object + 5u];
    int texture_index = int(veins.w);
    if (texture_index < 0) {
        return color;
    }
    float depth = dot(point - frame.eye, frame.forward);
    take_volume(uint(texture_index));
    float part = mean_density(point - offset_m, normal, ray, depth);
    return mix(color, uintBitsToFloat(veins.xyz), part);
}
