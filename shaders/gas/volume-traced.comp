#version 450

#pragma variants DENSITY=functions,trilinear,tricubic,cached EMPTY=kept,skipped COUNT=one,several

// The gas of each pixel, shadows traced from every sample.

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
#include "gas/scattering.glsl"
#include "gas/march-steps.glsl"
#include "gas/sections.glsl"
