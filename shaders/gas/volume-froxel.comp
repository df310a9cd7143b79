#version 450

// The gas of each pixel from froxels.

#extension GL_EXT_samplerless_texture_functions : require

#include "gas/frame.glsl"
#include "gas/counts.glsl"
#include "gas/band.glsl"
#include "gas/progress.glsl"
#include "gas/volumes-several.glsl"
#include "gas/lists.glsl"
#include "gas/march-froxels.glsl"
#include "gas/sections.glsl"
