// Integers in the order of floats, and back.

int ordered(float value) {
    int bits = floatBitsToInt(value);
    return bits ^ ((bits >> 31) & 0x7fffffff);
}

float unordered(int value) {
    return intBitsToFloat(value ^ ((value >> 31) & 0x7fffffff));
}
