#version 450

#pragma variants SHADOW=none,ratio,table DENSITY=functions,trilinear,tricubic,cached

// The gas of each pixel by delta tracking, without shadows in the gas, with shadows by ratio tracking, or from the table.

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
#include "gas/shadow-{SHADOW}.glsl"
#include "gas/scattering.glsl"
#include "gas/march-delta.glsl"
#include "gas/sections.glsl"
