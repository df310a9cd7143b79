// The second colour of a surface, where its solid texture is dense: for visible fragments alone, as the paper textures.

#include "gas/volumes-several.glsl"
#include "gas/density-functions.glsl"
#include "gas/solid-texture.glsl"

vec3 veined(uint object, vec3 color, vec3 point, vec3 normal, vec3 ray) {
    int texture_index = objects[object].veins;
    if (texture_index < 0) {
        return color;
    }
    float depth = dot(point - frame.eye, frame.forward);
    take_volume(uint(texture_index));
    float part = mean_density(point - objects[object].offset_m, normal, ray, depth);
    return mix(color, objects[object].vein_color, part);
}
