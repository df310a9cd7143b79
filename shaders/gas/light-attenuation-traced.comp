#version 450

#pragma variants DENSITY=functions,trilinear,tricubic,cached EMPTY=kept,skipped COUNT=one,several

// What the gas takes of the light that falls on surfaces, traced from their points.

#include "gas/frame.glsl"
#include "gas/counts.glsl"
#include "gas/band.glsl"
#include "gas/progress.glsl"
#include "gas/volumes-{COUNT}.glsl"
#include "gas/density-{DENSITY}.glsl"
#include "gas/volume-density.glsl"
#include "gas/empty-{EMPTY}.glsl"
#include "gas/lights-{COUNT}.glsl"
#include "gas/lists.glsl"
#include "gas/shadow-traced.glsl"
#include "gas/surface-sums.glsl"
#include "gas/attenuation.glsl"
