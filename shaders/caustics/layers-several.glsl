// Surfaces above one another (section 6.3): the first is what the light's box shows, the others are those that face the light below it.
// The room above each reaches up to what faces away from the light, or to the surface above where nothing does, as under a sheet.

layout(set = 0, binding = 12) uniform texture2DArray hidden_positions; // heights of the second surface and of those below it
layout(set = 0, binding = 13) uniform texture2DArray ceilings; // of the rooms above them, where something faces away from the light

int layer_count() {
    return textureSize(sampler2DArray(hidden_positions, nearest), 0).z + 1;
}

ivec2 inside_map(ivec2 texel) {
    return clamp(texel, ivec2(0), ivec2(int(plane.map_size) - 1));
}

float height_of(int layer, ivec2 texel) {
    return layer == 0 ? height_at(texel) : texelFetch(sampler2DArray(hidden_positions, nearest), ivec3(inside_map(texel), layer - 1), 0).r;
}

float ceiling_of(int layer, ivec2 texel) {
    return texelFetch(sampler2DArray(ceilings, nearest), ivec3(inside_map(texel), layer - 1), 0).r;
}

// The surface whose height is nearest.
int layer_near(ivec2 texel, float about) {
    int found = 0;
    float least = 1.0e30;
    int layer = 0;
    for (; layer < layer_count(); layer++) {
        float away = abs(height_of(layer, texel) - about);
        found = away < least ? layer : found;
        least = min(least, away);
    }
    is_cut = is_cut || layer < layer_count();
    return found;
}

float height_near(ivec2 texel, float about) {
    return height_of(layer_near(texel, about), texel);
}

// The surface below a height; -1 inside the receiver, and below all that is known of it.
int room_at(ivec2 texel, float height) {
    int layer = 0;
    for (; layer < layer_count(); layer++) {
        if (height_of(layer, texel) <= height) {
            float ceiling = layer > 0 ? ceiling_of(layer, texel) : -1.0e30;
            return is_receiver(ceiling) && height > ceiling ? -1 : layer;
        }
    }
    is_cut = is_cut || layer < layer_count();
    return -1;
}

// Below what is near: the pyramid knows the least height of the first surface alone.
float least_near(vec2 range) {
    return -plane.half_height;
}
