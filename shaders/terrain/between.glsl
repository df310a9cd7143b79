// Narrows `range` to where a coordinate that moves from `from` by `way` lies between two bounds.
vec2 between(vec2 range, float from, float way, float low, float high) {
    float inverse = 1.0 / (abs(way) < 1.0e-20 ? 1.0e-20 : way);
    float a = (low - from) * inverse;
    float b = (high - from) * inverse;
    return vec2(max(range.x, min(a, b)), min(range.y, max(a, b)));
}
