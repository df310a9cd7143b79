#version 450

#extension GL_EXT_samplerless_texture_functions : require

#include "terrain/terrain.glsl"
#include "terrain/interpolation-bilinear.glsl"
#include "terrain/normal.glsl"
#include "terrain/normal-compute.glsl"
