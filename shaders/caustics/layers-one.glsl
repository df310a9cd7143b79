// The one surface that the light's box shows; the receiver is solid below it.

int layer_count() {
    return 1;
}

float height_of(int layer, ivec2 texel) {
    return height_at(texel);
}

int layer_near(ivec2 texel, float about) {
    return 0;
}

float height_near(ivec2 texel, float about) {
    return height_at(texel);
}

// 0 above the surface, and -1 below it, inside the receiver.
int room_at(ivec2 texel, float height) {
    return height_at(texel) > height ? -1 : 0;
}

// Below what is near, of its least and greatest height.
float least_near(vec2 range) {
    return range.x;
}
