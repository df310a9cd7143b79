// Rays to the sun end at the level on which the lit place was found, wherever they are.

int shadow_shift;

int finest_shift(float depth_m) {
    return shadow_shift;
}
