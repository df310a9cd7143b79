#version 450

#pragma variants DENSITY=functions,trilinear,tricubic,cached

// What the gas takes of the light that falls on surfaces, by ratio tracking from their points.

#include "gas/frame.glsl"
#include "gas/counts.glsl"
#include "gas/band.glsl"
#include "gas/progress.glsl"
#include "gas/volumes-several.glsl"
#include "gas/density-{DENSITY}.glsl"
#include "gas/volume-density.glsl"
#include "gas/lights-several.glsl"
#include "gas/lists.glsl"
#include "gas/random.glsl"
#include "gas/shadow-ratio.glsl"
#include "gas/surface-ways.glsl"
#include "gas/attenuation.glsl"
