#include "gas/glow-trilinear.glsl"
