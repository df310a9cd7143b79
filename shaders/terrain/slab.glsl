// Narrows a range of t to where a coordinate, `from` + t `direction`, lies in a slab.
vec2 clip_to_slab(vec2 range, float from, float direction, float low, float high) {
    float inverse = 1.0 / (abs(direction) < 1.0e-20 ? 1.0e-20 : direction);
    float a = (low - from) * inverse;
    float b = (high - from) * inverse;
    return vec2(max(range.x, min(a, b)), min(range.y, max(a, b)));
}
