// Surfaces nearer to each other than half a texel are one.
bool is_below(Box bounds, float height, float other) {
    return height < other - 0.5 * min(bounds.extent.x, bounds.extent.z) / bounds.texels;
}
